//! From a reading that cannot be right to its cause, without a bus.

use core::fmt::{Display, Formatter, Result};

use crate::codes::Width;
use crate::error::{OutOfRange, ReadError};
use crate::registers::{Address, ChannelStatus, Mode, RateStatus, Register, TempStatus};

/// A register that does not read what it must.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub struct Mismatch {
    /// The register.
    pub register: Address,
    /// What it must read.
    pub expected: u8,
    /// What it read.
    pub got: u8,
}

impl Display for Mismatch {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{} reads {:02X}h instead of {:02X}h", self.register, self.got, self.expected)
    }
}

/// What is wrong with the line or the part, and the register that shows it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// SDO is stuck at ones.
    StuckHigh(Mismatch),
    /// SDO is stuck at zeros.
    StuckLow(Mismatch),
    /// MODE reads 00h: the part has been reset, as by a brown-out.
    ConfigurationLost(Mismatch),
    /// The line works, but the register contradicts what was written or where it is: bit errors, or another part.
    Unexpected(Mismatch),
}

impl Fault {
    pub(crate) const STUCK_HIGH: &str =
        "SDO is stuck at ones; check the SDO wire (pin 12), CS (pin 8) and the supply of the part";
    pub(crate) const STUCK_LOW: &str =
        "SDO is stuck at zeros; check the SDO wire (pin 12) for a short, CS (pin 8) and the supply of the part";
    pub(crate) const CONFIGURATION_LOST: &str = "the part has lost its configuration, as after a dip of the supply; \
         check the 5 V supply, then reset and initialise again";
    pub(crate) const UNEXPECTED: &str =
        "the line works but carries errors; lower the SPI clock, shorten or shield the cable, and check SPI mode 3";

    /// The register that shows it.
    pub const fn evidence(&self) -> Mismatch {
        match *self {
            Self::StuckHigh(seen) | Self::StuckLow(seen) | Self::ConfigurationLost(seen) | Self::Unexpected(seen) => {
                seen
            }
        }
    }

    /// The fault that MODE and TEMP STATUS show when read one after the other, if any.
    ///
    /// On a line that works, TEMP STATUS is never all ones or all zeros, because it names its channel (b7–5 = 010).
    pub(crate) const fn shown_by(temp_status: ChannelStatus, mode: Mode, written: Mode) -> Option<Self> {
        let status =
            Mismatch { register: Address::TempStatus, expected: TempStatus::RESET.bits(), got: temp_status.bits() };
        let mode = Mismatch { register: Address::Mode, expected: written.bits(), got: mode.bits() };
        match (status.got, mode.got) {
            (0xFF, 0xFF) => Some(Self::StuckHigh(status)),
            (0x00, 0x00) => Some(Self::StuckLow(status)),
            (_, 0x00) if mode.expected != 0 => Some(Self::ConfigurationLost(mode)),
            (_, got) if got != mode.expected => Some(Self::Unexpected(mode)),
            _ if temp_status.channel() != TempStatus::RESET.channel() => Some(Self::Unexpected(status)),
            _ => None,
        }
    }

    /// A channel status that names another channel than its own.
    pub(crate) const fn of_channel(register: Address, status: ChannelStatus, own: ChannelStatus) -> Option<Self> {
        if status.channel() == own.channel() {
            None
        } else {
            Some(Self::Unexpected(Mismatch {
                register,
                expected: own.bits() | (status.bits() & 0x1F),
                got: status.bits(),
            }))
        }
    }
}

impl Display for Fault {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let cause = match self {
            Self::StuckHigh(_) => Self::STUCK_HIGH,
            Self::StuckLow(_) => Self::STUCK_LOW,
            Self::ConfigurationLost(_) => Self::CONFIGURATION_LOST,
            Self::Unexpected(_) => Self::UNEXPECTED,
        };
        write!(f, "{}: {cause}", self.evidence())
    }
}

impl core::error::Error for Fault {}

/// Whether the answer of a register needs a second look: a dead line would give it too, or it names the wrong channel.
pub(crate) fn is_doubtful(register: Address, answer: u32, bytes: usize) -> bool {
    let ones = u32::MAX >> (32 - 8 * bytes.clamp(1, 4));
    answer == 0 || answer == ones || channel_fault(register, answer).is_some()
}

/// What a doubtful answer means once the link has been found healthy: `None` = it is true.
pub(crate) fn meaning_on_healthy_link<E>(register: Address, answer: u32, width: Width) -> Option<ReadError<E>> {
    match register {
        Address::RateData | Address::TempData => {
            Some(ReadError::OutOfRange(OutOfRange { register, code: answer, width }))
        }
        _ => channel_fault(register, answer).map(ReadError::Fault),
    }
}

fn channel_fault(register: Address, answer: u32) -> Option<Fault> {
    let status = ChannelStatus::new(answer as u8);
    match register {
        Address::RateStatus => Fault::of_channel(register, status, RateStatus::RESET),
        Address::TempStatus => Fault::of_channel(register, status, TempStatus::RESET),
        _ => None,
    }
}
