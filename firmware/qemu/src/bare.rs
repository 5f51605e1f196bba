//! A bus, a pin and a clock on peripheral addresses, without a vendor's library. A driver needs nothing else.

use core::convert::Infallible;
use embedded_hal::digital::{self, InputPin};
use embedded_hal::spi::{self, Operation, SpiDevice};

/// The data register of the bus: the first SPI controller of the mps2-an386.
const BUS: *mut u32 = 0x4002_0008 as *mut u32;
/// The pins: GPIO port 0.
const PINS: *mut u32 = 0x4001_0000 as *mut u32;
/// The clock: the free-running counter of the FPGA's registers.
const CLOCK: *mut u32 = 0x4002_8010 as *mut u32;

#[expect(unsafe_code, reason = "a device register is a fixed address")]
pub(crate) fn read(register: *mut u32) -> u32 {
    // SAFETY: only called with aligned registers that the machine has and that no Rust object overlaps.
    unsafe { register.read_volatile() }
}

#[expect(unsafe_code, reason = "a device register is a fixed address")]
pub(crate) fn write(register: *mut u32, value: u32) {
    // SAFETY: as for `read`.
    unsafe { register.write_volatile(value) }
}

/// Writes bytes and a number to registers, so that the compiler keeps the code that computed them.
#[inline(never)]
pub fn put(bytes: &[u8], number: u32) {
    for byte in bytes {
        write(BUS, u32::from(*byte));
    }
    write(PINS, number);
}

/// Returns a time and a number for an edge of RDY. The compiler cannot know these values.
#[inline(never)]
pub fn edge() -> (u64, u32) {
    (u64::from(read(CLOCK)) << 32 | u64::from(read(CLOCK)), read(PINS))
}

/// The SPI bus, with one device. It carries out only the operations that the driver uses.
#[derive(Clone, Copy, Debug)]
pub struct Bus;

impl spi::ErrorType for Bus {
    type Error = spi::ErrorKind;
}

impl SpiDevice for Bus {
    #[inline(never)]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), spi::ErrorKind> {
        for operation in operations {
            match operation {
                Operation::TransferInPlace(bytes) => exchange(bytes),
                Operation::Write(bytes) => put(bytes, 0),
                _ => return Err(spi::ErrorKind::Other),
            }
        }
        Ok(())
    }
}

fn exchange(bytes: &mut [u8]) {
    for byte in bytes {
        write(BUS, u32::from(*byte));
        *byte = read(BUS) as u8;
    }
}

/// The pin of RDY.
#[derive(Clone, Copy, Debug)]
pub struct Line;

impl digital::ErrorType for Line {
    type Error = Infallible;
}

impl InputPin for Line {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(read(PINS) & 1 != 0)
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        self.is_high().map(|high| !high)
    }
}
