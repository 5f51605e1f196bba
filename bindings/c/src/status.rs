//! The status numbers that the functions return, and their texts.

use adis16130::{BusError, Fault, InitError, ReadError, SelfTestError, VerifyError, WaitError};
use core::ffi::{CStr, c_char};
use zerorate::{Refusal, TableError};

/// The result of a function: ZERORATE_OK, a positive number for a harmless state, or a negative number for a failure.
/// The numbers keep their meaning in all versions.
pub type Status = i32;

/// Success.
pub const ZERORATE_OK: Status = 0;
/// No result, and no failure: nothing was due at this edge, the data of the edge had been read before, no temperature
/// has come yet, or the rate is NaN.
pub const ZERORATE_NOTHING: Status = 1;
/// Initialise the part, then call zerorate_procedure_initialised.
pub const ZERORATE_INITIALISE: Status = 10;
/// Pass each sample to zerorate_procedure_sample. While no samples come, pass the time to zerorate_procedure_time.
pub const ZERORATE_SAMPLE: Status = 11;
/// The calibration is complete: call zerorate_procedure_outcome.
pub const ZERORATE_DONE: Status = 12;
/// A pointer that must not be null is null.
pub const ZERORATE_E_NULL: Status = -1;
/// The object has not been set up, or the call came too early, such as zerorate_procedure_outcome before the end.
pub const ZERORATE_E_STATE: Status = -2;
/// An argument is out of range. The documentation of the argument states the range.
pub const ZERORATE_E_ARGUMENT: Status = -3;
/// `transfer` returned a number other than 0. The part may be in the middle of a command: initialise it.
pub const ZERORATE_E_BUS: Status = -10;
/// `rdy` or `delay_us` is null, or `rdy` returned a negative number.
pub const ZERORATE_E_PIN: Status = -11;
/// RDY gave no sign of new data within the time given.
pub const ZERORATE_E_TIMEOUT: Status = -12;
/// A function that the self-test needs is null: `rdy` or `delay_us` of the bus, or `set` of the pin. Nothing was done.
pub const ZERORATE_E_MISSING: Status = -13;
/// `set` of the self-test pin returned a number other than 0. If the self-test is still on, it offsets the rate.
pub const ZERORATE_E_SELF_TEST_PIN: Status = -14;
/// `transfer` has failed in an earlier call, so the part may be in the middle of a command, and its bytes would be
/// misread. Nothing was sent: initialise the part.
pub const ZERORATE_E_INTERRUPTED: Status = -15;
/// SDO is stuck at ones: check its wire, CS, the supply and SPI mode 3.
pub const ZERORATE_E_STUCK_HIGH: Status = -20;
/// SDO is stuck at zeros: check its wire, CS, the supply and SPI mode 3.
pub const ZERORATE_E_STUCK_LOW: Status = -21;
/// The part has been reset, for example by a dip of the supply: initialise it.
pub const ZERORATE_E_CONFIGURATION_LOST: Status = -22;
/// A register does not read the value that was written, or a status names the wrong channel: the line has bit errors,
/// or a wrong SPI mode, or the part is another one, or this object did not initialise it.
pub const ZERORATE_E_UNEXPECTED: Status = -23;
/// The input is out of range (F-35). The link is healthy.
pub const ZERORATE_E_OUT_OF_RANGE: Status = -24;
/// The link is healthy, but no reading exists yet. The part has not been initialised, or its first conversion has not
/// ended. Initialise it, wait for RDY and read again.
pub const ZERORATE_E_NO_READING: Status = -25;
/// A coefficient is not finite, or does not fit the integer correction. A line fits if |BTC| is at most 1.19 deg/s
/// per deg C, and PBC and T3 are within the range of the codes.
pub const ZERORATE_E_COEFFICIENT: Status = -30;
/// Step or span is not positive, the span is not a whole number of steps, or the table has more than 100001 rows.
pub const ZERORATE_E_TABLE_LAYOUT: Status = -31;
/// The memory has fewer rows than the table.
pub const ZERORATE_E_TABLE_ROOM: Status = -32;
/// A row of the table, in millionths of a deg/s, does not fit 32 bits.
pub const ZERORATE_E_TABLE_STEEP: Status = -33;
/// The temperature lies more than half a step beyond the table. The row at the end of the table was written.
pub const ZERORATE_E_TABLE_OUTSIDE: Status = -34;
/// A duration or limit of the plan is not valid.
pub const ZERORATE_E_PLAN: Status = -40;
/// Refused: the rate varies more than noise and temperature explain, or it jumped during an average.
pub const ZERORATE_E_MOVING: Status = -50;
/// Refused: the mean rate is larger than a bias can be.
pub const ZERORATE_E_TURNING: Status = -51;
/// Refused: the white noise is far above the typical one.
pub const ZERORATE_E_NOISY: Status = -52;
/// Refused: the two temperatures are too close for the wanted uncertainty of BTC.
pub const ZERORATE_E_SPAN: Status = -53;
/// Refused: BTC would be too uncertain, because two temperatures cannot show a curvature.
pub const ZERORATE_E_CURVATURE: Status = -54;
/// Refused: too many samples were lost.
pub const ZERORATE_E_LOST: Status = -55;
/// Refused: readings were out of range.
pub const ZERORATE_E_OVERRANGED: Status = -56;
/// Refused: the readings stopped changing.
pub const ZERORATE_E_FROZEN: Status = -57;
/// Refused: a window holds too few samples.
pub const ZERORATE_E_TOO_FEW: Status = -58;
/// Refused: a window holds no temperature.
pub const ZERORATE_E_NO_TEMPERATURE: Status = -59;
/// Refused: the rate wanders or steps so much during the offset average that BTC would be too uncertain.
pub const ZERORATE_E_UNSTEADY: Status = -61;
/// Refused, for a reason for which this version of the interface has no number.
pub const ZERORATE_E_REFUSED: Status = -60;

