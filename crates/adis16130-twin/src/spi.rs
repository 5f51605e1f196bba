//! The SPI port, with the blocking and the async trait of embedded-hal.

use crate::part::Part;
use alloc::rc::Rc;
use core::cell::RefCell;
use core::convert::Infallible;
use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

/// The SPI port: mode 3, MSB first (F-20), at [`Spec::sclk_hz`](crate::Spec::sclk_hz). One transaction is one frame of
/// CS. SDI is 0 while the host only reads (F-23).
///
/// A transaction lets simulated time pass: 8 clocks per byte, and [`Spec::cs_gap_ns`](crate::Spec::cs_gap_ns) of high
/// CS after it.
#[derive(Debug)]
pub struct TwinSpi {
    part: Rc<RefCell<Part>>,
}

impl TwinSpi {
    pub(crate) fn new(part: &Rc<RefCell<Part>>) -> Self {
        Self { part: Rc::clone(part) }
    }

    #[inline]
    fn frame(&mut self, operations: &mut [Operation<'_, u8>]) {
        let mut part = self.part.borrow_mut();
        for operation in operations {
            carry_out(&mut part, operation);
        }
        part.deselect();
    }
}

#[inline]
fn carry_out(part: &mut Part, operation: &mut Operation<'_, u8>) {
    match operation {
        Operation::Read(read) => {
            for byte in read.iter_mut() {
                *byte = part.exchange(0);
            }
        }
        Operation::Write(write) => {
            for &byte in write.iter() {
                part.exchange(byte);
            }
        }
        Operation::Transfer(read, write) => {
            for i in 0..read.len().max(write.len()) {
                let sdo = part.exchange(write.get(i).copied().unwrap_or(0));
                if let Some(byte) = read.get_mut(i) {
                    *byte = sdo;
                }
            }
        }
        Operation::TransferInPlace(both) => {
            for byte in both.iter_mut() {
                *byte = part.exchange(*byte);
            }
        }
        Operation::DelayNs(ns) => part.advance_ps(u64::from(*ns) * 1000),
    }
}

impl ErrorType for TwinSpi {
    type Error = Infallible;
}

impl SpiDevice for TwinSpi {
    #[inline]
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        self.frame(operations);
        Ok(())
    }
}

impl embedded_hal_async::spi::SpiDevice for TwinSpi {
    #[inline]
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        self.frame(operations);
        Ok(())
    }
}
