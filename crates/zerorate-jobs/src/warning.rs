//! The warnings of a job, while it runs and with its result.

use serde::{Serialize, Serializer};
use std::fmt;
use zerorate::health::Flags;
use zerorate::{SettingNames, Warning, Wording};
use zerorate_allan::rows;
use zerorate_host::SourceWarning;
use zerorate_record::CaptureWarning;
use zerorate_view::{Seconds, SessionWarning};

/// A warning of a job. It has a code for scripts, and its text may mention settings.
#[derive(Clone, Debug)]
pub enum JobWarning {
    /// A warning about the measurement.
    Measured(Warning),
    /// A warning about one of several axes, with the name of the axis.
    OfAxis(String, Warning),
    /// A warning about the device, or about a calibration that is applied to it.
    Session(SessionWarning),
    /// A warning about a file or a device.
    Source(SourceWarning),
    /// A warning about readings that are not trusted.
    Readings(CaptureWarning),
    /// The number of samples that were read, but then lost because the queue was full.
    Overflowed(u64),
    /// The log could not be written, and the measurement went on without it.
    LogFailed {
        /// Time from the start of the measurement to the failure, s.
        after_s: f64,
        /// The text of the error.
        why: String,
    },
    /// The number of rows of a capture before its first temperature.
    BeforeTemperature(u64),
    /// The number of rows of a log that have no temperature in the minute before them.
    TemperatureMissing(u64),
    /// The total time for which the thermometer of a log stood still, s.
    TemperatureHeld(f64),
    /// The bias lags behind the temperature. After the start of a log or a gap, the correction may therefore be wrong.
    LagAtStart {
        /// The time for which the correction may be wrong, s.
        for_s: f64,
        /// The largest error of the correction, °/s.
        most_dps: f64,
    },
    /// Readings with these fault flags were left out of a stream.
    LeftOut(Flags),
    /// The time since a tracked bias was saved is unknown.
    StateAgeUnknown,
    /// The state of a tracked bias cannot be saved.
    StateNotKept {
        /// The text of the error.
        why: String,
        /// Time between attempts, s.
        again_s: u64,
    },
    /// The finished steps of a chamber's plan cannot be saved. The string is the text of the error.
    StepsNotKept(String),
    /// The part file does not state the part's operating temperatures.
    LimitsUnknown,
    /// The chamber may still be heating or cooling. The string describes how the chamber was left.
    ChamberLeft(String),
    /// The measurement in a chamber was interrupted and then continued.
    Resumed,
    /// An axis was quiet, but its level is better explained by a slow rotation than by a bias.
    SlowTurn {
        /// The name of the axis.
        axis: String,
        /// Total time, over all power-ups, in which the axis was quiet at such a level, s.
        doubtful_s: u32,
    },
}

impl JobWarning {
    /// Adds the names that the front end uses for the settings.
    #[must_use]
    pub fn coded(self, names: SettingNames) -> CodedWarning {
        CodedWarning { axis: None, warning: self, names }
    }

    /// Separates standing remarks, which every measurement by the same plan has, from warnings about this
    /// measurement. Returns the remarks first.
    pub(crate) fn remarks_apart(
        warnings: impl IntoIterator<Item = Warning>,
        names: SettingNames,
    ) -> (Vec<CodedWarning>, Vec<CodedWarning>) {
        let (remarks, warnings): (Vec<_>, Vec<_>) = warnings.into_iter().partition(Warning::is_standing);
        let coded = |all: Vec<Warning>| all.into_iter().map(|one| Self::from(one).coded(names)).collect();
        (coded(remarks), coded(warnings))
    }
}

rows!(match JobWarning {
    Self::Measured(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::OfAxis(ref name, ref warning) =>
        Row { code: { warning.code() }, text: format_args!("axis {name}: {warning}") },
    Self::Session(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::Source(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::Readings(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::Overflowed(samples) => Row {
        code: "queue-overflow",
        text: format_args!("{samples} samples were lost, as disk or processor is too slow; use a divider"),
    },
    Self::LogFailed { after_s, ref why } => Row {
        code: "log-failed",
        text: format_args!("the log failed after {}, the measurement goes on: {why}", Seconds(after_s)),
    },
    Self::BeforeTemperature(rows) => Row {
        code: "before-temperature",
        text: format_args!("the first {rows} rows come before the first temperature and stay empty"),
    },
    Self::TemperatureMissing(rows) => Row {
        code: "temperature-missing",
        text: format_args!("{rows} rows have no temperature in the minute before them and stay empty"),
    },
    Self::TemperatureHeld(stuck_s) => Row {
        code: "temperature-held",
        text: format_args!("the thermometer stood still for {stuck_s:.0} s; the correction there is doubtful"),
    },
    Self::LagAtStart { for_s, most_dps } => Row {
        code: "lag-at-start",
        text: format_args!("up to {most_dps:.3} °/s off for {for_s:.0} s after a start or gap, if it was not warm"),
    },
    Self::LeftOut(ref flags) => Row {
        code: "not-believed",
        text: format_args!("bad readings ({flags}) are left out, their rows are flagged; check cable and supply"),
    },
    Self::StateAgeUnknown =>
        Row { code: "state-age-unknown", text: format_args!("the state has an unknown age; it is taken as of now") },
    Self::StateNotKept { ref why, again_s } => Row {
        code: "not-kept",
        text: format_args!("the state cannot be written: {why}; the next attempt is in {again_s} s"),
    },
    Self::StepsNotKept(ref why) =>
        Row { code: "not-kept", text: format_args!("the finished steps cannot be kept: {why}") },
    Self::LimitsUnknown => Row {
        code: "limits-unknown",
        text: format_args!("the file of the part lacks operating_c; only the plan protects the part"),
    },
    Self::ChamberLeft(ref how) => Row { code: "chamber-left", text: format_args!("{how}") },
    Self::Resumed => Row {
        code: "resumed",
        text: format_args!("the measurement was interrupted; the bias may have changed if power was off"),
    },
    Self::SlowTurn { ref axis, doubtful_s } => Row {
        code: "slow-turn",
        text: format_args!(
            "{axis} was quiet for {doubtful_s} s, but probably turning slowly; if at rest, calibrate anew"
        ),
    },
});

impl Wording for JobWarning {
    fn fmt_with(&self, f: &mut fmt::Formatter<'_>, names: SettingNames) -> fmt::Result {
        match self {
            Self::Measured(warning) => warning.fmt_with(f, names),
            Self::OfAxis(name, warning) => write!(f, "axis {name}: {}", warning.with(names)),
            other => other.text(f),
        }
    }
}

impl From<SessionWarning> for JobWarning {
    fn from(warning: SessionWarning) -> Self {
        Self::Session(warning)
    }
}

impl From<Warning> for JobWarning {
    fn from(warning: Warning) -> Self {
        Self::Measured(warning)
    }
}

/// A warning with the front end's names for settings. It is shown as `code: text`.
#[derive(Clone, Debug)]
pub struct CodedWarning {
    axis: Option<String>,
    warning: JobWarning,
    names: SettingNames,
}

impl CodedWarning {
    /// Prefixes the warning with the name of an axis.
    #[must_use]
    pub fn of_axis(self, name: &str) -> Self {
        Self { axis: Some(name.to_owned()), ..self }
    }

    /// The code by which scripts recognise the warning, such as `lost-samples`.
    #[must_use]
    pub fn code(&self) -> &'static str {
        self.warning.code()
    }

    /// The text without the code and the axis.
    #[must_use]
    pub fn text(&self) -> String {
        self.warning.with(self.names).to_string()
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
