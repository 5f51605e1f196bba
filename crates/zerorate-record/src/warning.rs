//! Warnings about a capture.

use std::fmt;
use zerorate::Warning;
use zerorate_allan::{Says, rows};

/// A warning about a capture. The rows that were read stand. `path` names the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum CaptureWarning {
    /// A warning about one of several axes.
    OfAxis { axis: String, warning: Box<Self> },
    /// The readings do not change any more. The text says since when, and what to do.
    Frozen(String),
    /// The part cannot have made some of the readings.
    Impossible(Warning),
    /// Number of readings beyond the range of the part.
    OutOfRange(u64),
    /// Impossible readings cannot be told from motion.
    Unjudged { can_judge: bool },
    /// Gaps without an edge of data ready.
    DataReadyStutters { silent_gaps: u64, gaps: u64 },
    /// Number of samples that were not later than the one before.
    ClockStands(u64),
    /// Number of samples by which the time of the device jumped.
    ClockJump(u64),
    /// The file lacks its end, as the text says.
    Torn(String),
    /// A bag lacks its index.
    NoIndex { path: String },
    /// Bytes follow the end.
    BytesBehindEnd { path: String, bytes: u64 },
    /// The file is of version 1.
    Unchecked { path: String },
    /// Other software has written the file again.
    Rewritten { path: String },
    /// The count of edges contradicts the time in so many rows.
    EdgesMisplaced { path: String, rows: u64 },
}

rows!(match CaptureWarning {
    Self::OfAxis { ref axis, ref warning } =>
        Row { code: { warning.code() }, text: format_args!("axis {axis}: {warning}") },
    Self::Frozen(ref text) => Row { code: "frozen", text: format_args!("{text}") },
    Self::Impossible(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::OutOfRange(readings) => Row {
        code: "out-of-range",
        text: format_args!("{readings} readings are beyond the range of the part; check motion, supply and wiring"),
    },
    Self::Unjudged { can_judge: true } => Row {
        code: "unjudged",
        text: format_args!("the readings are too far apart to tell bit errors from motion; use a smaller divider"),
        says: Says::Warning,
        by: &["capture", "stream", "correct"],
        seen: "The readings are too far apart in time, or too little is known of the part, to tell an impossible \
            reading from motion.",
        matters: "Bit errors would pass.",
        remedy: "Use a smaller divider. If too little is known of the part, state its range, bandwidth and noise in \
            the file of the part.",
    },
    Self::Unjudged { can_judge: false } => Row {
        code: "unjudged",
        text: format_args!("bit errors cannot be told from motion; state range, bandwidth and noise of the part"),
    },
    Self::DataReadyStutters { silent_gaps, gaps } => Row {
        code: "data-ready-stutters",
        text: format_args!(
            "no data-ready edge came in {silent_gaps} of {gaps} gaps; check its wire, level and pull-up"
        ),
    },
    Self::ClockStands(samples) => Row {
        code: "clock-stands",
        text: format_args!("{samples} samples were not later than the one before and count as lost; check the clock"),
        says: Says::Warning,
        by: &["capture"],
        seen: "Samples came that were not later than the sample before.",
        matters: "These samples are left out, and counted as lost.",
        remedy: "Check the clock of the device or its driver. The recording is whole otherwise.",
    },
    Self::ClockJump(samples) => Row {
        code: "clock-jump",
        text: format_args!("the time jumped by {samples} samples, which count as lost; find what stopped the device"),
        says: Says::Warning,
        by: &["capture"],
        seen: "The time of the device jumped forward, by samples that the device did not count.",
        matters: "These samples are counted as lost.",
        remedy: "Find what stopped the device: a host that slept, or a driver that restarted.",
    },
    Self::Torn(ref text) => Row {
        code: "torn-tail",
        text: format_args!("{text}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A capture or a log lacks its end: it was not closed, as after a power cut, or its end was removed.",
        matters: "In a capture, every whole block of rows that passes its check is read. In a log without checks, \
            every whole row is read. The rest is dropped, so the recording is shorter than it was.",
        remedy: "Do nothing if the recording is still long enough. `zerorate repair` writes the whole blocks of a \
            capture to a new file, and says what is missing.",
        command: "zerorate repair torn.arrows -o whole.arrows",
    },
    Self::NoIndex { ref path } => Row {
        code: "no-index",
        text: format_args!("{path} lost its end with the index; all rows are there"),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A bag (MCAP) has no index, because its end is missing.",
        matters: "All rows are there, and were checked. Other programs may not find them without the index.",
        remedy: "Give the bag an index with `mcap recover`. For the commands of zerorate, write its rows to a file \
            with `zerorate repair`.",
        command: "zerorate repair run.mcap -o whole.arrows",
    },
    Self::BytesBehindEnd { ref path, bytes } => Row {
        code: "bytes-behind-end",
        text: format_args!("{path}: {bytes} bytes after its end are ignored; were two files joined?"),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "Bytes follow after the end of a capture.",
        matters: "These bytes are ignored. Two files may have been joined, and the second is not read.",
        remedy: "Compare the length with the original; read the second capture by itself.",
        command: "zerorate verify rest.arrows",
    },
    Self::Unchecked { ref path } => Row {
        code: "not-checked",
        text: format_args!("{path} is a capture of version 1 without checks; damage may pass unnoticed"),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A capture has no checks over its rows: its version is 1, or other software has rewritten it.",
        matters: "Damage may pass unnoticed.",
        remedy: "Prefer the original, as `zerorate capture` wrote it.",
        command: "zerorate verify rest.arrows",
    },
    Self::Rewritten { ref path } => Row {
        code: "not-checked",
        text: format_args!("{path} was rewritten by other software and has no checks; prefer the original"),
    },
    Self::EdgesMisplaced { ref path, rows } => Row {
        code: "edges-misplaced",
        text: format_args!("{path}: edge_seq contradicts the time in {rows} rows; was it edited?"),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "In some rows of a capture the count of data-ready edges (edge_seq) contradicts the time.",
        matters: "Rates and times of the rows stand. Do not trust the data-ready rate, which follows from the count.",
        remedy: "Look at the rows: the capture was edited, or made by other software.",
        command: "zerorate verify rest.arrows",
    },
});

impl CaptureWarning {
    /// The warning as scripts read it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}

impl fmt::Display for CaptureWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blocks::cut_off;
    use std::path::Path;

    /// A warning about an axis has the name of the axis in addition.
    #[test]
    fn a_warning_is_one_short_line() {
        let path = || "rest.arrows".to_owned();
        let frozen = zerorate::health::Frozen { since_ns: 1_830_500_000_000, both: true };
        let all = [
            CaptureWarning::Frozen(crate::believed::frozen_text(&frozen, 0)),
            CaptureWarning::OutOfRange(1200),
            CaptureWarning::Unjudged { can_judge: true },
            CaptureWarning::Unjudged { can_judge: false },
            CaptureWarning::DataReadyStutters { silent_gaps: 120, gaps: 340 },
            CaptureWarning::ClockStands(120),
            CaptureWarning::ClockJump(1200),
            cut_off(Path::new("rest.arrows"), 1024),
            CaptureWarning::NoIndex { path: path() },
            CaptureWarning::BytesBehindEnd { path: path(), bytes: 123_456 },
            CaptureWarning::Unchecked { path: path() },
            CaptureWarning::Rewritten { path: path() },
            CaptureWarning::EdgesMisplaced { path: path(), rows: 1200 },
        ];
        for line in all.map(|warning| warning.coded()) {
            assert!(line.chars().count() <= 100, "{line}");
        }
    }
}
