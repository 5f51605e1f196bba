//! The values written to the configuration registers, and how they read back.

use core::fmt::{Display, Formatter, Result};

use crate::diagnosis::Mismatch;
use crate::registers::{Address, Iop, Mode, Register};

/// The registers that the configuration writes, in the order of F-30.
const CONFIGURED: [Address; 6] =
    [Address::Iop, Address::RateCs, Address::RateConv, Address::TempCs, Address::TempConv, Address::Mode];

/// The values written with success to the configuration registers since the reset.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) struct WriteLog {
    /// The values in the order of [`CONFIGURED`], 0 until written. For MODE, 0 is also the value after a reset.
    values: [u8; CONFIGURED.len()],
    /// Bit n is set when register n of [`CONFIGURED`] (from 0) has been written.
    known: u8,
}

impl WriteLog {
    pub(crate) const NOTHING: Self = Self { values: [Mode::RESET.bits(); CONFIGURED.len()], known: 0 };

    /// Records a successful write. Returns whether the write restarts the conversions, as a write of MODE does.
    /// Registers outside [`CONFIGURED`] (CHECKSUM) are not recorded.
    pub(crate) fn record(&mut self, register: Address, value: u32) -> bool {
        for (place, (address, slot)) in CONFIGURED.iter().zip(&mut self.values).enumerate() {
            if *address == register {
                *slot = value as u8;
                self.known |= 1 << place;
            }
        }
        register == Address::Mode
    }

    /// The value of MODE: the last one written, or its reset value.
    #[inline]
    pub(crate) const fn mode(&self) -> Mode {
        let [.., mode] = self.values;
        Mode::new(mode)
    }

    pub(crate) const fn is_complete(&self) -> bool {
        self.known >> (CONFIGURED.len() - 1) != 0
    }

    pub(crate) fn iter(self) -> impl Iterator<Item = (Address, u8)> {
        let written = CONFIGURED.into_iter().zip(self.values).enumerate();
        written.filter(move |(place, _)| self.known >> place & 1 != 0).map(|(_, entry)| entry)
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
    /// The registers, with the written and the read values.
    pub fn iter(&self) -> impl Iterator<Item = Mismatch> + use<> {
        self.slots.into_iter().flatten()
    }

    /// Compares the value of a register with the written one, without the pin levels of IOP (docs/facts.md section 3).
    pub(crate) fn compare(&mut self, register: Address, expected: u8, got: u8) {
        let mask = if register == Address::Iop { !Iop::PIN_LEVELS } else { 0xFF };
        let place = usize::from(self.read);
        self.read += 1;
        self.ones += u8::from(got == 0xFF);
        self.zeros += u8::from(got == 0x00);
        if (expected ^ got) & mask != 0
            && let Some(slot) = self.slots.get_mut(place)
        {
            *slot = Some(Mismatch { register, expected, got });
        }
    }

    pub(crate) const fn is_all_ones(&self) -> bool {
        self.ones == self.read
    }

    pub(crate) const fn is_all_zeros(&self) -> bool {
        self.zeros == self.read
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
