//! The state of the bridge, and how the LED shows it.

/// What the bridge is doing. Each state has its own pattern of the LED.
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
    /// True if the LED is lit at a tick, counted from 0.
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
