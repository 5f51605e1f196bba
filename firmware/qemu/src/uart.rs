//! The serial line of the emulated machine.

use crate::bare::{read, write};
use crate::bridge::Port;
use core::convert::Infallible;

/// UART 0 of the mps2-an386 (CMSDK APB UART), polled.
#[derive(Debug)]
pub struct Uart(());

const DATA: *mut u32 = 0x4000_4000 as *mut u32;
const STATE: *mut u32 = 0x4000_4004 as *mut u32;
const CONTROL: *mut u32 = 0x4000_4008 as *mut u32;
const BAUD_DIVIDER: *mut u32 = 0x4000_4010 as *mut u32;
const TRANSMIT_FULL: u32 = 1 << 0;
const RECEIVE_FULL: u32 = 1 << 1;
const TRANSMIT_AND_RECEIVE: u32 = 0b11;
/// Smallest divisor that the UART accepts. The emulator sends as fast as it can with any divisor.
const FASTEST: u32 = 16;

impl Uart {
    /// Switches the UART on. Call it once.
    #[expect(clippy::new_without_default, reason = "it switches something on")]
    pub fn new() -> Self {
        write(BAUD_DIVIDER, FASTEST);
        write(CONTROL, TRANSMIT_AND_RECEIVE);
        Self(())
    }
}

impl Port for Uart {
    type Closed = Infallible;

    fn read(&mut self, wait: bool) -> Result<Option<u8>, Infallible> {
        loop {
            if read(STATE) & RECEIVE_FULL != 0 {
                return Ok(Some(read(DATA) as u8));
            }
            if !wait {
                return Ok(None);
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), Infallible> {
        for byte in bytes {
            while read(STATE) & TRANSMIT_FULL != 0 {}
            write(DATA, u32::from(*byte));
        }
        Ok(())
    }
}
