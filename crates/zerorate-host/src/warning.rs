//! What a device has to say beside its samples.

use std::fmt;
use zerorate_allan::{Says, rows};
use zerorate_logs::LogWarning;
use zerorate_record::CaptureWarning;

/// The samples stand, but there is something to know.
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
        text: format_args!("other programs can delay the reading and cost samples; {NOT_REALTIME}"),
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The reading thread could not get real-time priority.",
        matters: "Other programs can delay it, and cost samples.",
        remedy: "Allow both to the program, once.",
        command: "sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"",
    },
    Self::MemoryNotLocked => Row {
        code: "memory-not-locked",
        text: format_args!("the reading thread may have to wait for memory that was swapped out; {NOT_REALTIME}"),
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The memory of the reading thread could not be locked.",
        matters: "It may have to wait for memory that was swapped out, and lose samples.",
        remedy: "Allow both to the program, once.",
        command: "sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"",
    },
    Self::BeyondLimits { ambient_c, ref part, low_c, high_c } => Row {
        code: "beyond-limits",
        text: format_args!(
            "the simulated part is in air of {ambient_c} °C, and the {part} may be at {low_c} to {high_c} °C only: \
             nobody knows what a real one would do there"
        ),
    },
});

impl SourceWarning {
    /// As scripts read it: `code: text`.
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

/// How to allow both.
const NOT_REALTIME: &str = "allow it with `sudo setcap cap_sys_nice,cap_ipc_lock+ep \"$(command -v zerorate)\"`, or \
    in a systemd unit AmbientCapabilities=CAP_SYS_NICE CAP_IPC_LOCK";
