//! The errors of the driver: one enum per operation, with the evidence (register, expected value, received value).

use core::convert::Infallible;
use core::fmt::{Debug, Display, Formatter, Result};

use crate::codes::{RateCode, Width};
use crate::diagnosis::Fault;
use crate::readback::Differences;
use crate::registers::{Address, ChannelStatus, Mode, Operation};

/// The error of a command, and so the error of reading or writing a single register.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BusError<E> {
    /// The bus returned an error for a transfer. The part may be in the middle of the command, which CS alone does not
    /// end (F-22). So every later command returns [`Interrupted`](Self::Interrupted), until a reset.
    Transfer {
        /// The register that was addressed.
        register: Address,
        /// The error that the bus returned.
        error: E,
    },
    /// A command before this one was cut short: its transfer failed, or the future of an async call was dropped. The
    /// part's next bytes would be read shifted, so nothing was sent. `reset` or `restart` ends this state.
    Interrupted {
        /// The register that was addressed by the interrupted command.
        register: Address,
    },
}

impl<E: Debug> Display for BusError<E> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Transfer { register, error } => write!(
                f,
                "the SPI transfer for {register} failed ({error:?}): check the host's SPI settings and that the port \
                 is still there, then reset and initialise the part"
            ),
            Self::Interrupted { register } => write!(
                f,
                "the command for {register} was cut short (failed transfer or dropped future), so the next bytes \
                 would be misread: reset and initialise the part"
            ),
        }
    }
}

/// The error of a checked read.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ReadError<E> {
    /// A command failed on the bus, or was not sent.
    Bus(BusError<E>),
    /// The line or the part is at fault.
    Fault(Fault),
    /// The link is healthy, and the input is out of range (F-35).
    OutOfRange(OutOfRange),
    /// The link is healthy, but there is no reading yet.
    NoReading(NoReading),
}

/// The error of an initialisation.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum InitError<E> {
    /// A command failed (see [`BusError`]). The registers before the failed one have been written.
    Bus(BusError<E>),
    /// All registers were written, but reading them back failed, or one differs from what was written.
    Verify(VerifyError<E>),
}

/// The error of reading the written registers back.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum VerifyError<E> {
    /// A command failed on the bus, or was not sent.
    Bus(BusError<E>),
    /// MODE has not been written since the reset, so there is nothing to verify.
    NotInitialised,
    /// Every register reads FFh: SDO is stuck at ones.
    StuckHigh(Differences),
    /// Every register reads 00h: SDO is stuck at zeros.
    StuckLow(Differences),
    /// MODE reads 00h: the part has been reset, for example by a brown-out.
    ConfigurationLost(Differences),
    /// Some registers read back differently.
    Differs(Differences),
}

/// The error of reading a sample at an edge. The next [`Sample`](crate::Sample) counts the lost rate samples.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SampleError<E> {
    /// A command failed on the bus, or was not sent.
    Bus(BusError<E>),
    /// The line or the part is at fault.
    Fault(Fault),
    /// The link is healthy, and the temperature is at the end of its scale. (An out-of-range rate is in the status of
    /// the sample.)
    OutOfRange(OutOfRange),
}

/// The error of a wait for data. `E` is the error of the bus, `R` of the RDY pin.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WaitError<E, R> {
    /// The RDY pin could not be read.
    Pin(R),
    /// The status that confirms RDY could not be read.
    Status(ReadError<E>),
    /// There was no new data within the bound.
    TimedOut {
        /// The bound, in µs.
        timeout_us: u32,
    },
}

/// The error of a self-test. `E` is the error of the bus, `R` of the RDY pin, `P` of the self-test pin. Except after
/// [`Pin`](Self::Pin), the self-test pin is low again.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SelfTestError<E, R, P> {
    /// A reading failed.
    Read(ReadError<E>),
    /// The RDY pin could not be read, or no data came within the bound.
    Wait(WaitError<E, R>),
    /// The self-test pin could not be set or released. If it is still active, the rate is offset.
    Pin(P),
}

