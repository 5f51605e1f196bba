//! The loop of the project's README, which waits for RDY. It runs on any board with embedded-hal.

// README: begin
use crate::{BackOff, unit}; // unit.rs: zerorate export unit.toml --format rust
use adis16130::{Config, Error, RateCode, ReadError, TempCode, WaitBound, blocking::Adis16130};
use embedded_hal::{delay::DelayNs, digital::InputPin, spi::SpiDevice};

/// `spi`: mode 3, at most 10 MHz. `control` takes corrected rate codes, and whether the calibration holds at their
/// temperature.
pub fn run(spi: impl SpiDevice, rdy: impl InputPin, mut delay: impl DelayNs, mut control: impl FnMut(u32, bool)) -> ! {
    let mut gyro = Adis16130::new(spi, rdy, Config::new());
    let mut back_off = BackOff::new();
    loop {
        // at first, after a brown-out, with a broken wire: reset, initialise, read back
        let mut answers = gyro.restart().is_ok();
        while answers {
            match next(&mut gyro, &mut delay) {
                Ok((rate, temp)) => {
                    back_off.done();
                    control(unit::correct_code(rate.code24(), temp.code24()), unit::in_range(temp.code24()));
                }
                // not yet, or beyond the scale, where a code may have wrapped (F-35)
                Err(Error::Read(ReadError::NoReading(_) | ReadError::OutOfRange(_))) => {}
                Err(_) => answers = false,
            }
        }
        delay.delay_ms(back_off.pause_ms()); // 10 ms, doubled up to 1.28 s
    }
}

/// The next rate and temperature; silence for 2 ms is an error.
fn next<SPI: SpiDevice, RDY: InputPin>(
    gyro: &mut Adis16130<SPI, RDY>,
    delay: &mut impl DelayNs,
) -> Result<(RateCode, TempCode), Error<SPI::Error, RDY::Error>> {
    gyro.wait_ready(delay, WaitBound::from_us(2_000))?;
    Ok(gyro.read_in_range()?)
}
// README: end
