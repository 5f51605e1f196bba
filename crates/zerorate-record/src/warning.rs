//! Warnings about a capture.

use zerorate::Warning;
use zerorate_allan::rows;
use zerorate_input::InputWarning;

/// A warning about a capture. The rows that were read are valid. `path` is the name of the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum CaptureWarning {
    /// A warning about one of several axes.
    OfAxis { axis: String, warning: Box<Self> },
    /// The readings no longer change. The text says since when and what to do.
    Frozen(String),
    /// The part cannot have measured some of the readings.
    Impossible(Warning),
    /// Readings beyond the range of the part. The number counts them.
    OutOfRange(u64),
    /// Most readings cannot be checked for bit errors: they are too far apart in time (`can_judge`), or the part's
    /// limits are unknown.
    Unjudged { can_judge: bool },
    /// In some of the gaps there was no data-ready edge.
    DataReadyStutters { silent_gaps: u64, gaps: u64 },
    /// Some samples were not later than the sample before them. The number counts them.
    ClockStands(u64),
    /// The time of the device jumped. The number is the sum of all jumps, in samples.
    ClockJump(u64),
    /// A warning about the end of the file.
    File(InputWarning),
    /// The file is of version 1, which has no checks.
    Unchecked { path: String },
    /// Other software has rewritten the file without its checks.
    Rewritten { path: String },
    /// `edge_seq` contradicts the time in this number of rows.
    EdgesMisplaced { path: String, rows: u64 },
}

rows!(match CaptureWarning as Display {
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
    },
    Self::ClockJump(samples) => Row {
        code: "clock-jump",
        text: format_args!("the time jumped by {samples} samples, which count as lost; find what stopped the device"),
    },
    Self::File(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::Unchecked { ref path } => Row {
        code: "not-checked",
        text: format_args!("{path} is a capture of version 1 without checks; damage may pass unnoticed"),
    },
    Self::Rewritten { ref path } => Row {
        code: "not-checked",
        text: format_args!("{path} was rewritten by other software and has no checks; prefer the original"),
    },
    Self::EdgesMisplaced { ref path, rows } => Row {
        code: "edges-misplaced",
        text: format_args!("{path}: edge_seq contradicts the time in {rows} rows; was it edited?"),
    },
});

impl CaptureWarning {
    /// The warning as scripts receive it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}
