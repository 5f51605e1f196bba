//! The bounds of waits for new data.

use core::num::NonZeroU32;

/// The interval at which a blocking wait reads the pin.
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PollInterval(NonZeroU32);

impl PollInterval {
    /// 5 µs: less than a fifth of the time for which RDY is high between two updates (F-32).
    pub const DEFAULT: Self = Self(NonZeroU32::MIN.saturating_add(4));

    /// An interval in µs.
    pub const fn from_us(us: NonZeroU32) -> Self {
        Self(us)
    }

    /// The interval in µs.
    pub const fn us(self) -> u32 {
        self.0.get()
    }
}

/// The longest time to wait for data, and how often a blocking wait reads the pin.
///
/// ```
/// use adis16130::WaitBound;
/// assert_eq!(WaitBound::from_us(1_000).polls(), 200); // reads the pin 201 times at most
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct WaitBound {
    timeout_us: u32,
    poll: PollInterval,
}

impl WaitBound {
    /// A bound of `timeout_us`. The blocking driver adds up the delays that it requests, so a wait takes longer if the
    /// delays do.
    pub const fn from_us(timeout_us: u32) -> Self {
        Self { timeout_us, poll: PollInterval::DEFAULT }
    }

    /// Sets the interval at which the blocking driver reads the pin. The pin wakes the async driver, without an
    /// interval.
    pub const fn with_poll(mut self, poll: PollInterval) -> Self {
        self.poll = poll;
        self
    }

    /// The bound in µs.
    pub const fn timeout_us(self) -> u32 {
        self.timeout_us
    }

    /// The interval at which the blocking driver reads the pin.
    pub const fn poll(self) -> PollInterval {
        self.poll
    }

    /// The number of poll intervals that fill the bound, rounded up.
    pub const fn polls(self) -> u32 {
        self.timeout_us.div_ceil(self.poll.us())
    }
}
