//! Warnings of a device, beside its samples.

use std::fmt;
use zerorate_allan::{Says, rows};
use zerorate_logs::LogWarning;
use zerorate_record::CaptureWarning;

/// A warning of a device. Its samples stand.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum SourceWarning {
    /// About a recording that is read as a device.
    Log(LogWarning),
    /// The reading thread has no real-time priority.
    NoRealtimePriority,
    /// The memory of the reading thread is not locked.
    MemoryNotLocked,
    /// A simulated part is in air where no such part operates.
    BeyondLimits { ambient_c: f64, part: String, low_c: f64, high_c: f64 },
}

rows!(match SourceWarning {
    Self::Log(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::NoRealtimePriority => Row {
        code: "no-realtime-priority",
        text: format_args!("other programs can cost samples; allow zerorate real-time priority"),
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The reading thread could not get real-time priority.",
        matters: "Other programs can delay the reading and cost samples.",
        remedy: "Allow the program both real-time priority and locked memory, once, with the command below. In a \
            systemd unit write AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK.",
        command: "sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"",
    },
    Self::MemoryNotLocked => Row {
        code: "memory-not-locked",
        text: format_args!("swapped-out memory can cost samples; allow zerorate to lock its memory"),
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The memory of the reading thread could not be locked.",
        matters: "The thread may have to wait for memory that was swapped out, and lose samples.",
        remedy: "Allow the program both real-time priority and locked memory, once, with the command below. In a \
            systemd unit write AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK.",
        command: "sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"",
    },
    Self::BeyondLimits { ambient_c, ref part, low_c, high_c } => Row {
        code: "beyond-limits",
        text: format_args!(
            "the simulated part is in air of {ambient_c} °C, beyond {low_c} to {high_c} °C of the {part}"
        ),
    },
});

impl SourceWarning {
    /// The warning as scripts read it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}

impl fmt::Display for SourceWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

impl From<LogWarning> for SourceWarning {
    fn from(warning: LogWarning) -> Self {
        Self::Log(warning)
    }
}

impl From<CaptureWarning> for SourceWarning {
    fn from(warning: CaptureWarning) -> Self {
        Self::Log(warning.into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_is_one_short_line() {
        let part = "ADIS16130".to_owned();
        let beyond = SourceWarning::BeyondLimits { ambient_c: 150.0, part, low_c: -40.0, high_c: 85.0 };
        for warning in [SourceWarning::NoRealtimePriority, SourceWarning::MemoryNotLocked, beyond] {
            let line = warning.coded();
            assert!(line.chars().count() <= 100, "{line}");
        }
    }
}
