//! Implements the embedded-hal traits by calling the caller's functions.

use core::ffi::c_void;
use embedded_hal::delay::DelayNs;
use embedded_hal::digital::{self, InputPin, OutputPin};
use embedded_hal::spi::{self, Operation, SpiDevice};

/// The caller's functions that access the part. Each gets `context` as its first argument.
///
/// The library calls these functions from inside its own, in the same thread or interrupt. They must not call a
/// function on the same object. `context` must stay valid as long as the object that was set up with it is used.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct Bus {
    /// Passed to each of the functions. May be null.
    pub context: *mut c_void,
    /// Sends `length` bytes and replaces them by the received ones, with CS low from the first bit to the last. SPI
    /// mode 3, most significant bit first, at most 10 MHz (F-20, F-21). Returns 0, or anything else for an error. Must
    /// not be null.
    pub transfer: Option<unsafe extern "C" fn(context: *mut c_void, bytes: *mut u8, length: usize) -> i32>,
    /// Returns the level of RDY: 1 = high, 0 = low, negative = error. May be null if neither zerorate_gyro_wait_ready
    /// nor zerorate_gyro_self_test is used.
    pub rdy: Option<unsafe extern "C" fn(context: *mut c_void) -> i32>,
    /// Waits for `us` microseconds, or a little longer. May be null under the same condition as `rdy`.
    pub delay_us: Option<unsafe extern "C" fn(context: *mut c_void, us: u32)>,
}

/// The output that drives the self-test pins 1-7 and 9, which are tied together (F-11). The rules for the functions of
/// the bus also hold for `set`.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct SelfTestPin {
    /// Passed to `set`. May be null.
    pub context: *mut c_void,
    /// Drives the pins: 1 = high, self-test on, 0 = low, self-test off. Returns 0, or another number for an error.
    pub set: Option<unsafe extern "C" fn(context: *mut c_void, level: i32) -> i32>,
}

/// The error for a function that is null or returned an error, or for a transaction that the driver never makes.
#[derive(Clone, Copy, Debug)]
pub struct CallbackError;

impl spi::Error for CallbackError {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl digital::Error for CallbackError {
    fn kind(&self) -> digital::ErrorKind {
        digital::ErrorKind::Other
    }
}

/// Length of the longest write that is not a transfer in place, bytes: the reset of F-23.
const LONGEST_WRITE: usize = 5;

impl Bus {
    fn exchange(&mut self, bytes: &mut [u8]) -> Result<(), CallbackError> {
        let transfer = self.transfer.ok_or(CallbackError)?;
        // SAFETY: the caller promised at set-up that this may be called with its context; bytes and length belong
        // together.
        match unsafe { transfer(self.context, bytes.as_mut_ptr(), bytes.len()) } {
            0 => Ok(()),
            _ => Err(CallbackError),
        }
    }
}

impl spi::ErrorType for Bus {
    type Error = CallbackError;
}

impl SpiDevice for Bus {
    /// Accepts only the two kinds of transaction that the driver makes: one transfer in place, or one short write.
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), CallbackError> {
        match operations {
            [Operation::TransferInPlace(bytes)] => self.exchange(bytes),
            [Operation::Write(bytes)] => {
                let mut copy = [0; LONGEST_WRITE];
                let copy = copy.get_mut(..bytes.len()).ok_or(CallbackError)?;
                copy.iter_mut().zip(bytes.iter()).for_each(|(to, from)| *to = *from);
                self.exchange(copy)
            }
            _ => Err(CallbackError),
        }
    }
}

impl digital::ErrorType for Bus {
    type Error = CallbackError;
}

impl InputPin for Bus {
    fn is_high(&mut self) -> Result<bool, CallbackError> {
        let rdy = self.rdy.ok_or(CallbackError)?;
        // SAFETY: as for `transfer`.
        match unsafe { rdy(self.context) } {
            ..0 => Err(CallbackError),
            level => Ok(level != 0),
        }
    }

    fn is_low(&mut self) -> Result<bool, CallbackError> {
        self.is_high().map(|high| !high)
    }
}

impl SelfTestPin {
    fn drive(&mut self, level: i32) -> Result<(), CallbackError> {
        let set = self.set.ok_or(CallbackError)?;
        // SAFETY: the caller of the self-test promised that this may be called with its context.
        match unsafe { set(self.context, level) } {
            0 => Ok(()),
            _ => Err(CallbackError),
        }
    }
}

impl digital::ErrorType for SelfTestPin {
    type Error = CallbackError;
}

impl OutputPin for SelfTestPin {
    fn set_low(&mut self) -> Result<(), CallbackError> {
        self.drive(0)
    }

    fn set_high(&mut self) -> Result<(), CallbackError> {
        self.drive(1)
    }
}

impl DelayNs for Bus {
    fn delay_ns(&mut self, ns: u32) {
        self.delay_us(ns.div_ceil(1000));
    }

    fn delay_us(&mut self, us: u32) {
        if let Some(delay_us) = self.delay_us {
            // SAFETY: as for `transfer`.
            unsafe { delay_us(self.context, us) }
        }
    }
}
