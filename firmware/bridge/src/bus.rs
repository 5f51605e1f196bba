//! The part's bus: an SPI controller, CS, and a clock that can be set.

use core::convert::Infallible;

use adis16130::MAX_SCLK_HZ;
use adis16130::bridge::Bus;
use embedded_hal::digital::OutputPin;
use embedded_hal_async::spi::{ErrorType, Operation, SpiBus, SpiDevice};
use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};

/// The part, alone on an SPI controller.
pub struct PartBus<B, CS> {
    device: ExclusiveDevice<B, CS, NoDelay>,
    set_clock: fn(&mut B, u32) -> u32,
}

impl<B: SpiBus, CS: OutputPin<Error = Infallible>> PartBus<B, CS> {
    /// Takes a controller in mode 3, MSB first (F-20), the pin of CS, and what does [`Bus::set_sclk_hz`] for clocks up to
    /// [`MAX_SCLK_HZ`]. Leaves CS high.
    pub fn new(controller: B, cs: CS, set_clock: fn(&mut B, u32) -> u32) -> Self {
        let Ok(device) = ExclusiveDevice::new_no_delay(controller, cs);
        Self { device, set_clock }
    }
}

impl<B: SpiBus, CS: OutputPin> ErrorType for PartBus<B, CS> {
    type Error = <ExclusiveDevice<B, CS, NoDelay> as ErrorType>::Error;
}

impl<B: SpiBus, CS: OutputPin> SpiDevice for PartBus<B, CS> {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
        self.device.transaction(operations).await
    }
}

impl<B: SpiBus, CS: OutputPin> Bus for PartBus<B, CS> {
    fn set_sclk_hz(&mut self, hz: u32) -> u32 {
        (self.set_clock)(self.device.bus_mut(), hz.min(MAX_SCLK_HZ))
    }
}
