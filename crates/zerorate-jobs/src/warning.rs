//! What a job has to say beside its result.

use serde::{Serialize, Serializer};
use std::fmt;
use zerorate::health::Flags;
use zerorate::{Names, Say, Warning};
use zerorate_record::Note;
use zerorate_view::Seconds;

/// A warning of a job: a code for scripts, and a text that may name settings.
#[derive(Clone, Debug)]
pub enum JobWarning {
    /// About the measurement.
    Measured(Warning),
    /// About one of several axes.
    OfAxis(String, Warning),
    /// About a file or a device; the text names it where there may be several.
    Source(Note),
    /// About readings that are not believed.
    Readings(Note),
    /// So many samples were read, but lost in the queue.
    Overflowed(u64),
    /// So many frames of a bridge were damaged.
    Damaged(u64),
    /// The log failed, and the measurement went on.
    LogFailed {
        /// When.
        after_s: f64,
        /// What failed.
        why: String,
    },
    /// So many rows of a capture come before its first temperature.
    BeforeTemperature(u64),
    /// Readings with these flags are left out of a stream.
    LeftOut(Flags),
    /// Nothing tells how old the state of a tracked bias is.
    StateAgeUnknown,
    /// The state of a tracked bias cannot be written.
    StateNotKept {
        /// What failed.
        why: String,
        /// It is tried again every so many s.
        again_s: u64,
    },
    /// The finished steps of a chamber's plan cannot be kept, since this failed.
    StepsNotKept(String),
    /// The part does not state the temperatures that it bears.
    LimitsUnknown,
    /// A measurement in a chamber was interrupted.
    Resumed,
    /// An axis was quiet at a level that a slow turn explains better.
    SlowTurn {
        /// The axis.
        axis: String,
        /// For so long.
        doubtful_s: u32,
    },
}

impl JobWarning {
    /// The name that scripts and `zerorate explain` know.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Measured(warning) | Self::OfAxis(_, warning) => warning.code(),
            Self::Source(note) | Self::Readings(note) => note.code,
            Self::Overflowed(_) => "queue-overflow",
            Self::Damaged(_) => "damaged-frames",
            Self::LogFailed { .. } => "log-failed",
            Self::BeforeTemperature(_) => "before-temperature",
            Self::LeftOut(_) => "not-believed",
            Self::StateAgeUnknown => "state-age-unknown",
            Self::StateNotKept { .. } | Self::StepsNotKept(_) => "not-kept",
            Self::LimitsUnknown => "limits-unknown",
            Self::Resumed => "resumed",
            Self::SlowTurn { .. } => "slow-turn",
        }
    }

    /// As scripts read it, `code: text`, with these names for settings.
    #[must_use]
    pub fn coded(self, names: Names) -> CodedWarning {
        CodedWarning { axis: None, warning: self, names }
    }
}

impl Say for JobWarning {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        match self {
            Self::Measured(warning) => warning.say(f, names),
            Self::OfAxis(name, warning) => write!(f, "axis {name}: {}", warning.with(names)),
            Self::Source(note) | Self::Readings(note) => f.write_str(&note.text),
            Self::Overflowed(samples) => write!(
                f,
                "{samples} samples were read but lost, since the disk or the processor was too slow for them; they \
                 are counted as lost"
            ),
            Self::Damaged(frames) => write!(
                f,
                "{frames} frames of the bridge were damaged on the way, and their samples are counted as lost; check \
                 its cable, or lower the baud rate"
            ),
            Self::LogFailed { after_s, why } => {
                write!(f, "the log failed after {}, the measurement goes on: {why}", Seconds(*after_s))
            }
            Self::BeforeTemperature(rows) => {
                write!(f, "the first {rows} rows come before the first temperature and stay uncorrected (empty)")
            }
            Self::LeftOut(flags) => {
                write!(f, "readings that are not to be believed ({flags}) are left out; their rows are flagged")
            }
            Self::StateAgeUnknown => f.write_str("nothing tells how old the state is; it is taken as of now"),
            Self::StateNotKept { why, again_s } => write!(
                f,
                "what was learned cannot be written: {why}; the rows go on, and it is tried again every {again_s} s"
            ),
            Self::StepsNotKept(why) => write!(f, "the finished steps cannot be kept: {why}"),
            Self::LimitsUnknown => f.write_str(
                "the file of the part does not state operating_c, so only the plan keeps the chamber from harming it",
            ),
            Self::Resumed => f.write_str(
                "the measurement was interrupted; a part that was switched off in between may have another bias \
                 since, which shows as noise and is no part of the uncertainty. No one recording gives this result \
                 again",
            ),
            Self::SlowTurn { axis, doubtful_s } => write!(
                f,
                "{axis} was quiet for {doubtful_s} s at a level that a slow turn explains better than a change of the \
                 bias: next to nothing was learned from it; if the part was at rest, calibrate it anew"
            ),
        }
    }
}

impl From<Warning> for JobWarning {
    fn from(warning: Warning) -> Self {
        Self::Measured(warning)
    }
}

/// A warning with the names of settings: `code: text` where it is shown.
#[derive(Clone, Debug)]
pub struct CodedWarning {
    axis: Option<String>,
    warning: JobWarning,
    names: Names,
}

impl CodedWarning {
    /// With the name of an axis before it.
    #[must_use]
    pub fn of_axis(self, name: &str) -> Self {
        Self { axis: Some(name.to_owned()), ..self }
    }
}

impl fmt::Display for CodedWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(axis) = &self.axis {
            write!(f, "axis {axis}: ")?;
        }
        write!(f, "{}: {}", self.warning.code(), self.warning.with(self.names))
    }
}

impl Serialize for CodedWarning {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

#[cfg(test)]
mod tests {
    use zerorate_view::codes;

    #[test]
    fn every_warning_is_explained() {
        let text = include_str!("warning.rs");
        let table = text.split_once("pub fn code").and_then(|(_, rest)| rest.split_once("pub fn coded")).unwrap().0;
        let codes: Vec<&str> = table.split('"').skip(1).step_by(2).collect();
        assert!(codes.len() > 3, "{codes:?}");
        for code in codes {
            assert!(codes::all().any(|one| one.code == code), "no {code:?} in the table");
        }
    }
}
