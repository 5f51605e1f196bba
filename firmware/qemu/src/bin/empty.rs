//! The image of `driver` without the driver: the start-up code, the bus and the pin only.

#![no_std]
#![no_main]

use embedded_hal::digital::InputPin;
use embedded_hal::spi::SpiDevice;
use firmware_qemu::bare::{Bus, Line, put};

#[cortex_m_rt::entry]
fn main() -> ! {
    loop {
        let mut frame = [0; 5];
        let sent = Bus.transfer_in_place(&mut frame);
        let level = Line.is_low();
        put(&frame, u32::from(sent.is_ok()) + u32::from(level == Ok(true)));
    }
}
