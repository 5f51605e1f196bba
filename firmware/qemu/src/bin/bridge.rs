//! A bridge whose part is the twin: docs/formats/bridge.md on UART 0, which the emulator connects to a socket.
//!
//! The argument is the seed of the twin.

#![no_std]
#![no_main]

use adis16130_twin::{Spec, Twin};
use cortex_m_semihosting::debug;
use firmware_qemu::bridge::serve;
use firmware_qemu::uart::Uart;
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
