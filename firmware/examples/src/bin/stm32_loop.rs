//! The loop of `docs/firmware.md` on an STM32F411, with the wiring of `docs/wiring.md`.

#![no_std]
#![no_main]

use embassy_stm32::gpio::{Input, Level, Output, Pull, Speed};
use embassy_stm32::spi::{self, Spi};
use embassy_time::Delay;
use embedded_hal_bus::spi::ExclusiveDevice;
use firmware_examples::{control, polled};
use panic_reset as _;

#[cortex_m_rt::entry]
fn main() -> ! {
    let p = embassy_stm32::init(Default::default());
    let mut config = spi::Config::default();
    config.mode = spi::MODE_3;
    // the fastest SPI clock below 10 MHz (F-21) that divides 16 MHz
    config.frequency = embassy_stm32::time::Hertz(8_000_000);
    let spi1 = Spi::new_blocking(p.SPI1, p.PA5, p.PA7, p.PA6, config);
    let cs = Output::new(p.PB6, Level::High, Speed::VeryHigh);
    let Ok(spi) = ExclusiveDevice::new(spi1, cs, Delay);
    polled::run(spi, Input::new(p.PA10, Pull::Up), Delay, control)
}
