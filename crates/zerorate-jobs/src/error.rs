//! Errors of the jobs themselves. Errors of lower layers pass through.

use zerorate_host::{Cause, DeviceError};
use zerorate_logs::LogError;

/// A measurement or a log was refused: its samples were read, but must not give a result.
#[derive(Debug, thiserror::Error)]
#[error("{why}")]
pub struct CodedRefusal {
    /// The code, for scripts and for `zerorate explain`.
    pub code: &'static str,
    why: String,
}

impl CodedRefusal {
    /// A refusal with its code and its text.
    pub fn new(code: &'static str, why: impl Into<String>) -> Self {
        Self { code, why: why.into() }
    }
}

/// The options contradict each other, or do not fit the device or the data.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct InvalidOptions(pub String);

/// The code of a refusal; `None` for any other error.
#[must_use]
pub fn refusal_code(error: &anyhow::Error) -> Option<&'static str> {
    let of_device = match error.downcast_ref().map(DeviceError::cause) {
        Some(Cause::Refused(code)) => Some(code),
        _ => None,
    };
    let of_log = match error.downcast_ref() {
        Some(LogError::Refused(code, _)) => Some(*code),
        _ => None,
    };
    error.downcast_ref().map(|refused: &CodedRefusal| refused.code).or(of_log).or(of_device)
}
