//! The twin's bus, which can fail in the middle of a call, or on which a fault can set in.

use std::cell::RefCell;
use std::rc::Rc;

use adis16130_twin::{Fault, Twin, TwinSpi};
use embedded_hal::spi::{ErrorKind, ErrorType, Operation, SpiDevice};

/// A failure or fault that happens once.
#[derive(Copy, Clone, Debug)]
pub enum Trouble {
    /// A blocking transfer fails. An async transfer never ends, and its future is dropped.
    Cut,
    /// This fault of the part or its wires sets in.
    Fault(Fault),
}

/// The planned trouble, with the number of bytes before it, and the trouble that has happened since the last check.
/// The bus and the test share this record.
#[derive(Clone, Default)]
pub struct Ahead(Rc<RefCell<Troubles>>);

#[derive(Default)]
struct Troubles {
    ahead: Option<(u8, Trouble)>,
    struck: Option<Trouble>,
}

impl Ahead {
    pub fn set(&self, bytes: u8, trouble: Trouble) {
        self.0.borrow_mut().ahead = Some((bytes, trouble));
    }

    pub fn clear(&self) {
        self.0.borrow_mut().ahead = None;
    }

    pub fn take_struck(&self) -> Option<Trouble> {
        self.0.borrow_mut().struck.take()
    }

    /// Returns the trouble that happens in a transfer of `length` bytes, with the number of bytes before it.
    fn strike(&self, length: usize) -> Option<(usize, Trouble)> {
        let Troubles { ahead, struck } = &mut *self.0.borrow_mut();
        let (bytes, trouble) = (*ahead)?;
        let before = usize::from(bytes);
        if before < length {
            *ahead = None;
            *struck = Some(trouble);
            return Some((before, trouble));
        }
        *ahead = Some((bytes - length as u8, trouble));
        None
    }
}

pub struct Bus {
    spi: TwinSpi,
    twin: Twin,
    ahead: Ahead,
}

impl ErrorType for Bus {
    type Error = ErrorKind;
}

impl Bus {
    pub fn new(twin: &Twin, ahead: &Ahead) -> Self {
        Self { spi: twin.spi(), twin: twin.clone(), ahead: ahead.clone() }
    }

    /// Carries out one operation. Trouble stops it in the middle, or sets a fault there. The frame of a reset goes on
    /// whole, so a fault within it sets in before its first byte.
    fn carry_out(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        let [operation] = operations else { panic!("one operation per transaction: {operations:?}") };
        let length = match operation {
            Operation::Write(bytes) => bytes.len(),
            Operation::TransferInPlace(bytes) => bytes.len(),
            other => panic!("{other:?}"),
        };
        let Some((before, trouble)) = self.ahead.strike(length) else {
            return self.transact(operations);
        };
        match operation {
            Operation::TransferInPlace(bytes) => {
                self.transact(&mut [Operation::TransferInPlace(&mut bytes[..before])])?
            }
            Operation::Write(bytes) if matches!(trouble, Trouble::Cut) => {
                self.transact(&mut [Operation::Write(&bytes[..before])])?
            }
            _ => {}
        }
        let Trouble::Fault(fault) = trouble else { return Err(ErrorKind::Other) };
        self.twin.set_fault(fault);
        match operation {
            Operation::TransferInPlace(bytes) => {
                self.transact(&mut [Operation::TransferInPlace(&mut bytes[before..])])
            }
            _ => self.transact(operations),
        }
    }

    fn transact(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        SpiDevice::transaction(&mut self.spi, operations).map_err(|never| match never {})
    }
}

impl SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        self.carry_out(operations)
    }
}

#[cfg(feature = "async")]
impl embedded_hal_async::spi::SpiDevice for Bus {
    async fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), ErrorKind> {
        match self.carry_out(operations) {
            Err(_) => std::future::pending().await,
            done => done,
        }
    }
}