/// Any error of the driver, for functions that do several things. The question mark operator converts each operation's
/// error.
///
/// `E` is the error of the bus, `R` of the RDY pin, `P` of the self-test pin.
///
/// ```
/// use adis16130::{Error, RateCode, WaitBound, blocking::Adis16130};
/// use embedded_hal::{delay::DelayNs, digital::InputPin, spi::SpiDevice};
///
/// fn first_rate<SPI: SpiDevice, RDY: InputPin>(
///     gyro: &mut Adis16130<SPI, RDY>,
///     delay: &mut impl DelayNs,
/// ) -> Result<RateCode, Error<SPI::Error, RDY::Error>> {
///     gyro.restart()?; // an InitError
///     gyro.wait_ready(delay, WaitBound::from_us(2_000))?; // a WaitError
///     Ok(gyro.read_rate_in_range()?) // a ReadError
/// }
/// ```
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Error<E, R = Infallible, P = Infallible> {
    /// A command failed on the bus, or was not sent.
    Bus(BusError<E>),
    /// The initialisation failed.
    Init(InitError<E>),
    /// Reading the configuration back failed.
    Verify(VerifyError<E>),
    /// A checked read failed.
    Read(ReadError<E>),
    /// An edge gave no sample.
    Sample(SampleError<E>),
    /// A wait ended without data.
    Wait(WaitError<E, R>),
    /// The self-test failed.
    SelfTest(SelfTestError<E, R, P>),
    /// `diagnose` found a fault.
    Fault(Fault),
}

/// A reading that is or may be out of range: saturated with CLAMP = 1, wrapped with CLAMP = 0 (F-35).
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct OutOfRange {
    /// The data register.
    pub register: Address,
    /// The code that was read. It is not a measure of the input.
    pub code: u32,
    /// The width of the register.
    pub width: Width,
    /// The status of the channel if it was read (OVR, and SIGN for the side). `None` if the code itself is the end of
    /// the scale.
    pub status: Option<ChannelStatus>,
}

/// The evidence that there is no reading yet: a data register holds its reset value, and no conversion of its channel
/// is known to have ended since MODE was written.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct NoReading {
    /// The data register.
    pub register: Address,
    /// The value of MODE, which reads back as it was written.
    pub mode: Mode,
}

impl OutOfRange {
    #[cold]
    pub(crate) const fn of_rate(rate: RateCode, status: ChannelStatus) -> Self {
        Self { register: Address::RateData, code: rate.code(), width: rate.width(), status: Some(status) }
    }
}

impl Display for OutOfRange {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let digits = 2 * self.width.bytes();
        write!(f, "{} reads {:0digits$X}h, ", self.register, self.code)?;
        f.write_str(match self.status {
            None => "the end of its scale, on a healthy link: the input is out of range",
            Some(status) if !status.out_of_range() => "so close to the end of its scale that it may have left it",
            Some(status) if status.negative() => "but its status says that the input is below the range",
            Some(_) => "but its status says that the input is above the range",
        })?;
        f.write_str("; bring it back and read again")
    }
}

impl Display for NoReading {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        write!(f, "{} holds no reading yet: ", self.register)?;
        f.write_str(match self.mode.operation() {
            Operation::Continuous | Operation::Single => {
                "its first conversion has not ended, or its channel is disabled; wait for RDY (pin 10) and read again"
            }
            _ => "the part does not convert; initialise it and wait for RDY (pin 10)",
        })
    }
}

impl<E> VerifyError<E> {
    pub(crate) fn judge(seen: Differences) -> core::result::Result<(), Self> {
        if seen.iter().next().is_none() {
            Ok(())
        } else if seen.is_all_ones() {
            Err(Self::StuckHigh(seen))
        } else if seen.is_all_zeros() {
            Err(Self::StuckLow(seen))
        } else if seen.iter().any(|mismatch| mismatch.register == Address::Mode && mismatch.got == 0) {
            Err(Self::ConfigurationLost(seen))
        } else {
            Err(Self::Differs(seen))
        }
    }
}

impl<E: Debug> Display for VerifyError<E> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        let (cause, differences) = match self {
            Self::Bus(error) => return Display::fmt(error, f),
            Self::NotInitialised => {
                return write!(f, "the part has not been initialised since its reset: call init() first");
            }
            Self::StuckHigh(differences) => (Fault::STUCK_HIGH, differences),
            Self::StuckLow(differences) => (Fault::STUCK_LOW, differences),
            Self::ConfigurationLost(differences) => (Fault::CONFIGURATION_LOST, differences),
            Self::Differs(differences) => (Fault::UNEXPECTED, differences),
        };
        write!(f, "{differences}: {cause}")
    }
}

