//! What is to be said of a log, beside what is in it.

use std::fmt;
use zerorate_allan::{Says, rows};
use zerorate_record::CaptureWarning;

/// The log was read, but there is something to know. `path` names the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum LogWarning {
    /// About a capture that is read as a log.
    Capture(CaptureWarning),
    /// About the readings of a capture.
    Readings { path: String, warning: CaptureWarning },
    /// A bag does not hold as many messages as it states.
    Miscounted { path: String, topic: String, stated: u64, found: u64 },
    /// Rows of the log of a part lack the value of an axis.
    RowsIncomplete { path: String, lacking: usize, rows: usize },
    /// Values of a column were rounded to codes, by so much of this unit.
    OffCodes { path: String, column: String, by: f64, unit: &'static str, codes: f64 },
    /// The last samples of a column are the same.
    Stopped { path: String, column: String, same: usize, len: usize },
    /// Samples of a column are the same from a moment on.
    Hung { path: String, column: String, same: usize, len: usize, from_s: f64 },
    /// Rows were put in order, as the text says.
    TimesMended { path: String, column: String, how: String },
    /// The stamps are off an even clock, as the text says.
    TimesJitter { path: String, how: String },
    /// Lines above the data are no header.
    LinesSkipped { path: String, lines: usize, first: String },
    /// Lines are broken, as the text says.
    LinesBroken(String),
    /// The samples of a column are not all measured, as the text says.
    Resampled { path: String, column: String, how: String },
    /// A column does not state its unit; `unit` and `scale` are the names of settings.
    UnitUnknown { path: String, column: String, unit: &'static str, scale: &'static str },
    /// These columns are no axes of an IMU.
    ColumnsLeftOut { path: String, names: String },
    /// These columns hold no numbers.
    NoNumbers { path: String, names: String },
    /// Nothing measures these columns.
    BlanksLeftOut { path: String, names: String },
    /// More columns are of a kind than an IMU has axes; `column` is the name of a setting.
    SeveralImus { path: String, count: usize, kinds: &'static str, column: &'static str },
    /// Samples are missing.
    Gaps { path: String, missing: u64, among: usize, are_closed: bool },
    /// A record differs from the others by more than chance, as the text says.
    NotAlike(String),
}

