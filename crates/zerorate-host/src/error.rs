//! The errors of devices: a cause for programs, and a text for people.

use adis16130::Fault;
use std::error::Error;
use std::{fmt, io};
use zerorate_input::InputError;
use zerorate_logs::LogError;
use zerorate_record::CaptureError;
use zerorate_record::admission::InvalidDeviceData;

/// The error of a device that cannot be read. Its texts say what was observed and what to do.
#[derive(Debug)]
pub struct DeviceError {
    cause: Cause,
    told: anyhow::Error,
}

/// The kind of a failure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Cause {
    /// The device or this build of the program does not support the request.
    Request,
    /// The device is not there.
    Missing,
    /// Permission to open the device is missing.
    Permission,
    /// Another program has the device open.
    Busy,
    /// The device has disappeared: for example, a cable was pulled or a driver was unbound.
    Gone,
    /// The device does not answer.
    Silent,
    /// The part itself shows a fault.
    Part,
    /// The recording cannot be read, or is damaged.
    File,
    /// The samples must not be used for a measurement. The value is the code of the reason (docs/codes.md).
    Refused(&'static str),
    /// A stop was requested.
    Stopped,
    /// Any other cause.
    Other,
}

impl DeviceError {
    /// The kind of the failure.
    #[must_use]
    pub fn cause(&self) -> Cause {
        self.cause
    }

    /// A copy of the error, because each reader of the device receives the error.
    pub(crate) fn again(&self) -> Self {
        Self { cause: self.cause, told: anyhow::anyhow!("{:#}", self.told) }
    }
}

impl fmt::Display for DeviceError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.told.fmt(f)
    }
}

impl Error for DeviceError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        self.told.chain().nth(1)
    }
}

impl From<anyhow::Error> for DeviceError {
    fn from(told: anyhow::Error) -> Self {
        Self { cause: cause(&told), told }
    }
}

macro_rules! with_cause {
    ($($error:ty),*) => {$(
        impl From<$error> for DeviceError {
            fn from(error: $error) -> Self {
                anyhow::Error::new(error).into()
            }
        }
    )*};
}

with_cause!(InvalidDeviceData, InputError, CaptureError, UserError);

impl From<LogError> for DeviceError {
    fn from(error: LogError) -> Self {
        let cause = match error {
            LogError::File(InputError::NotBuiltIn { .. }) => Cause::Request,
            LogError::File(_) => Cause::File,
            LogError::Ask(_) | LogError::Choose { .. } | LogError::Merged { .. } => Cause::Request,
            LogError::Refused(code, _) => Cause::Refused(code),
        };
        Self { cause, told: error.into() }
    }
}

#[derive(Debug, thiserror::Error)]
#[error("{words}")]
pub(crate) struct UserError {
    cause: Cause,
    words: String,
}

impl UserError {
    pub fn new(cause: Cause, words: impl Into<String>) -> Self {
        Self { cause, words: words.into() }
    }

    pub fn request(words: impl Into<String>) -> anyhow::Error {
        Self::new(Cause::Request, words).into()
    }

    pub fn of_system(error: io::Error, words: impl Into<String>) -> anyhow::Error {
        let told = Self::new(of_system(&error), words);
        anyhow::Error::new(error).context(told)
    }
}

/// The message about a file that only root and this group may open.
pub(crate) fn no_permission(file: impl fmt::Display, group: &str) -> String {
    format!(
        "no permission to open {file}: sudo usermod -aG {group} \"$USER\", then log in again (ls -l {file} shows the \
         group)"
    )
}

fn cause(error: &anyhow::Error) -> Cause {
    if let Some(told) = error.downcast_ref::<UserError>() {
        return told.cause;
    }
    let of_part = error.downcast_ref::<Fault>().map(|_| Cause::Part);
    let of_input = |error: &InputError| match error {
        InputError::NotBuiltIn { .. } => Cause::Request,
        _ => Cause::File,
    };
    let of_capture = error.downcast_ref().map(|error| match error {
        CaptureError::Input(error) => of_input(error),
        _ => Cause::File,
    });
    let of_file = error.downcast_ref().map(of_input).or(of_capture);
    let of_system = error.chain().find_map(|source| source.downcast_ref()).map(of_system);
    of_part.or(of_file).or(of_system).unwrap_or(Cause::Other)
}

fn of_system(error: &io::Error) -> Cause {
    match error.kind() {
        io::ErrorKind::NotFound => Cause::Missing,
        io::ErrorKind::PermissionDenied => Cause::Permission,
        io::ErrorKind::ResourceBusy => Cause::Busy,
        io::ErrorKind::UnexpectedEof | io::ErrorKind::BrokenPipe | io::ErrorKind::ConnectionReset => Cause::Gone,
        io::ErrorKind::TimedOut => Cause::Silent,
        _ => Cause::Other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use anyhow::Context;

    #[test]
    fn an_error_has_its_cause_and_keeps_its_text() {
        let gone = Err::<(), _>(io::Error::from(io::ErrorKind::NotFound))
            .context("reading register 8")
            .context(UserError::new(Cause::Gone, "the adapter was unplugged"))
            .context("12.0 s after the first edge")
            .unwrap_err();
        let words = format!("{gone:#}");
        let error = DeviceError::from(gone);
        assert_eq!(error.cause(), Cause::Gone);
        assert_eq!(format!("{:#}", anyhow::Error::from(error)), words);
        let missing = anyhow::Error::from(io::Error::from(io::ErrorKind::NotFound)).context("opening it");
        assert_eq!(DeviceError::from(missing).cause(), Cause::Missing);
    }
}
