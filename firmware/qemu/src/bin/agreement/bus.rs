//! A bus that takes almost no instructions, because the answers of all registers are prepared in memory.

use adis16130::registers::Address;
use core::cell::Cell;
use core::convert::Infallible;
use embedded_hal::spi::{self, Operation, SpiDevice};

/// The answer of each register, by address: the four bytes that the part sends while the host sends COM and zeros.
pub struct Answers([Cell<[u8; 4]>; 64]);

impl Answers {
    pub fn new() -> Self {
        Self([const { Cell::new([0xFF; 4]) }; 64])
    }

    /// Sets the data bytes of a register, most significant byte first.
    pub fn set(&self, register: Address, [high, middle, low]: [u8; 3]) {
        if let Some(answer) = self.0.get(register as usize) {
            answer.set([0xFF, high, middle, low]);
        }
    }

    pub fn set_code(&self, register: Address, code24: u32) {
        let [_, bytes @ ..] = code24.to_be_bytes();
        self.set(register, bytes);
    }
}

pub struct Bus<'a>(pub &'a Answers);

impl spi::ErrorType for Bus<'_> {
    type Error = Infallible;
}

impl SpiDevice for Bus<'_> {
    #[inline(always)]
    fn transaction(&mut self, _: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        Ok(())
    }

    #[inline(always)]
    fn transfer_in_place(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        let address = bytes.first().map_or(0, |com| com & 0x3F);
        for (byte, answer) in bytes.iter_mut().zip(self.0.0[usize::from(address)].get()) {
            *byte = answer;
        }
        Ok(())
    }
}
