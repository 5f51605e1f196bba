//! Warnings of a job, beside its result.

use serde::{Serialize, Serializer};
use std::fmt;
use zerorate::calibration::FileWarning;
use zerorate::health::Flags;
use zerorate::{Names, Say, Warning};
use zerorate_allan::{Says, rows};
use zerorate_host::SourceWarning;
use zerorate_record::CaptureWarning;
use zerorate_view::Seconds;

/// A warning of a job: a code for scripts, and a text that may name settings.
#[derive(Clone, Debug)]
pub enum JobWarning {
    /// A warning about the measurement.
    Measured(Warning),
    /// A warning about one of several axes.
    OfAxis(String, Warning),
    /// A warning about the file of a calibration.
    OfCalibration(String, FileWarning),
    /// A warning about a file or a device. The text names it where there may be several.
    Source(SourceWarning),
    /// A warning about readings that are not trusted.
    Readings(CaptureWarning),
    /// Number of samples that were read, but lost in the queue.
    Overflowed(u64),
    /// Number of damaged frames of a bridge.
    Damaged(u64),
    /// Nothing shows that a calibration belongs to the part.
    UnknownSerial {
        /// The file of the calibration.
        cal: String,
        /// The part of the calibration.
        calibrated: String,
        /// The device or the capture.
        name: String,
        /// How to make its serial number known.
        advice: &'static str,
    },
    /// A calibration does not state its part.
    NoSerial {
        /// The file of the calibration.
        cal: String,
    },
    /// The log failed, and the measurement went on.
    LogFailed {
        /// Time since the start, s.
        after_s: f64,
        /// The error.
        why: String,
    },
    /// Number of rows of a capture before its first temperature.
    BeforeTemperature(u64),
    /// Readings with these flags are left out of a stream.
    LeftOut(Flags),
    /// The age of the state of a tracked bias is unknown.
    StateAgeUnknown,
    /// The state of a tracked bias cannot be written.
    StateNotKept {
        /// The error.
        why: String,
        /// Time between attempts, s.
        again_s: u64,
    },
    /// The finished steps of a chamber's plan cannot be kept. The text is the error.
    StepsNotKept(String),
    /// The part does not state at which temperatures it may operate.
    LimitsUnknown,
    /// How a chamber was left, which may go on heating or cooling.
    ChamberLeft(String),
    /// A measurement in a chamber was interrupted.
    Resumed,
    /// The bias differs between the way up and the way down. The text says by how much.
    WideLoop(String),
    /// An axis was quiet at a level that a slow turn explains better.
    SlowTurn {
        /// The axis.
        axis: String,
        /// Duration, s.
        doubtful_s: u32,
    },
}

impl JobWarning {
    /// The warning as scripts read it, `code: text`, with these names for settings.
    #[must_use]
    pub fn coded(self, names: Names) -> CodedWarning {
        CodedWarning { axis: None, warning: self, names }
    }
}

