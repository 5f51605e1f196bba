//! Finds the cause of an implausible reading from register values that were already read.

use core::fmt::{Display, Formatter, Result};

use crate::ZERO_CODE;
use crate::codes::{RateCode, Width};
use crate::registers::{Address, ChannelStatus, Mode, RateStatus, Register, TempStatus};

/// A register whose value differs from the value that it must have.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Mismatch {
    /// The register that was read.
    pub register: Address,
    /// The value that the register must have.
    pub expected: u8,
    /// The value that was read from the register.
    pub got: u8,
}

impl Display for Mismatch {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{} reads {:02X}h instead of {:02X}h", self.register, self.got, self.expected)
    }
}

/// A fault of the line or the part, with the register that shows it.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Fault {
    /// SDO is stuck at ones.
    StuckHigh(Mismatch),
    /// SDO is stuck at zeros.
    StuckLow(Mismatch),
    /// MODE reads 00h: the part has been reset, for example by a brown-out.
    ConfigurationLost(Mismatch),
    /// The line works, but the register does not have the written value, or a status names another channel. The line
    /// has bit errors, the part is another one, or this driver did not initialise it.
    Unexpected(Mismatch),
}

impl Fault {
    /// The message if SDO is dead and RDY has no edges.
    pub const UNPLUGGED: &str = "the part is unplugged or has no power: data ready (pin 10) is silent and SDO (pin \
         12) is dead; check the cable and the 5 V supply (pins 11, 13, 15)";
    /// The message if RDY has no edges although the part answers and is configured.
    pub const NO_NEW_DATA: &str = "no data ready: the part answers and is configured, but RDY (pin 10) brought no new \
         data for a second; check the RDY wire";
    pub(crate) const STUCK_HIGH: &str =
        "SDO is stuck at ones; check the SDO wire (pin 12), CS (pin 8) and the supply of the part";
    pub(crate) const STUCK_LOW: &str =
        "SDO is stuck at zeros; check the SDO wire (pin 12) for a short, CS (pin 8) and the supply of the part";
    pub(crate) const CONFIGURATION_LOST: &str = "the part has lost its configuration, as after a dip of the supply; \
         check the 5 V supply, then reset and initialise again";
    pub(crate) const UNEXPECTED: &str =
        "the line works but carries errors; lower the SPI clock, shorten or shield the cable, and check SPI mode 3";

    /// The register that shows the fault.
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

    /// The fault of a channel status that names another channel than its own.
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

/// Whether the answer of a one-byte register must be checked, because a dead line would give the same answer, or
/// because the answer names the wrong channel.
pub(crate) fn is_doubtful(register: Address, answer: u8) -> bool {
    answer == 0 || answer == 0xFF || meaning_on_healthy_link(register, answer).is_some()
}

/// The fault in a doubtful answer of a one-byte register on a healthy link. `None` if there is no fault.
pub(crate) fn meaning_on_healthy_link(register: Address, answer: u8) -> Option<Fault> {
    let status = ChannelStatus::new(answer);
    match register {
        Address::RateStatus => Fault::of_channel(register, status, RateStatus::RESET),
        Address::TempStatus => Fault::of_channel(register, status, TempStatus::RESET),
        _ => None,
    }
}

/// The value of the data registers after a reset, before the first conversion (docs/facts.md section 3).
const RESET_DATA: u32 = 0x8000;

/// Whether the answer of a data register must be checked, because a dead line or a register that holds its reset value
/// would give the same answer.
///
/// After a brown-out the data registers have 16 bits. A third byte then has the level of SDO outside a read.
#[inline]
pub(crate) const fn is_doubtful_reading(answer: u32, width: Width) -> bool {
    is_at_rail(answer, width) || answer == RESET_DATA || answer >> 8 == RESET_DATA
}

/// Whether a rate is in the outermost 1/64 of its scale, beyond ±351.6 °/s. Such a code may have wrapped.
pub(crate) const fn is_near_rail(rate: RateCode) -> bool {
    rate.code24().abs_diff(ZERO_CODE) > ZERO_CODE - ZERO_CODE / 64
}

/// Whether the answer of a data register is the lowest or the highest code, which are all zeros and all ones.
#[inline]
pub(crate) const fn is_at_rail(answer: u32, width: Width) -> bool {
    answer == 0 || answer == width.max_code()
}
