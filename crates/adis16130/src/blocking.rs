//! The driver over blocking traits: [`embedded_hal::spi::SpiDevice`], [`InputPin`](embedded_hal::digital::InputPin).

use embedded_hal::delay::DelayNs;
use embedded_hal::digital::InputPin as RdyPin;
use embedded_hal::spi::SpiDevice;

use crate::config::RdyEdge;
use crate::error::WaitError;
use crate::wait::WaitBound;

crate::shell::shell!([] []);

impl<SPI, RDY: RdyPin> Adis16130<SPI, RDY> {
    /// Waits until RDY says that data waits (F-32), looking at the pin at most `bound.polls() + 1` times.
    pub fn wait_ready(&mut self, delay: &mut impl DelayNs, bound: WaitBound) -> Result<(), WaitError<RDY::Error>> {
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

    fn is_ready(&mut self) -> Result<bool, WaitError<RDY::Error>> {
        match self.config.rdy_edge() {
            RdyEdge::Falling => self.rdy.is_low(),
            RdyEdge::Rising => self.rdy.is_high(),
        }
        .map_err(WaitError::Pin)
    }
}