rows!(match LogWarning {
    Self::Capture(ref warning) => Row { code: { warning.code() }, text: format_args!("{warning}") },
    Self::Readings { ref path, ref warning } =>
        Row { code: { warning.code() }, text: format_args!("{path}: {warning}") },
    Self::Miscounted { ref path, ref topic, stated, found } => Row {
        code: "messages-miscounted",
        text: format_args!(
            "{path} states {stated} messages of {topic} and holds {found}: it is damaged, or a part of it is missing \
             or came from elsewhere; take another copy"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A bag states at its end, in its index or in its `metadata.yaml`, how many messages a topic has, and \
            holds another number of them.",
        matters: "Messages were lost or came from elsewhere: bytes were changed, a file was cut and closed again, or \
            a file of another recording lies in the folder. What is there is read.",
        remedy: "Take another copy of the bag. If there is none, `ros2 bag reindex` counts the messages again.",
    },
    Self::RowsIncomplete { ref path, lacking, rows } => Row {
        code: "rows-incomplete",
        text: format_args!("{path}: {lacking} rows of {rows} lack the value of an axis; they count as lost"),
        says: Says::Either,
        by: &["calibrate", "capture"],
        seen: "Rows of a part's log lack the value of an axis.",
        matters: "They count as lost; where no row has all axes, nothing is left.",
        remedy: "Name the columns that hold the axes, as docs/formats/part.md says.",
    },
    Self::OffCodes { ref path, ref column, by, unit, codes } => Row {
        code: "off-codes",
        text: format_args!(
            "{path}: column {column} does not lie on the codes of the part; values are rounded to the nearest, by \
             {by:.3e} {unit} at most ({codes:.2} codes)"
        ),
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Values of a log do not lie on the codes of the part; they are rounded to the nearest.",
        matters: "The log is an average, was printed with too few digits, or is in another unit than its \
            column says.",
        remedy: "Check the unit in the column's name and the scale in the file of the part; log more digits.",
    },
    Self::Stopped { ref path, ref column, same, len } => Row {
        code: "frozen",
        text: format_args!(
            "{path}: the last {same} of {len} samples of column {column} are the same, while it changed most of the \
             time before; the sensor may have stopped: cut the log there"
        ),
    },
    Self::Hung { ref path, ref column, same, len, from_s } => Row {
        code: "frozen",
        text: format_args!(
            "{path}: {same} of {len} samples of column {column} are the same, from {from_s:.1} s on, while it changed \
             most of the time otherwise; the sensor or its bus may have hung: analyse what is before and after"
        ),
    },
    Self::TimesMended { ref path, ref column, ref how } => Row {
        code: "times-mended",
        text: format_args!("{path}, column {column}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Rows of a log were out of order, there twice, or had stamps that cannot be theirs, in a way that \
            has one explanation: a queue, a counter that wrapped around, a coarse clock.",
        matters: "They were put right: the order is that of the times, what is there twice counts once, and a wrong \
            stamp is replaced by the one between its neighbours.",
        remedy: "Nothing, if the text says what you expect of that log; else look at the first row that it names.",
    },
    Self::TimesJitter { ref path, ref how } => Row {
        code: "times-jitter",
        text: format_args!("{path}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "The stamps of the rows are off an even clock, by chance and by much of an interval.",
        matters: "The samples are taken as even, at their mean rate. The text says from which averaging time on \
            that changes a deviation by less than 1 %.",
        remedy: "Let the sensor or its driver stamp the samples, not whatever writes them; or judge longer \
            averages only.",
    },
    Self::LinesSkipped { ref path, lines, ref first } => Row {
        code: "lines-skipped",
        text: format_args!(
            "{path}: {lines} {} above the data are no header and skipped (the first: `{first}`)",
            if lines == 1 { "line" } else { "lines" }
        ),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Lines stand above the data that are no header.",
        matters: "They are not read; the first is shown, so that none is skipped that should count.",
        remedy: "Nothing, if they are remarks.",
    },
    Self::LinesBroken(ref text) => Row {
        code: "lines-broken",
        text: format_args!("{text}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Lines of a text have too few cells, or cells that are no numbers.",
        matters: "They are skipped. Without a time column each counts as a missing sample; with one, the times \
            tell.",
        remedy: "Look at the first, which is named. `--max-bad` sets the share from which on the log is refused.",
        command: "zerorate allan log.csv --max-bad 0",
    },
    Self::Resampled { ref path, ref column, ref how } => Row {
        code: "resampled",
        text: format_args!("{path}, column {column}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Many samples repeat the one before, or lie on the line between their neighbours, to the last \
            digit, as noise does not.",
        matters: "The log was resampled or filled in, or the sensor converts more slowly than it is read: what is \
            found is the noise of such a log, and the angle random walk N of the sensor is another.",
        remedy: "Take the log as the sensor gave it, at its own rate.",
    },
    Self::UnitUnknown { ref path, ref column, unit, scale } => Row {
        code: "unit-unknown",
        text: format_args!(
            "{path}: the unit of column {column} is not stated, so the result is in its own unit; give {unit} (dps, \
             rad/s, m/s², g …) or {scale}"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The unit of a column is not stated, by its name or by the form of the log.",
        matters: "The result is in the unit of the column, whatever that is, and no unit of a coefficient can be \
            named.",
        remedy: "Give the unit or the scale.",
        command: "zerorate allan log.csv --column gz --unit rad/s",
    },
    Self::ColumnsLeftOut { ref path, ref names } => Row {
        code: "columns-left-out",
        text: format_args!("{path}: left out, being neither gyroscope nor accelerometer: {names}"),
        says: Says::Warning,
        by: &["imu", "serve"],
        seen: "Columns of a log are neither gyroscope nor accelerometer; or are 0 in every row, as a message has \
            it whose part has fewer axes.",
        matters: "They are not analysed; were one of them an axis, its number would be missing in the file.",
        remedy: "Name the columns that are axes, if one of these is.",
        command: "zerorate imu log.csv --column gx,gy,gz",
    },
    Self::NoNumbers { ref path, ref names } =>
        Row { code: "columns-left-out", text: format_args!("{path}: left out, holding no numbers: {names}") },
    Self::BlanksLeftOut { ref path, ref names } => Row {
        code: "columns-left-out",
        text: format_args!("{path}: left out, being 0 in every row, as where nothing measures it: {names}"),
    },
    Self::SeveralImus { ref path, count, kinds, column } => Row {
        code: "several-imus",
        text: format_args!(
            "{path}: {count} columns are {kinds}, and an IMU has three: are they of several? choose with {column}"
        ),
        says: Says::Warning,
        by: &["imu", "serve"],
        seen: "More than three columns are gyroscopes, or accelerometers.",
        matters: "One IMU has three axes of each, so these are of several, and one file for a filter would mix \
            them.",
        remedy: "Choose the columns of one.",
        command: "zerorate imu log.csv --column gx,gy,gz",
    },
    Self::Gaps { ref path, missing, among, are_closed: true } => Row {
        code: "gaps",
        text: format_args!(
            "{path}: {missing} samples are missing among {among}; the gaps are closed up, which changes the result"
        ),
    },
    Self::Gaps { ref path, missing, among, are_closed: false } => Row {
        code: "gaps",
        text: format_args!(
            "{path}: {missing} samples are missing among {among}; they are gaps, and what averages lack more than \
             half of their samples is left out"
        ),
    },
    Self::NotAlike(ref text) => Row {
        code: "not-alike",
        text: format_args!("{text}"),
        says: Says::Warning,
        by: &["allan"],
        seen: "Among records that were to have one model, one differs by more than chance.",
        matters: "It is left out, or, of two, both are suspect.",
        remedy: "Look at it by itself. A third record would tell which is the exception.",
    },
});

impl LogWarning {
    /// About a file whose end is missing, if it is.
    pub(crate) fn torn(text: Option<String>) -> Vec<Self> {
        text.map(|text| CaptureWarning::Torn(text).into()).into_iter().collect()
    }

    /// As scripts read it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}

impl fmt::Display for LogWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

impl From<CaptureWarning> for LogWarning {
    fn from(warning: CaptureWarning) -> Self {
        Self::Capture(warning)
    }
}
