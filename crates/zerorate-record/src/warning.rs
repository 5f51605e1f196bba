//! What is to be said of a capture, beside what is in it.

use std::fmt;
use zerorate::Warning;
use zerorate_allan::{Says, rows};

/// The rows that were read stand, but there is something to know. `path` names the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum CaptureWarning {
    /// About one of several axes.
    OfAxis { axis: String, warning: Box<Self> },
    /// The readings do not change any more, since when and what to do.
    Frozen(String),
    /// About readings that the part cannot have made.
    Impossible(Warning),
    /// So many readings are beyond the range of the part.
    OutOfRange(u64),
    /// Impossible readings cannot be told from motion.
    Unjudged { can_judge: bool },
    /// Gaps without an edge of data ready.
    DataReadyStutters { silent_gaps: u64, gaps: u64 },
    /// So many samples were not later than the one before.
    ClockStands(u64),
    /// The time of the device went on by so many samples.
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
        text: format_args!(
            "{readings} readings are beyond the range of the part: it turns, its supply is wrong, or the line carries \
             errors; they are not to be used"
        ),
    },
    Self::Unjudged { can_judge: true } => Row {
        code: "unjudged",
        text: format_args!(
            "the readings are too far apart to tell impossible ones from motion (bit errors would pass); use a \
             smaller divider"
        ),
        says: Says::Warning,
        by: &["capture", "stream", "correct"],
        seen: "The readings are too far apart in time, or too little is known of the part, to tell an impossible \
            reading from motion.",
        matters: "Bit errors would pass.",
        remedy: "Use a smaller divider; or state range, bandwidth and noise in the file of the part.",
    },
    Self::Unjudged { can_judge: false } => Row {
        code: "unjudged",
        text: format_args!(
            "too little is known of the part (its range, bandwidth and noise) to tell impossible readings from motion \
             (bit errors would pass); state them in the file of the part"
        ),
    },
    Self::DataReadyStutters { silent_gaps, gaps } => Row {
        code: "data-ready-stutters",
        text: format_args!(
            "in {silent_gaps} of {gaps} gaps no edge of data ready came: its line (ADIS16130: RDY, pin 10) stutters, \
             or the host was deaf to it for that long; check its wire, its level and its pull-up, and only then what \
             else the host does"
        ),
    },
    Self::ClockStands(samples) => Row {
        code: "clock-stands",
        text: format_args!(
            "{samples} samples were not later than the one before; they are left out, and counted as lost"
        ),
        says: Says::Warning,
        by: &["capture"],
        seen: "Samples came whose time was not later than that of the one before.",
        matters: "They are left out, and counted as lost.",
        remedy: "Look at the clock of the device or its driver. The recording is whole otherwise.",
    },
    Self::ClockJump(samples) => Row {
        code: "clock-jump",
        text: format_args!(
            "the time of the device went on by {samples} samples that it did not count; they are counted as lost"
        ),
        says: Says::Warning,
        by: &["capture"],
        seen: "The time of the device went on by samples that it did not count.",
        matters: "They are counted as lost.",
        remedy: "Look at what stopped the device: a host that slept, a driver that restarted.",
    },
    Self::Torn(ref text) => Row {
        code: "torn-tail",
        text: format_args!("{text}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A capture or a log lacks its end: it was not closed, as after a power cut, or its end was removed.",
        matters: "Every whole block of rows that a check vouches for is read, of a log without checks whatever is \
            whole; what stands behind is dropped. So the recording is shorter than it was.",
        remedy: "Nothing, if the rest is long enough; of a capture `zerorate repair` writes the whole blocks to a \
            file of their own, and says what is missing.",
        command: "zerorate repair torn.arrows -o whole.arrows",
    },
    Self::NoIndex { ref path } => Row {
        code: "no-index",
        text: format_args!("{path} has no index, for its end is missing: all rows are there"),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A bag (MCAP) has no index, because its end is missing.",
        matters: "All rows are there, and were checked. Other programs may not find them without the index.",
        remedy: "`mcap recover` gives the bag an index. For our own commands write its rows to a file with \
            `zerorate repair`.",
        command: "zerorate repair run.mcap -o whole.arrows",
    },
    Self::BytesBehindEnd { ref path, bytes } => Row {
        code: "bytes-behind-end",
        text: format_args!("{path}: the {bytes} bytes after its end of stream are ignored"),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "Bytes follow after the end of a capture.",
        matters: "They are ignored. Two files may have been joined, of which the second is not read.",
        remedy: "Compare the length with that of the original; read the second capture by itself.",
        command: "zerorate verify rest.arrows",
    },
    Self::Unchecked { ref path } => Row {
        code: "not-checked",
        text: format_args!(
            "{path} is a capture of version 1, and nothing in it can be checked: damage may pass unnoticed"
        ),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "A capture has no checks over its rows: it is of version 1, or other software has written it \
            again.",
        matters: "Damage may pass unnoticed.",
        remedy: "Prefer the original, as `zerorate capture` wrote it.",
        command: "zerorate verify rest.arrows",
    },
    Self::Rewritten { ref path } => Row {
        code: "not-checked",
        text: format_args!(
            "{path} was written again by other software, and its rows cannot be checked: prefer the original"
        ),
    },
    Self::EdgesMisplaced { ref path, rows } => Row {
        code: "edges-misplaced",
        text: format_args!(
            "{path}: edge_seq contradicts the time in {rows} rows, so the rate of data ready is not to be believed"
        ),
        says: Says::Warning,
        by: &["probe", "capture", "correct", "repair", "stream", "calibrate", "recalibrate", "serve"],
        seen: "In some rows of a capture the count of edges of data ready contradicts the time.",
        matters: "Rates and times of the rows stand; the rate of data ready that follows from the count is not \
            to be believed.",
        remedy: "Look at the rows: the capture was edited, or made by other software.",
        command: "zerorate verify rest.arrows",
    },
});

impl CaptureWarning {
    /// As scripts read it: `code: text`.
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
