//! Warnings of a device, beside its samples.

use zerorate_allan::rows;
use zerorate_logs::LogWarning;
use zerorate_record::CaptureWarning;

/// A warning about a device. The samples are valid nevertheless.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum SourceWarning {
    /// A warning about a recording that is read as a device.
    Log(LogWarning),
    /// The reading thread has no real-time priority.
    NoRealtimePriority,
    /// The memory of the reading thread is not locked.
    MemoryNotLocked,
    /// The ambient temperature of a simulated part is outside of the part's operating range.
    BeyondLimits { ambient_c: f64, part: String, low_c: f64, high_c: f64 },
}

rows!(match SourceWarning as Display {
    Self::Log(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::NoRealtimePriority => Row {
        code: "no-realtime-priority",
        text: format_args!("other programs can cost samples; allow zerorate real-time priority"),
    },
    Self::MemoryNotLocked => Row {
        code: "memory-not-locked",
        text: format_args!("swapped-out memory can cost samples; allow zerorate to lock its memory"),
    },
    Self::BeyondLimits { ambient_c, ref part, low_c, high_c } => Row {
        code: "beyond-limits",
        text: format_args!(
            "the simulated part is in air of {ambient_c} °C, beyond {low_c} to {high_c} °C of the {part}"
        ),
    },
});

impl SourceWarning {
    /// The warning as scripts receive it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}

impl From<CaptureWarning> for SourceWarning {
    fn from(warning: CaptureWarning) -> Self {
        Self::Log(of_capture(&warning))
    }
}

pub fn of_capture(warning: &CaptureWarning) -> LogWarning {
    LogWarning::OfTable { code: warning.code(), text: warning.to_string() }
}
