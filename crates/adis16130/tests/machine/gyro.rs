//! Calls the blocking or the async driver by the same macros.

use adis16130::blocking;
use adis16130_twin::{Twin, TwinRdy};

use crate::bus::{Ahead, Bus};

#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub enum Form {
    Blocking,
    #[cfg(feature = "async")]
    Async,
}

pub enum Gyro {
    Blocking(blocking::Adis16130<Bus, TwinRdy>),
    #[cfg(feature = "async")]
    Async(adis16130::asynch::Adis16130<Bus, TwinRdy>),
}

impl Gyro {
    pub fn new(form: Form, twin: &Twin, ahead: &Ahead, config: adis16130::Config) -> Self {
        let (bus, rdy) = (Bus::new(twin, ahead), twin.rdy());
        match form {
            Form::Blocking => Self::Blocking(blocking::Adis16130::new(bus, rdy, config)),
            #[cfg(feature = "async")]
            Form::Async => Self::Async(adis16130::asynch::Adis16130::new(bus, rdy, config)),
        }
    }
}

/// Calls a method of the driver. The result is `None` if the future of an async call was dropped.
macro_rules! call {
    ($gyro:expr, $method:ident $(::<$register:ty>)? ($($argument:expr),*)) => {
        match &mut $gyro {
            $crate::gyro::Gyro::Blocking(gyro) => Some(gyro.$method$(::<$register>)?($($argument),*)),
            #[cfg(feature = "async")]
            $crate::gyro::Gyro::Async(gyro) => {
                $crate::gyro::polled(gyro.$method$(::<$register>)?($($argument),*))
            }
        }
    };
}

/// Evaluates an expression on the blocking or the async driver, whichever is in use.
macro_rules! on {
    ($gyro:expr, $it:ident => $use:expr) => {
        match $gyro {
            $crate::gyro::Gyro::Blocking($it) => $use,
            #[cfg(feature = "async")]
            $crate::gyro::Gyro::Async($it) => $use,
        }
    };
}

pub(crate) use {call, on};

/// Returns the output of a future that is ready at once, otherwise `None`. Simulated time passes within a call, so a
/// future that is not ready will never be.
#[cfg(feature = "async")]
pub fn polled<F: Future>(future: F) -> Option<F::Output> {
    use std::task::{Context, Poll, Waker};
    match std::pin::pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(output) => Some(output),
        Poll::Pending => None,
    }
}