impl<E: Debug, R: Debug> Display for WaitError<E, R> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Pin(error) => {
                write!(f, "the RDY pin cannot be read ({error:?}): check the GPIO settings of the host")
            }
            Self::Status(error) => Display::fmt(error, f),
            Self::TimedOut { timeout_us } => write!(
                f,
                "RDY (pin 10) gave no sign of new data within {timeout_us} µs: \
                 check its wire, and that the part is initialised and powered"
            ),
        }
    }
}

impl<E: Debug, R: Debug, P: Debug> Display for SelfTestError<E, R, P> {
    fn fmt(&self, f: &mut Formatter<'_>) -> Result {
        match self {
            Self::Read(error) => Display::fmt(error, f),
            Self::Wait(error) => Display::fmt(error, f),
            Self::Pin(error) => write!(
                f,
                "the self-test pin cannot be set ({error:?}): \
                 check the GPIO settings of the host; an active self-test offsets the rate"
            ),
        }
    }
}

/// Implements `Display` by the text of the inner error.
macro_rules! forward {
    ($($error:ident<$($parameter:ident),*>: $($variant:ident),*;)*) => {$(
        impl<$($parameter: Debug),*> Display for $error<$($parameter),*> {
            fn fmt(&self, f: &mut Formatter<'_>) -> Result {
                match self {
                    $(Self::$variant(error) => Display::fmt(error, f),)*
                }
            }
        }
    )*};
}

forward! {
    ReadError<E>: Bus, Fault, OutOfRange, NoReading;
    InitError<E>: Bus, Verify;
    SampleError<E>: Bus, Fault, OutOfRange;
    Error<E, R, P>: Bus, Init, Verify, Read, Sample, Wait, SelfTest, Fault;
}

impl<E: Debug, R: Debug, P: Debug> core::error::Error for Error<E, R, P> {}
impl<E: Debug> core::error::Error for BusError<E> {}
impl<E: Debug> core::error::Error for ReadError<E> {}
impl<E: Debug> core::error::Error for InitError<E> {}
impl<E: Debug> core::error::Error for VerifyError<E> {}
impl<E: Debug> core::error::Error for SampleError<E> {}
impl<E: Debug, R: Debug> core::error::Error for WaitError<E, R> {}
impl<E: Debug, R: Debug, P: Debug> core::error::Error for SelfTestError<E, R, P> {}

/// Implements `From`, so that `?` converts the error of a step to the error of the whole operation.
macro_rules! widen {
    ($(<$($parameter:ident),*> $from:ty => $to:ident::$variant:ident;)*) => {$(
        impl<$($parameter),*> From<$from> for $to<$($parameter),*> {
            fn from(error: $from) -> Self {
                Self::$variant(error)
            }
        }
    )*};
}

widen! {
    <E> BusError<E> => ReadError::Bus;
    <E> BusError<E> => InitError::Bus;
    <E> BusError<E> => VerifyError::Bus;
    <E> BusError<E> => SampleError::Bus;
    <E> Fault => ReadError::Fault;
    <E> Fault => SampleError::Fault;
    <E> OutOfRange => ReadError::OutOfRange;
    <E> OutOfRange => SampleError::OutOfRange;
    <E> VerifyError<E> => InitError::Verify;
    <E, R> ReadError<E> => WaitError::Status;
    <E, R, P> ReadError<E> => SelfTestError::Read;
    <E, R, P> WaitError<E, R> => SelfTestError::Wait;
    <E, R, P> BusError<E> => Error::Bus;
    <E, R, P> InitError<E> => Error::Init;
    <E, R, P> VerifyError<E> => Error::Verify;
    <E, R, P> ReadError<E> => Error::Read;
    <E, R, P> SampleError<E> => Error::Sample;
    <E, R, P> WaitError<E, R> => Error::Wait;
    <E, R, P> SelfTestError<E, R, P> => Error::SelfTest;
    <E, R, P> Fault => Error::Fault;
}

impl<E> From<SampleError<E>> for ReadError<E> {
    fn from(error: SampleError<E>) -> Self {
        match error {
            SampleError::Bus(error) => Self::Bus(error),
            SampleError::Fault(fault) => Self::Fault(fault),
            SampleError::OutOfRange(reading) => Self::OutOfRange(reading),
        }
    }
}
