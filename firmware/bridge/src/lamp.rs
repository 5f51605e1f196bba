//! Shows the state of the bridge with the LED.

use embassy_time::{Duration, Timer};

use crate::Link;

/// Duration of a tick. A pattern has eight ticks, and repeats every second.
const TICK: Duration = Duration::from_millis(125);

/// Shows the state of `link`. `light` turns the LED on or off.
pub async fn run(mut light: impl FnMut(bool), link: &Link) -> ! {
    let mut tick = 0_u8;
    loop {
        light(link.state().is_lit(tick));
        tick = tick.wrapping_add(1);
        Timer::after(TICK).await;
    }
}
