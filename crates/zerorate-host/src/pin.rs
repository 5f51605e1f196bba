//! The RDY pin and the delay that the driver needs for a self-test, for a part whose RDY edges arrive as events.

use crate::Stop;
use crate::edges::Edges;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin};
use embedded_hal::spi;
use std::cell::RefCell;
use std::fmt;

/// Longest wait for an edge in one call of `is_low`, ns.
const LOOK_NS: u64 = 1_000_000;

/// The error of a pin or a bus, as a text.
pub struct HalError(String);

impl HalError {
    pub fn new(error: impl fmt::Display) -> Self {
        Self(format!("{error:#}"))
    }
}

impl fmt::Debug for HalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for HalError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl spi::Error for HalError {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

/// The level of RDY, derived from edges: low, as after a falling edge, if there is an unread edge.
pub struct Ready<'a, E> {
    pub edges: &'a RefCell<&'a mut E>,
    pub stop: &'a Stop,
}

impl<E> ErrorType for Ready<'_, E> {
    type Error = HalError;
}

impl<E: Edges> InputPin for Ready<'_, E> {
    fn is_low(&mut self) -> Result<bool, HalError> {
        if self.stop.asked() {
            return Err(HalError::new("interrupted"));
        }
        self.edges.borrow_mut().next(LOOK_NS).map(|edge| edge.is_some()).map_err(HalError::new)
    }

    fn is_high(&mut self) -> Result<bool, HalError> {
        self.is_low().map(|low| !low)
    }
}

/// A delay on the clock of the edges, which may be simulated.
pub struct Pause<'a, E>(pub &'a RefCell<&'a mut E>);

impl<E: Edges> DelayNs for Pause<'_, E> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().pause(ns.into());
    }
}