rows!(match JobWarning {
    Self::Measured(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::OfAxis(ref name, ref warning) =>
        Row { code: { warning.code() }, text: format_args!("axis {name}: {warning}") },
    Self::OfCalibration(ref path, ref warning) =>
        Row { code: { warning.code() }, text: format_args!("{path}: {warning}") },
    Self::Source(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::Readings(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::Overflowed(samples) => Row {
        code: "queue-overflow",
        text: format_args!("{samples} samples were lost, as disk or processor is too slow; use a divider"),
        says: Says::Warning,
        by: &["probe", "capture"],
        seen: "Samples were read, but the disk or the processor was too slow to keep them.",
        matters: "These samples are counted as lost.",
        remedy: "Record to a faster disk, use a divider, or stop other programs on the computer.",
        command: "zerorate capture --divider 2 -o rest.arrows",
    },
    Self::Damaged(frames) => Row {
        code: "damaged-frames",
        text: format_args!("{frames} frames from the bridge were damaged; check its cable, or lower the baud rate"),
        says: Says::Warning,
        by: &["probe", "capture", "serve"],
        seen: "Frames of the bridge came damaged over its cable.",
        matters: "Their checksum shows it, so nothing wrong came in; their samples are counted as lost.",
        remedy: "Check the cable of the bridge, or lower its baud rate.",
        command: "zerorate probe --device 'bridge:/dev/ttyACM0?baud=115200'",
    },
    Self::UnknownSerial { ref cal, ref calibrated, ref name, advice } => Row {
        code: "unknown-serial",
        text: format_args!("{cal} is for part {calibrated}; {name} may be another: {advice}"),
        says: Says::Warning,
        by: &["stream", "correct", "serve"],
        seen: "Nothing shows that the calibration belongs to this very part: the calibration, the recording or the \
            device does not state a serial number.",
        matters: "Every part has its own bias. The calibration of another part makes the rate worse.",
        remedy: "Give the serial number when you calibrate, record and correct.",
        command: "zerorate calibrate --serial SN17 -o unit.toml",
    },
    Self::NoSerial { ref cal } => Row {
        code: "unknown-serial",
        text: format_args!("{cal} states no serial number; give one to `zerorate calibrate` next time"),
    },
    Self::LogFailed { after_s, ref why } => Row {
        code: "log-failed",
        text: format_args!("the log failed after {}, the measurement goes on: {why}", Seconds(after_s)),
        says: Says::Warning,
        by: &["calibrate", "chamber"],
        seen: "The file of `--log` could not be written any longer: the disk is full, or was taken away.",
        matters: "The measurement goes on and its result stands. The exit code is 1, because the recording is not \
            whole.",
        remedy: "Make room on the disk. The recording is whole up to its last block.",
        command: "zerorate verify unit.arrows",
    },
    Self::BeforeTemperature(rows) => Row {
        code: "before-temperature",
        text: format_args!("the first {rows} rows come before the first temperature and stay empty"),
        says: Says::Warning,
        by: &["correct"],
        seen: "The first rows of a capture come before its first temperature.",
        matters: "A correction needs a temperature: these rows stay uncorrected, and their cells are empty.",
        remedy: "Do nothing if they are few. Otherwise read the temperature more often, so that the first comes \
            sooner.",
        command: "zerorate capture --every-temp 1 -o rest.arrows",
    },
    Self::LeftOut(ref flags) => Row {
        code: "not-believed",
        text: format_args!("bad readings ({flags}) are left out, their rows are flagged; check cable and supply"),
        says: Says::Warning,
        by: &["stream"],
        seen: "Readings came that cannot be trusted: bit errors, out of range, or from a part that stopped.",
        matters: "These readings are left out of the means, and their rows are flagged.",
        remedy: "Check the cable and the supply; `zerorate probe` says more.",
        command: "zerorate probe",
    },
    Self::StateAgeUnknown => Row {
        code: "state-age-unknown",
        text: format_args!("the age of the state is unknown; it is taken as of now"),
        says: Says::Warning,
        by: &["stream"],
        seen: "The age of the tracking state is unknown, as for a state that was made on simulated time.",
        matters: "The state is taken as of now. A bias that walked on in the meantime is trusted too much at first.",
        remedy: "Do nothing; the next rest mends it.",
    },
    Self::StateNotKept { ref why, again_s } => Row {
        code: "not-kept",
        text: format_args!("the state cannot be written: {why}; the next attempt is in {again_s} s"),
        says: Says::Warning,
        by: &["serve", "stream", "chamber"],
        seen: "What a run keeps for later has no place: calibrations that are made on the page, the state of the \
               tracking, or the finished steps of a measurement in a chamber. The disk may be full.",
        matters: "The run goes on, and its results are right. Results that cannot be kept are lost when the program \
                  ends.",
        remedy: "Make room: the state and the steps are written again a minute or a step later. Download calibrations \
                 from the page, or give the program a folder.",
        command: "zerorate serve --folder calibrations",
    },
    Self::StepsNotKept(ref why) =>
        Row { code: "not-kept", text: format_args!("the finished steps cannot be kept: {why}") },
    Self::LimitsUnknown => Row {
        code: "limits-unknown",
        text: format_args!("the file of the part lacks operating_c; only the plan protects the part"),
        says: Says::Warning,
        by: &["chamber"],
        seen: "The file of the part does not state at which temperatures the part may operate.",
        matters: "Only the plan keeps the chamber from harming the part.",
        remedy: "State operating_c in the file of the part.",
    },
    Self::ChamberLeft(ref how) => Row {
        code: "chamber-left",
        text: format_args!("{how}"),
        says: Says::Warning,
        by: &["chamber"],
        seen: "The chamber did not confirm that it was sent to a safe temperature or stopped.",
        matters: "It may go on heating or cooling.",
        remedy: "Go to the chamber, and switch it off by hand. Then look at its cable.",
    },
    Self::Resumed => Row {
        code: "resumed",
        text: format_args!("the measurement was interrupted; the bias may have changed if power was off"),
        says: Says::Warning,
        by: &["chamber"],
        seen: "The measurement was interrupted, and went on from its finished steps.",
        matters: "A part that was switched off in between may have another bias since. The change shows as noise \
            and is not in the uncertainty. No single recording gives this result again.",
        remedy: "Measure again without an interruption if it matters.",
    },
    Self::WideLoop(ref text) => Row { code: "hysteresis", text: format_args!("{text}") },
    Self::SlowTurn { ref axis, doubtful_s } => Row {
        code: "slow-turn",
        text: format_args!(
            "{axis} was quiet for {doubtful_s} s, but probably turning slowly; if at rest, calibrate anew"
        ),
        says: Says::Warning,
        by: &["stream"],
        seen: "The part was quiet at a level that a slow turn explains better than a change of the bias.",
        matters: "The tracking learned next to nothing from that time, so that a turn does not become bias.",
        remedy: "If the part was at rest, calibrate it anew.",
        command: "zerorate calibrate -o unit.toml",
    },
});

impl Say for JobWarning {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        match self {
            Self::Measured(warning) => warning.say(f, names),
            Self::OfAxis(name, warning) => write!(f, "axis {name}: {}", warning.with(names)),
            other => other.text(f),
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
    /// Puts the name of an axis before the warning.
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
    use super::*;

    /// What carries the error of another layer may be longer: `LogFailed`, `StateNotKept`, `StepsNotKept`. What
    /// other crates say is measured there, and `ChamberLeft` and `WideLoop` where their texts are made.
    #[test]
    fn a_warning_is_one_short_line() {
        let cal = || "unit.toml".to_owned();
        let [calibrated, name] = ["SN17", "bridge:/dev/ttyACM0"].map(str::to_owned);
        let all = [
            JobWarning::Overflowed(120_000),
            JobWarning::Damaged(1200),
            JobWarning::UnknownSerial { cal: cal(), calibrated, name, advice: "give --serial SN" },
            JobWarning::NoSerial { cal: cal() },
            JobWarning::BeforeTemperature(1200),
            JobWarning::LeftOut(Flags::IMPOSSIBLE),
            JobWarning::StateAgeUnknown,
            JobWarning::LimitsUnknown,
            JobWarning::Resumed,
            JobWarning::SlowTurn { axis: "z".to_owned(), doubtful_s: 1200 },
        ];
        for line in all.map(|warning| warning.coded(|_| "").to_string()) {
            assert!(line.chars().count() <= 100, "{line}");
        }
    }
}
