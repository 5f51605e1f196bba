//! The LED: what the bridge does, to be seen from across the room.

use embassy_time::{Duration, Timer};

use crate::Link;

/// A pattern is eight of these, and begins anew every second.
const TICK: Duration = Duration::from_millis(125);

/// What the bridge does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// No host has asked for anything: a flash every second.
    Idle,
    /// A host is there, and nothing is sampled: on.
    Ready,
    /// Samples are taken: half a second on, half a second off.
    Sampling,
    /// Sampling has ended, because the part no longer answers as it should: four flashes a second.
    Failed,
}

impl State {
    /// Whether the LED is lit at a tick, counted from 0.
    pub const fn is_lit(self, tick: u8) -> bool {
        let pattern: u8 = match self {
            Self::Idle => 0b0000_0001,
            Self::Ready => 0b1111_1111,
            Self::Sampling => 0b0000_1111,
            Self::Failed => 0b0101_0101,
        };
        pattern >> (tick % 8) & 1 == 1
    }
}

/// Shows the state. `light` turns the LED on or off.
pub async fn run(mut light: impl FnMut(bool), link: &Link) -> ! {
    let mut tick = 0_u8;
    loop {
        light(link.state().is_lit(tick));
        tick = tick.wrapping_add(1);
        Timer::after(TICK).await;
    }
}
