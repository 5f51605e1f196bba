//! The state of the bridge, and how the LED shows it.

/// The state of the bridge. Each state has its own pattern of the LED.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// No host has sent a request since the last one left. The LED flashes once a second.
    Idle,
    /// A host has sent a request, and the bridge does not sample. The LED is on.
    Ready,
    /// The bridge samples. The LED is on for half a second, and off for half a second.
    Sampling,
    /// Sampling has ended, because the part no longer answers as it should. The LED flashes four times a second.
    Failed,
}

impl State {
    /// Whether the LED is lit at a tick of 125 ms, counted from 0. The pattern repeats after eight ticks.
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
