//! Errors of the jobs themselves. Errors of lower layers pass through.

/// The measurement was refused: there are results, but they must not become a calibration.
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
