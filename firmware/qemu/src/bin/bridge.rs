//! A bridge with the twin in it: docs/formats/bridge.md on UART 0, which the emulator connects to a socket.
//!
//! The argument is the seed of the twin.

#![no_std]
#![no_main]

use adis16130_twin::{Spec, Twin};
use core::convert::Infallible;
use cortex_m_semihosting::debug;
use firmware_qemu::bridge::{Port, serve};
use firmware_qemu::{arguments, heap};

const FIRMWARE: &str = concat!("bridge-qemu ", env!("CARGO_PKG_VERSION"));

#[cortex_m_rt::entry]
fn main() -> ! {
    heap::set_up();
    if let Some(seed) = arguments::seed() {
        let Err(never) = serve(&Twin::new(Spec::from_seed(seed)), FIRMWARE, &mut Uart::new());
        match never {}
    }
    debug::exit(debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::bkpt();
    }
}

/// UART 0 of the mps2-an386 (CMSDK APB UART), polled.
struct Uart(());

const DATA: *mut u32 = 0x4000_4000 as *mut u32;
const STATE: *mut u32 = 0x4000_4004 as *mut u32;
const CONTROL: *mut u32 = 0x4000_4008 as *mut u32;
const BAUD_DIVIDER: *mut u32 = 0x4000_4010 as *mut u32;
const TRANSMIT_FULL: u32 = 1 << 0;
const RECEIVE_FULL: u32 = 1 << 1;
const TRANSMIT_AND_RECEIVE: u32 = 0b11;
/// The smallest that the UART takes; the emulator sends as fast as it can.
const FASTEST: u32 = 16;

impl Uart {
    fn new() -> Self {
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

#[expect(unsafe_code, reason = "a device register is a fixed address")]
fn read(register: *mut u32) -> u32 {
    // SAFETY: only called with the aligned registers above, which the machine has and which no Rust object overlaps.
    unsafe { register.read_volatile() }
}

#[expect(unsafe_code, reason = "a device register is a fixed address")]
fn write(register: *mut u32, value: u32) {
    // SAFETY: as for `read`.
    unsafe { register.write_volatile(value) }
}
