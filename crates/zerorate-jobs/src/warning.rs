//! What a job has to say beside its result.

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
    /// About the measurement.
    Measured(Warning),
    /// About one of several axes.
    OfAxis(String, Warning),
    /// About the file of a calibration.
    OfCalibration(String, FileWarning),
    /// About a file or a device; the text names it where there may be several.
    Source(SourceWarning),
    /// About readings that are not believed.
    Readings(CaptureWarning),
    /// So many samples were read, but lost in the queue.
    Overflowed(u64),
    /// So many frames of a bridge were damaged.
    Damaged(u64),
    /// Nothing shows that a calibration is of the part.
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
    /// So a chamber was left, which may go on heating or cooling.
    ChamberLeft(String),
    /// A measurement in a chamber was interrupted.
    Resumed,
    /// The bias on the way up is not that on the way down, by as much as the text says.
    WideLoop(String),
    /// An axis was quiet at a level that a slow turn explains better.
    SlowTurn {
        /// The axis.
        axis: String,
        /// For so long.
        doubtful_s: u32,
    },
}

impl JobWarning {
    /// As scripts read it, `code: text`, with these names for settings.
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
        text: format_args!(
            "{samples} samples were read but lost, since the disk or the processor was too slow for them; they are \
             counted as lost"
        ),
        says: Says::Warning,
        by: &["probe", "capture"],
        seen: "Samples were read, but the disk or the processor was too slow to keep them.",
        matters: "They are counted as lost.",
        remedy: "Record to a faster disk, use a divider, or stop what else the computer does.",
        command: "zerorate capture --divider 2 -o rest.arrows",
    },
    Self::Damaged(frames) => Row {
        code: "damaged-frames",
        text: format_args!(
            "{frames} frames of the bridge were damaged on the way, and their samples are counted as lost; check its \
             cable, or lower the baud rate"
        ),
        says: Says::Warning,
        by: &["probe", "capture", "serve"],
        seen: "Frames of the bridge came damaged over its cable.",
        matters: "Their checksum shows it, so nothing wrong came in; their samples are counted as lost.",
        remedy: "Check the cable of the bridge, or lower its baud rate.",
        command: "zerorate probe --device 'bridge:/dev/ttyACM0?baud=115200'",
    },
    Self::UnknownSerial { ref cal, ref calibrated, ref name, advice } => Row {
        code: "unknown-serial",
        text: format_args!(
            "{cal} is the calibration of part {calibrated}, and nothing shows that {name} is that part: {advice}"
        ),
        says: Says::Warning,
        by: &["stream", "correct", "serve"],
        seen: "Nothing shows that the calibration is of this very part.",
        matters: "Every part has its own bias: the calibration of another makes the rate worse.",
        remedy: "Give the serial number when you calibrate, record and correct.",
        command: "zerorate calibrate --serial SN17 -o unit.toml",
    },
    Self::NoSerial { ref cal } => Row {
        code: "unknown-serial",
        text: format_args!(
            "{cal} says of no part that it is its calibration, and every part has its own bias: give `zerorate \
             calibrate` the serial number, --serial SN"
        ),
    },
    Self::LogFailed { after_s, ref why } => Row {
        code: "log-failed",
        text: format_args!("the log failed after {}, the measurement goes on: {why}", Seconds(after_s)),
        says: Says::Warning,
        by: &["calibrate", "chamber"],
        seen: "The file of `--log` could not be written any longer: the disk is full, or was taken away.",
        matters: "The measurement goes on and its result stands, but the exit code is 1: there is no whole \
            recording of it.",
        remedy: "Make room. What was written until then is whole up to its last block.",
        command: "zerorate verify unit.arrows",
    },
    Self::BeforeTemperature(rows) => Row {
        code: "before-temperature",
        text: format_args!("the first {rows} rows come before the first temperature and stay uncorrected (empty)"),
        says: Says::Warning,
        by: &["correct"],
        seen: "The first rows of a capture come before its first temperature.",
        matters: "A correction needs a temperature: these rows stay uncorrected, and their cells are empty.",
        remedy: "Nothing, if they are few. Read the temperature more often, so that the first comes sooner.",
        command: "zerorate capture --every-temp 1 -o rest.arrows",
    },
    Self::LeftOut(ref flags) => Row {
        code: "not-believed",
        text: format_args!("readings that are not to be believed ({flags}) are left out; their rows are flagged"),
        says: Says::Warning,
        by: &["stream"],
        seen: "Readings came that are not to be believed: bit errors, out of range, or a part that stopped.",
        matters: "They are left out of the means, and their rows are flagged.",
        remedy: "Check the cable and the supply; `zerorate probe` says more.",
        command: "zerorate probe",
    },
    Self::StateAgeUnknown => Row {
        code: "state-age-unknown",
        text: format_args!("nothing tells how old the state is; it is taken as of now"),
        says: Says::Warning,
        by: &["stream"],
        seen: "Nothing tells how old the state of the tracking is.",
        matters: "It is taken as of now; a bias that walked on in the meantime is trusted too much at first.",
        remedy: "Nothing; the next rest mends it. It is so for a state that was made on simulated time.",
    },
    Self::StateNotKept { ref why, again_s } => Row {
        code: "not-kept",
        text: format_args!(
            "what was learned cannot be written: {why}; the rows go on, and it is tried again every {again_s} s"
        ),
        says: Says::Warning,
        by: &["serve", "stream", "chamber"],
        seen: "What a run keeps for later has no place: calibrations that are made on the page, the state of the \
               tracking, or the finished steps of a measurement in a chamber. The disk may be full.",
        matters: "The run goes on, and its results are right. What is not kept is lost when the program ends.",
        remedy: "Make room: the state and the steps are written again a minute or a step later. Download calibrations \
                 from the page, or give the program a folder.",
        command: "zerorate serve --folder calibrations",
    },
    Self::StepsNotKept(ref why) =>
        Row { code: "not-kept", text: format_args!("the finished steps cannot be kept: {why}") },
    Self::LimitsUnknown => Row {
        code: "limits-unknown",
        text: format_args!(
            "the file of the part does not state operating_c, so only the plan keeps the chamber from harming it"
        ),
        says: Says::Warning,
        by: &["chamber"],
        seen: "The file of the part does not state at which temperatures it may operate.",
        matters: "Only the plan keeps the chamber from harming it.",
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
        text: format_args!(
            "the measurement was interrupted; a part that was switched off in between may have another bias since, \
             which shows as noise and is no part of the uncertainty. No one recording gives this result again"
        ),
        says: Says::Warning,
        by: &["chamber"],
        seen: "The measurement was interrupted, and went on from its finished steps.",
        matters: "A part that was switched off in between may have another bias since. No one recording gives this \
            result again.",
        remedy: "Measure again without an interruption if it matters.",
    },
    Self::WideLoop(ref text) => Row { code: "hysteresis", text: format_args!("{text}") },
    Self::SlowTurn { ref axis, doubtful_s } => Row {
        code: "slow-turn",
        text: format_args!(
            "{axis} was quiet for {doubtful_s} s at a level that a slow turn explains better than a change of the \
             bias: next to nothing was learned from it; if the part was at rest, calibrate it anew"
        ),
        says: Says::Warning,
        by: &["stream"],
        seen: "The part was quiet at a level that a slow turn explains better than a change of the bias.",
        matters: "Next to nothing was learned from it, so that a turn does not become bias.",
        remedy: "If the part was at rest: calibrate it anew.",
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