/// Returns a status in words: a static string without an end of line, never null.
#[unsafe(no_mangle)]
pub extern "C" fn zerorate_text(status: Status) -> *const c_char {
    let text: &'static CStr = match status {
        ZERORATE_OK => c"done",
        ZERORATE_NOTHING => c"nothing was due, the edge was stale, or no temperature was read yet",
        ZERORATE_INITIALISE => c"initialise the part",
        ZERORATE_SAMPLE => c"pass the next sample",
        ZERORATE_DONE => c"the calibration is complete",
        ZERORATE_E_NULL => c"a pointer is null",
        ZERORATE_E_STATE => c"the object has not been set up, or the call came too early",
        ZERORATE_E_ARGUMENT => c"an argument is out of range",
        ZERORATE_E_BUS => c"the SPI transfer failed; reset and initialise the part",
        ZERORATE_E_PIN => c"the RDY line cannot be read, or rdy or delay_us of the bus is null",
        ZERORATE_E_TIMEOUT => c"RDY gave no sign of new data in time; check its wire and edge, and the supply",
        ZERORATE_E_MISSING => c"the self-test needs rdy, delay_us and its pin",
        ZERORATE_E_SELF_TEST_PIN => c"the self-test pin cannot be set; if it is still high, it offsets the rate",
        ZERORATE_E_INTERRUPTED => c"a command before was cut short; initialise the part",
        ZERORATE_E_STUCK_HIGH => c"SDO is stuck at ones; check its wire, CS, the supply and SPI mode 3",
        ZERORATE_E_STUCK_LOW => c"SDO is stuck at zeros; check its wire, CS, the supply and SPI mode 3",
        ZERORATE_E_CONFIGURATION_LOST => c"the part has lost its configuration; check the supply, initialise it",
        ZERORATE_E_UNEXPECTED => {
            c"a register reads back wrong; initialise the part, or check SPI mode 3, clock and cable"
        }
        ZERORATE_E_OUT_OF_RANGE => c"the input is out of range",
        ZERORATE_E_NO_READING => c"no reading yet; initialise the part and wait for RDY, or check the edge of RDY",
        ZERORATE_E_COEFFICIENT => c"a coefficient is not finite, or does not fit the integer correction",
        ZERORATE_E_TABLE_LAYOUT => c"step and span lay out no table",
        ZERORATE_E_TABLE_ROOM => c"the table does not fit into the memory given",
        ZERORATE_E_TABLE_STEEP => c"a row of the table does not fit 32 bits",
        ZERORATE_E_TABLE_OUTSIDE => c"the temperature lies beyond the table",
        ZERORATE_E_PLAN => c"a duration or limit of the plan makes no sense",
        ZERORATE_E_MOVING => c"refused: the part moves",
        ZERORATE_E_TURNING => c"refused: the part turns",
        ZERORATE_E_NOISY => c"refused: the part shakes or its supply is noisy",
        ZERORATE_E_SPAN => c"refused: the temperature hardly changed",
        ZERORATE_E_CURVATURE => c"refused: BTC too uncertain by curvature",
        ZERORATE_E_LOST => c"refused: too many samples were lost",
        ZERORATE_E_OVERRANGED => c"refused: readings out of range",
        ZERORATE_E_FROZEN => c"refused: the readings stopped changing",
        ZERORATE_E_TOO_FEW => c"refused: too few samples",
        ZERORATE_E_NO_TEMPERATURE => c"refused: no temperature was read",
        ZERORATE_E_UNSTEADY => c"refused: the rate wanders or steps during the offset average",
        ZERORATE_E_REFUSED => c"refused",
        _ => c"unknown status",
    };
    text.as_ptr()
}

