//! The part's bus: SPI with a clock that can be set, CS, the self-test pin, and the edge of RDY that announces data.

use core::convert::Infallible;

use adis16130::bridge::Bus;
use adis16130::{MAX_SCLK_HZ, RdyEdge};
use embedded_hal::digital::OutputPin;
use embedded_hal_async::spi::{ErrorType, Operation, SpiBus, SpiDevice};
use embedded_hal_bus::spi::{ExclusiveDevice, NoDelay};

use crate::Link;

/// The bus of a part that is alone on an SPI controller.
pub struct PartBus<B, CS, ST> {
    device: ExclusiveDevice<B, CS, NoDelay>,
    set_clock: fn(&mut B, u32) -> u32,
    self_test: ST,
    link: &'static Link,
}

impl<B: SpiBus, CS: OutputPin<Error = Infallible>, ST: OutputPin<Error = Infallible>> PartBus<B, CS, ST> {
    /// Makes the bus from a controller in mode 3, MSB first (F-20), and the pin of CS. `set_clock` carries out
    /// [`Bus::set_sclk_hz`] for clocks up to [`MAX_SCLK_HZ`]. `self_test` drives the self-test pins (F-11). `link` is
    /// the link that [`watch`](crate::sampling::watch) uses. Leaves CS high.
    pub fn new(controller: B, cs: CS, set_clock: fn(&mut B, u32) -> u32, self_test: ST, link: &'static Link) -> Self {
        let Ok(device) = ExclusiveDevice::new_no_delay(controller, cs);
        Self { device, set_clock, self_test, link }
    }
}

impl<B: SpiBus, CS: OutputPin, ST> ErrorType for PartBus<B, CS, ST> {
    type Error = <ExclusiveDevice<B, CS, NoDelay> as ErrorType>::Error;
}

impl<B: SpiBus, CS: OutputPin, ST> SpiDevice for PartBus<B, CS, ST> {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Self::Error> {
        self.device.transaction(operations).await
    }
}

impl<B: SpiBus, CS: OutputPin, ST: OutputPin<Error = Infallible>> Bus for PartBus<B, CS, ST> {
    fn set_sclk_hz(&mut self, hz: u32) -> u32 {
        (self.set_clock)(self.device.bus_mut(), hz.min(MAX_SCLK_HZ))
    }

    fn set_rdy_edge(&mut self, edge: RdyEdge) -> bool {
        self.link.heard.signal(edge);
        true
    }

    fn set_self_test(&mut self, on: bool) -> bool {
        let Ok(()) = self.self_test.set_state(on.into());
        true
    }
}
