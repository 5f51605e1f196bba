//! The two channels of the converter, and a record of those that have converted since MODE was written.

use crate::registers::{Address, ChannelStatus};

/// A channel of the converter (docs/facts.md section 3).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Channel {
    Rate,
    Temp,
}

impl Channel {
    pub(crate) const fn data(self) -> Address {
        match self {
            Self::Rate => Address::RateData,
            Self::Temp => Address::TempData,
        }
    }

    pub(crate) const fn status(self) -> Address {
        match self {
            Self::Rate => Address::RateStatus,
            Self::Temp => Address::TempStatus,
        }
    }

    /// Whether a channel status names this channel and shows an unread reading: b7–5 and RDY.
    pub(crate) const fn announced_by(self, status: ChannelStatus) -> bool {
        let own = match self {
            Self::Rate => 0x08,
            Self::Temp => 0x48,
        };
        status.bits() & 0xE8 == own
    }
}

/// The channels that are known to have converted since MODE was written. In the data register of any other channel,
/// the code that the register has after a reset is not a reading.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct ConvertedChannels(u8);

impl ConvertedChannels {
    pub(crate) const NOTHING: Self = Self(0);

    #[inline]
    pub(crate) const fn has(self, channel: Channel) -> bool {
        self.0 & (1 << channel as u8) != 0
    }

    #[inline]
    pub(crate) const fn note(&mut self, channel: Channel) {
        self.0 |= 1 << channel as u8;
    }
}