pub fn of(done: Result<(), Status>) -> Status {
    done.err().unwrap_or(ZERORATE_OK)
}

pub trait StatusNumber {
    fn status(&self) -> Status;
}

impl<E> StatusNumber for BusError<E> {
    fn status(&self) -> Status {
        match self {
            Self::Transfer { .. } => ZERORATE_E_BUS,
            Self::Interrupted { .. } => ZERORATE_E_INTERRUPTED,
        }
    }
}

impl StatusNumber for Fault {
    fn status(&self) -> Status {
        match self {
            Self::StuckHigh(_) => ZERORATE_E_STUCK_HIGH,
            Self::StuckLow(_) => ZERORATE_E_STUCK_LOW,
            Self::ConfigurationLost(_) => ZERORATE_E_CONFIGURATION_LOST,
            Self::Unexpected(_) => ZERORATE_E_UNEXPECTED,
        }
    }
}

impl<E> StatusNumber for ReadError<E> {
    fn status(&self) -> Status {
        match self {
            Self::Bus(error) => error.status(),
            Self::Fault(fault) => fault.status(),
            Self::OutOfRange(_) => ZERORATE_E_OUT_OF_RANGE,
            Self::NoReading(_) => ZERORATE_E_NO_READING,
        }
    }
}

impl<E> StatusNumber for InitError<E> {
    fn status(&self) -> Status {
        match self {
            Self::Bus(error) => error.status(),
            Self::Verify(error) => error.status(),
        }
    }
}

impl<E> StatusNumber for VerifyError<E> {
    fn status(&self) -> Status {
        match self {
            Self::Bus(error) => error.status(),
            Self::NotInitialised => ZERORATE_E_STATE,
            Self::StuckHigh(_) => ZERORATE_E_STUCK_HIGH,
            Self::StuckLow(_) => ZERORATE_E_STUCK_LOW,
            Self::ConfigurationLost(_) => ZERORATE_E_CONFIGURATION_LOST,
            Self::Differs(_) => ZERORATE_E_UNEXPECTED,
        }
    }
}

impl<E, R> StatusNumber for WaitError<E, R> {
    fn status(&self) -> Status {
        match self {
            Self::Pin(_) => ZERORATE_E_PIN,
            Self::Status(error) => error.status(),
            Self::TimedOut { .. } => ZERORATE_E_TIMEOUT,
        }
    }
}

impl<E, R, P> StatusNumber for SelfTestError<E, R, P> {
    fn status(&self) -> Status {
        match self {
            Self::Read(error) => error.status(),
            Self::Wait(error) => error.status(),
            Self::Pin(_) => ZERORATE_E_SELF_TEST_PIN,
        }
    }
}

impl StatusNumber for TableError {
    fn status(&self) -> Status {
        match self {
            Self::NotPositive { .. } | Self::Ragged { .. } | Self::TooLong { .. } => ZERORATE_E_TABLE_LAYOUT,
            Self::NoRoom { .. } => ZERORATE_E_TABLE_ROOM,
            Self::TooSteep { .. } => ZERORATE_E_TABLE_STEEP,
        }
    }
}

impl StatusNumber for Refusal {
    fn status(&self) -> Status {
        match self {
            Self::Moving { .. } => ZERORATE_E_MOVING,
            Self::Turning { .. } => ZERORATE_E_TURNING,
            Self::Noisy { .. } => ZERORATE_E_NOISY,
            Self::Span { .. } => ZERORATE_E_SPAN,
            Self::Curvature { .. } => ZERORATE_E_CURVATURE,
            Self::Lost { .. } | Self::Stuttering { .. } => ZERORATE_E_LOST,
            Self::Overranged { .. } => ZERORATE_E_OVERRANGED,
            Self::Frozen { .. } => ZERORATE_E_FROZEN,
            Self::TooFew { .. } => ZERORATE_E_TOO_FEW,
            Self::NoTemperature { .. } => ZERORATE_E_NO_TEMPERATURE,
            Self::Unsteady { .. } => ZERORATE_E_UNSTEADY,
            _ => ZERORATE_E_REFUSED,
        }
    }
}
