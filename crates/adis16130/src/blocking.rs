//! The driver over blocking traits: [`embedded_hal::spi::SpiDevice`], [`InputPin`](embedded_hal::digital::InputPin).
//!
//! One reading, on the software twin of the part:
//!
//! ```
//! use adis16130::{Config, Error, WaitBound, blocking::Adis16130};
//! use adis16130_twin::{Spec, Twin};
//!
//! let twin = Twin::new(Spec::from_seed(1)); // on a board: an SpiDevice, an InputPin and a DelayNs
//! let mut delay = twin.delay();
//! let mut gyro = Adis16130::new(twin.spi(), twin.rdy(), Config::new());
//! assert!(gyro.read_in_range().is_err()); // not initialised: no reading
//! gyro.restart()?;
//! gyro.wait_ready(&mut delay, WaitBound::from_us(2_000))?;
//! let (rate, temp) = gyro.read_in_range()?;
//! assert!(rate.to_dps().abs() < 10.0 && (0.0..60.0).contains(&temp.to_celsius()));
//! # Ok::<(), Error<_, _>>(())
//! ```

use bisync_macros::internal_strip_async as bisync;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::InputPin as RdyPin;
use embedded_hal::spi::SpiDevice;

use crate::config::RdyEdge;
use crate::error::WaitError;
use crate::wait::WaitBound;

pub use driver::Adis16130;

#[path = "driver.rs"]
#[allow(clippy::duplicate_mod, reason = "both drivers are made of this one source")]
mod driver;

impl<SPI: SpiDevice, RDY: RdyPin> Adis16130<SPI, RDY> {
    /// Waits until RDY shows unread data (F-32). Reads the pin at most `bound.polls() + 1` times.
    fn wait_for_rdy(
        &mut self,
        delay: &mut impl DelayNs,
        bound: WaitBound,
    ) -> Result<(), WaitError<SPI::Error, RDY::Error>> {
        for _ in 0..bound.polls() {
            if self.is_ready()? {
                return Ok(());
            }
            delay.delay_us(bound.poll().us());
        }
        if self.is_ready()? {
            return Ok(());
        }
        Err(WaitError::TimedOut { timeout_us: bound.timeout_us() })
    }

    fn is_ready(&mut self) -> Result<bool, WaitError<SPI::Error, RDY::Error>> {
        match self.config.rdy_edge() {
            RdyEdge::Falling => self.rdy.is_low(),
            RdyEdge::Rising => self.rdy.is_high(),
        }
        .map_err(WaitError::Pin)
    }
}
