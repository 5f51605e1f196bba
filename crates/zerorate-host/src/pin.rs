//! The pins for the driver's self-test, for a part whose edges come as events.

use crate::Stop;
use crate::edges::Edges;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{Error, ErrorKind, ErrorType, InputPin};
use std::cell::RefCell;
use std::fmt;

/// Longest single wait for an edge, ns.
const LOOK_NS: u64 = 1_000_000;

/// The error of a pin that cannot be set or read.
pub struct PinError(String);

impl PinError {
    pub fn new(error: impl fmt::Display) -> Self {
        Self(format!("{error:#}"))
    }
}

impl fmt::Debug for PinError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl Error for PinError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

/// RDY as a level. It is low, as after a falling edge, if an edge has come that was not read yet.
pub struct Ready<'a, E> {
    pub edges: &'a RefCell<&'a mut E>,
    pub stop: &'a Stop,
}

impl<E> ErrorType for Ready<'_, E> {
    type Error = PinError;
}

impl<E: Edges> InputPin for Ready<'_, E> {
    fn is_low(&mut self) -> Result<bool, PinError> {
        if self.stop.asked() {
            return Err(PinError::new("interrupted"));
        }
        self.edges.borrow_mut().next(LOOK_NS).map(|edge| edge.is_some()).map_err(PinError::new)
    }

    fn is_high(&mut self) -> Result<bool, PinError> {
        self.is_low().map(|low| !low)
    }
}

/// A delay in the time of the source of the edges.
pub struct Pause<'a, E>(pub &'a RefCell<&'a mut E>);

impl<E: Edges> DelayNs for Pause<'_, E> {
    fn delay_ns(&mut self, ns: u32) {
        self.0.borrow_mut().pause(ns.into());
    }
}
