//! Warnings about a log.

use std::path::Path;
use zerorate_allan::{SettingName, rows};
use zerorate_input::{InputWarning, Unit};

/// A warning about a log that was read. `path` names the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum LogWarning {
    /// A warning about the end of the file.
    File(InputWarning),
    /// A warning about a table that describes itself.
    OfTable { code: &'static str, text: String },
    /// A warning about a column of a table that describes itself.
    OfReadings { path: String, code: &'static str, text: String },
    /// A bag does not hold as many messages as it states.
    Miscounted { path: String, topic: String, stated: u64, found: u64 },
    /// Rows of the log of a sensor lack the value of an axis.
    RowsIncomplete { path: String, lacking: usize, rows: usize },
    /// Values of a column were rounded to codes, by up to `by`, in `unit`, or `codes` steps of the code.
    OffCodes { path: String, column: String, by: f64, unit: &'static str, codes: f64 },
    /// The last samples of a column are equal.
    Stopped { path: String, column: String, same: usize, len: usize },
    /// Samples of a column are equal from `from_s` seconds on, and change again later.
    Hung { path: String, column: String, same: usize, len: usize, from_s: f64 },
    /// Irregular times were repaired, as the text says.
    TimesRepaired { path: String, column: String, how: String },
    /// The stamps deviate from an even clock, as the text says.
    TimesJitter { path: String, how: String },
    /// The log does not state the unit of a column of times, and the dates in the column show it.
    TimeUnitTaken { path: String, column: String, unit: &'static str },
    /// The words of column names tell units that they do not state, as the text says.
    UnitsTaken { path: String, what: &'static str },
    /// Rows come faster in one part of the log than in another, as the text says.
    RateChanges { path: String, how: String },
    /// The lines above the data are not a header.
    LinesSkipped { path: String, lines: usize, first: String },
    /// Lines cannot be read as rows and are skipped, as the text says.
    LinesBroken(String),
    /// Samples of a column were repeated or interpolated instead of measured, as the text says.
    Resampled { path: String, column: String, how: String },
    /// Codes of a column, `bits` bits wide, were written without their sign, and are read with it.
    CodesUnsigned { path: String, column: String, bits: i32 },
    /// `line`, above the data, states a scale that is not used.
    ScaleUnused { path: String, line: String },
    /// The scale of integer codes is assumed, as the text says.
    ScaleAssumed(String),
    /// The number `name` beside the columns states the sample rate, which is used.
    RateTaken { path: String, name: String, rate_hz: f64 },
    /// The rate that was given, or that a number in the file states, is not the rate of the stamps.
    RateContradicts { path: String, given_hz: f64, stamps_hz: f64 },
    /// Samples of a column pile up at its largest or least value, as the text says.
    Clipped { path: String, column: String, how: String },
    /// The steps of a column are larger than its noise, as the text says.
    CoarseCodes { path: String, column: String, how: String },
    /// The samples or the rate of an IMU's axes are implausible for a sensor at rest, as the text says.
    Implausible { path: String, what: String },
    /// A column does not state its unit; `unit` and `scale` are the names of settings.
    UnitUnknown { path: String, column: String, unit: SettingName, scale: SettingName },
    /// The columns `names` are not axes of the IMU that was read.
    ColumnsLeftOut { path: String, names: String },
    /// The columns `names` hold no numbers.
    NoNumbers { path: String, names: String },
    /// The columns `names` are 0 in every row.
    BlanksLeftOut { path: String, names: String },
    /// The columns `names`, which were not asked for by name, are the same in every row.
    ConstantsLeftOut { path: String, names: String },
    /// Samples are missing. `are_closed` is true if the gaps were closed up.
    Gaps { path: String, missing: u64, among: usize, are_closed: bool },
    /// A record differs from the other records by more than chance, as the text says.
    NotAlike(String),
}

rows!(match LogWarning as Display {
    Self::File(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::OfTable { code, ref text } => Row { code: { code }, text: format_args!("{text}") },
    Self::OfReadings { ref path, code, ref text } => Row { code: { code }, text: format_args!("{path}: {text}") },
    Self::Miscounted { ref path, ref topic, stated, found } => Row {
        code: "messages-miscounted",
        text: format_args!("{path} states {stated} messages of {topic} and holds {found}; take another copy"),
    },
    Self::RowsIncomplete { ref path, lacking, rows } => Row {
        code: "rows-incomplete",
        text: format_args!("{path}: {lacking} of {rows} rows lack the value of an axis; they count as lost"),
    },
    Self::OffCodes { ref path, ref column, by, unit, codes } => Row {
        code: "off-codes",
        text: format_args!("{path}: column {column} is rounded to codes, by up to {by:.1e} {unit} ({codes:.2} codes)"),
    },
    Self::Stopped { ref path, ref column, same, len } => Row {
        code: "frozen",
        text: format_args!("{path}: the last {same} of {len} samples of column {column} are the same; cut them off"),
    },
    Self::Hung { ref path, ref column, same, len, from_s } => Row {
        code: "frozen",
        text: format_args!(
            "{path}: {same} of {len} samples of column {column} are the same, from {from_s:.1} s on; cut them out"
        ),
    },
    Self::TimesRepaired { ref path, ref column, ref how } =>
        Row { code: "times-mended", text: format_args!("{path}, {column}: {how}") },
    Self::TimesJitter { ref path, ref how } => Row { code: "times-jitter", text: format_args!("{path}: {how}") },
    Self::TimeUnitTaken { ref path, ref column, unit } => Row {
        code: "time-unit-taken",
        text: format_args!("{path}: `{column}` counts {unit} since 1970, as its dates tell"),
    },
    Self::UnitsTaken { ref path, what } => Row { code: "units-taken", text: format_args!("{path}: {what}") },
    Self::RateChanges { ref path, ref how } => Row { code: "rate-changes", text: format_args!("{path}: {how}") },
    Self::LinesSkipped { ref path, lines, ref first } => Row {
        code: "lines-skipped",
        text: format_args!(
            "{path}: {lines} {} above the data are not a header; skipped: `{first:.20}` …",
            if lines == 1 { "line" } else { "lines" }
        ),
    },
    Self::LinesBroken(ref text) => Row { code: "lines-broken", text: format_args!("{text}") },
    Self::Resampled { ref path, ref column, ref how } =>
        Row { code: "resampled", text: format_args!("{path}, {column}: {how}") },
    Self::CodesUnsigned { ref path, ref column, bits } => Row {
        code: "codes-unsigned",
        text: format_args!("{path}, {column}: codes of {bits} bits lack their sign, and are read with it"),
    },
    Self::ScaleUnused { ref path, ref line } =>
        Row { code: "scale-unused", text: format_args!("{path}: `{line:.40}` is not used; give unit and scale") },
    Self::ScaleAssumed(ref text) => Row { code: "scale-assumed", text: format_args!("{text}") },
    Self::RateTaken { ref path, ref name, rate_hz } => Row {
        code: "rate-taken",
        text: format_args!("{path}: `{name}` states {rate_hz} Hz, which is taken as the sample rate"),
    },
    Self::RateContradicts { ref path, given_hz, stamps_hz } => Row {
        code: "rate-contradicts",
        text: format_args!("{path}: {given_hz:.6} Hz was given, and the stamps tell {stamps_hz:.6} Hz"),
    },
    Self::Clipped { ref path, ref column, ref how } =>
        Row { code: "clipped", text: format_args!("{path}, {column}: {how}") },
    Self::CoarseCodes { ref path, ref column, ref how } =>
        Row { code: "coarse-codes", text: format_args!("{path}, {column}: {how}") },
    Self::Implausible { ref path, ref what } =>
        Row { code: "implausible", text: format_args!("{path}: {what}; a wrong unit or scale, or mixed columns?") },
    Self::UnitUnknown { ref path, ref column, unit, scale } => Row {
        code: "unit-unknown",
        text: format_args!("{path}: the unit of column {column} is not stated; give {unit} (dps, rad/s …) or {scale}"),
    },
    Self::ColumnsLeftOut { ref path, ref names } =>
        Row { code: "columns-left-out", text: format_args!("{path}: not read as an axis of an IMU: {names}") },
    Self::NoNumbers { ref path, ref names } =>
        Row { code: "columns-left-out", text: format_args!("{path}: left out, holding no numbers: {names}") },
    Self::BlanksLeftOut { ref path, ref names } =>
        Row { code: "columns-left-out", text: format_args!("{path}: left out, being 0 in every row: {names}") },
    Self::ConstantsLeftOut { ref path, ref names } =>
        Row { code: "columns-left-out", text: format_args!("{path}: left out, being the same in every row: {names}") },
    Self::Gaps { ref path, missing, among, are_closed: true } => Row {
        code: "gaps",
        text: format_args!(
            "{path}: {missing} samples are missing among {among}; the gaps are closed up, which changes results"
        ),
    },
    Self::Gaps { ref path, missing, among, are_closed: false } => Row {
        code: "gaps",
        text: format_args!(
            "{path}: {missing} samples are missing among {among}; averages that lack over half are left out"
        ),
    },
    Self::NotAlike(ref text) => Row { code: "not-alike", text: format_args!("{text}") },
});

impl LogWarning {
    pub(crate) fn miscounted(path: &Path, topic: &str, stated: u64, found: u64) -> Self {
        Self::Miscounted { path: path.display().to_string(), topic: topic.to_owned(), stated, found }
    }

    pub(crate) fn of_ros(path: &Path, unit: Unit) -> Self {
        let what = match unit {
            Unit::RadPerS => "angular_velocity in rad/s, as in messages of ROS (REP-103)",
            _ => "linear_acceleration in m/s², as in messages of ROS (REP-103)",
        };
        Self::UnitsTaken { path: path.display().to_string(), what }
    }

    /// True if the warning is about the log as a whole, and not about one of its columns.
    #[must_use]
    pub fn is_of_log(&self) -> bool {
        match self {
            Self::OfReadings { .. }
            | Self::OffCodes { .. }
            | Self::Stopped { .. }
            | Self::Hung { .. }
            | Self::Resampled { .. }
            | Self::Clipped { .. }
            | Self::CodesUnsigned { .. }
            | Self::CoarseCodes { .. }
            | Self::UnitsTaken { .. }
            | Self::UnitUnknown { .. } => false,
            Self::File(_)
            | Self::OfTable { .. }
            | Self::Miscounted { .. }
            | Self::RowsIncomplete { .. }
            | Self::TimesRepaired { .. }
            | Self::TimesJitter { .. }
            | Self::TimeUnitTaken { .. }
            | Self::RateChanges { .. }
            | Self::LinesSkipped { .. }
            | Self::ScaleUnused { .. }
            | Self::ScaleAssumed(_)
            | Self::RateTaken { .. }
            | Self::RateContradicts { .. }
            | Self::LinesBroken(_)
            | Self::Implausible { .. }
            | Self::ColumnsLeftOut { .. }
            | Self::NoNumbers { .. }
            | Self::BlanksLeftOut { .. }
            | Self::ConstantsLeftOut { .. }
            | Self::Gaps { .. }
            | Self::NotAlike(_) => true,
        }
    }

    /// The warning as scripts read it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}
