//! What has been written, and how it reads back.

use core::fmt::{Display, Formatter, Result};

use crate::diagnosis::Mismatch;
use crate::error::VerifyError;
use crate::registers::{Address, Iop, Mode, Register};

/// The registers that the configuration writes, in the order of F-30.
const CONFIGURED: [Address; 6] =
    [Address::Iop, Address::RateCs, Address::RateConv, Address::TempCs, Address::TempConv, Address::Mode];

/// What has been written to the configuration registers, successfully, since the reset.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct Written([Option<u8>; CONFIGURED.len()]);

impl Written {
    pub(crate) const NOTHING: Self = Self([None; CONFIGURED.len()]);

    /// Notes a successful write, and says whether it begins the conversions anew: that of MODE does. Registers that
    /// configure nothing (CHECKSUM) are not kept.
    pub(crate) fn record(&mut self, register: Address, value: u32) -> bool {
        for (address, slot) in CONFIGURED.iter().zip(&mut self.0) {
            if *address == register {
                *slot = Some(value as u8);
            }
        }
        register == Address::Mode
    }

    /// The value of MODE: that of the reset unless written.
    #[inline]
    pub(crate) const fn mode(&self) -> Mode {
        match self.0 {
            [.., Some(mode)] => Mode::new(mode),
            [.., None] => Mode::RESET,
        }
    }

    pub(crate) const fn is_complete(&self) -> bool {
        matches!(self.0, [.., Some(_)])
    }

    /// Register and value of everything written.
    pub(crate) fn iter(self) -> impl Iterator<Item = (Address, u8)> {
        CONFIGURED.into_iter().zip(self.0).filter_map(|(address, value)| Some((address, value?)))
    }
}

/// The registers that read back differently, in the order of F-30.
#[derive(Copy, Clone, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Differences {
    slots: [Option<Mismatch>; CONFIGURED.len()],
    read: u8,
    ones: u8,
    zeros: u8,
}

impl Differences {
    /// The registers, with what was written and what was read.
    pub fn iter(&self) -> impl Iterator<Item = Mismatch> + use<> {
        self.slots.into_iter().flatten()
    }

    /// Compares what a register read with what had been written to it; IOP without the pin levels (part.md §3).
    pub(crate) fn compare(&mut self, register: Address, expected: u8, got: u8) {
        let mask = if register == Address::Iop { !Iop::PIN_LEVELS } else { 0xFF };
        self.read += 1;
        self.ones += u8::from(got == 0xFF);
        self.zeros += u8::from(got == 0x00);
        if (expected ^ got) & mask != 0
            && let Some(slot) = self.slots.iter_mut().find(|slot| slot.is_none())
        {
            *slot = Some(Mismatch { register, expected, got });
        }
    }

    /// The verdict after the last register.
    pub(crate) fn verdict<E>(self) -> core::result::Result<(), VerifyError<E>> {
        if self.iter().next().is_none() {
            Ok(())
        } else if self.ones == self.read {
            Err(VerifyError::StuckHigh(self))
        } else if self.zeros == self.read {
            Err(VerifyError::StuckLow(self))
        } else if self.iter().any(|seen| seen.register == Address::Mode && seen.got == 0) {
            Err(VerifyError::ConfigurationLost(self))
        } else {
            Err(VerifyError::Differs(self))
        }
    }
}

impl Display for Differences {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        for (place, seen) in self.iter().enumerate() {
            let comma = if place == 0 { "" } else { ", " };
            write!(f, "{comma}{seen}")?;
        }
        Ok(())
    }
}
