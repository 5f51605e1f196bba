//! Warnings about a log.

use std::fmt;
use zerorate_allan::{Says, rows};
use zerorate_record::CaptureWarning;

/// A warning about a log, which was read. `path` names the file.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum LogWarning {
    /// A warning about a capture that is read as a log.
    Capture(CaptureWarning),
    /// A warning about the readings of a capture.
    Readings { path: String, warning: CaptureWarning },
    /// A bag does not hold as many messages as it states.
    Miscounted { path: String, topic: String, stated: u64, found: u64 },
    /// Rows of the log of a part lack the value of an axis.
    RowsIncomplete { path: String, lacking: usize, rows: usize },
    /// Values of a column were rounded to codes, by so much of this unit.
    OffCodes { path: String, column: String, by: f64, unit: &'static str, codes: f64 },
    /// The last samples of a column are equal.
    Stopped { path: String, column: String, same: usize, len: usize },
    /// Samples of a column are equal from a moment on.
    Hung { path: String, column: String, same: usize, len: usize, from_s: f64 },
    /// Rows were put in order, as the text says.
    TimesMended { path: String, column: String, how: String },
    /// The stamps are off an even clock, as the text says.
    TimesJitter { path: String, how: String },
    /// Rows come faster in one part of the log than in another, as the text says.
    RateChanges { path: String, how: String },
    /// The lines above the data are not a header.
    LinesSkipped { path: String, lines: usize, first: String },
    /// Lines are broken, as the text says.
    LinesBroken(String),
    /// The samples of a column are not all measured, as the text says.
    Resampled { path: String, column: String, how: String },
    /// Samples of a column stand at a limit, as the text says.
    Clipped { path: String, column: String, how: String },
    /// The steps of a column are larger than its noise, as the text says.
    CoarseCodes { path: String, column: String, how: String },
    /// The means of an IMU's axes are not those of a sensor at rest, as the text says.
    Implausible { path: String, what: String },
    /// A column does not state its unit; `unit` and `scale` are the names of settings.
    UnitUnknown { path: String, column: String, unit: &'static str, scale: &'static str },
    /// These columns are not axes of an IMU.
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
        text: format_args!("{path} states {stated} messages of {topic} and holds {found}; take another copy"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A bag states at its end, in its index or in its `metadata.yaml`, how many messages a topic has, and \
            holds another number of them.",
        matters: "The bag is damaged, or a part of it is missing or came from elsewhere. Bytes were changed, a file \
            was cut and closed again, or a file of another recording lies in the folder. The messages that are there \
            are read.",
        remedy: "Take another copy of the bag. If there is none, `ros2 bag reindex` counts the messages again.",
    },
    Self::RowsIncomplete { ref path, lacking, rows } => Row {
        code: "rows-incomplete",
        text: format_args!("{path}: {lacking} of {rows} rows lack the value of an axis; they count as lost"),
        says: Says::Either,
        by: &["calibrate", "capture"],
        seen: "Rows of a part's log lack the value of an axis.",
        matters: "These rows count as lost. Where no row has all axes, nothing is left.",
        remedy: "Name the columns that hold the axes, as docs/formats/part.md says.",
    },
    Self::OffCodes { ref path, ref column, by, unit, codes } => Row {
        code: "off-codes",
        text: format_args!("{path}: column {column} is rounded to codes, by up to {by:.1e} {unit} ({codes:.2} codes)"),
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Values of a log do not lie on the codes of the part. They are rounded to the nearest codes.",
        matters: "The log is an average, was printed with too few digits, or is in another unit than its \
            column says.",
        remedy: "Check the unit in the column's name and the scale in the file of the part; log more digits.",
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
    Self::TimesMended { ref path, ref column, ref how } => Row {
        code: "times-mended",
        text: format_args!("{path}, {column}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Rows of a log were out of order, there twice, or had impossible stamps. All of it has one \
            explanation: a queue, a counter that wrapped around, or a coarse clock.",
        matters: "The rows were put right. They are sorted by time, and a row that is there twice counts once. A \
            wrong stamp is replaced by the time halfway between its neighbours; its sample counts. A counter that \
            wrapped around is unwrapped. Where a clock was set back, no sample is taken as lost.",
        remedy: "Do nothing if the text says what you expect of that log. Otherwise look at the first row that it \
            names.",
    },
    Self::TimesJitter { ref path, ref how } => Row {
        code: "times-jitter",
        text: format_args!("{path}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "The stamps of the rows are off an even clock, by chance and by much of an interval.",
        matters: "The samples are taken as even, at their mean rate. For white noise that changes nothing. With a \
            jitter of j intervals (rms) it changes other deviations over m samples by 1.5 j/m² + 0.89 j²/m at most. \
            The text says from which averaging time on that is less than 1 %.",
        remedy: "Let the sensor or its driver stamp the samples, not the program that writes them; or judge longer \
            averages only.",
    },
    Self::RateChanges { ref path, ref how } => Row {
        code: "rate-changes",
        text: format_args!("{path}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "In one part of a log the rows come faster than in another, by more than 2 %.",
        matters: "The samples are taken as even, at one rate. Where the rows came faster or more slowly, all \
            averaging times are wrong by as much, and samples may be counted as missing that never were.",
        remedy: "Look for a setting that was changed, or a sensor whose clock warms up. Cut the log where the rate \
            changes. `--rate` with the right rate helps if the sensor is even and its stamps are wrong.",
    },
    Self::LinesSkipped { ref path, lines, ref first } => Row {
        code: "lines-skipped",
        text: format_args!(
            "{path}: {lines} {} above the data are not a header; skipped: `{first:.20}` …",
            if lines == 1 { "line" } else { "lines" }
        ),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Lines stand above the data that are not a header.",
        matters: "These lines are not read. The start of the first is shown, so that you notice if it should count.",
        remedy: "Do nothing if they are remarks.",
    },
    Self::LinesBroken(ref text) => Row {
        code: "lines-broken",
        text: format_args!("{text}"),
        says: Says::Warning,
        by: &["allan", "imu", "probe", "capture", "calibrate", "recalibrate", "stream", "serve"],
        seen: "Lines of a text have too few cells, or cells that are not numbers.",
        matters: "These lines are skipped. Without a time column each counts as a missing sample; with one, the \
            times tell.",
        remedy: "Look at the first of them, which the text names. `--max-bad` sets the share of broken lines above \
            which the log is refused.",
        command: "zerorate allan log.csv --max-bad 0",
    },
    Self::Resampled { ref path, ref column, ref how } => Row {
        code: "resampled",
        text: format_args!("{path}, {column}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Many samples repeat the one before, or lie on the line between their neighbours, to the last \
            digit, as noise does not.",
        matters: "The log was resampled or filled in, or the sensor converts more slowly than it is read. The \
            result is the noise of such a log. The angle random walk N of the sensor itself differs.",
        remedy: "Take the log as the sensor gave it, at its own rate.",
    },
    Self::Clipped { ref path, ref column, ref how } => Row {
        code: "clipped",
        text: format_args!("{path}, {column}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "More than one in a thousand samples are exactly the largest value of a column, or the least. Noise has \
            its fewest samples there.",
        matters: "The sensor is at the limit of its range, or a number marks what is missing. N, B and K are those of \
            such a log: clipped noise is too small, and marks are counted as noise.",
        remedy: "Record in a larger range, or write nothing (or `nan`) where a sample is missing.",
    },
    Self::CoarseCodes { ref path, ref column, ref how } => Row {
        code: "coarse-codes",
        text: format_args!("{path}, {column}: {how}"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Within 32 samples a column scatters by less than 0.58 of its steps. The noise before rounding is then \
            below half a step.",
        matters: "Rounding of more noise than that is white and small. Of less, it is neither: N, B and K may be many \
            times too large or too small, and so may their limits.",
        remedy: "Record in a smaller range, or with finer codes. Look at longer averages only if the level moves over \
            several steps meanwhile.",
    },
    Self::Implausible { ref path, ref what } => Row {
        code: "implausible",
        text: format_args!("{path}: {what}; a wrong unit or scale, or mixed columns?"),
        says: Says::Warning,
        by: &["imu"],
        seen: "The three accelerometers of an IMU do not show gravity, which is 9.8 m/s², within 20 %. Or the mean of \
            a gyroscope is above 50 °/s, where a bias is below 20.",
        matters: "At rest these means are known, so that the unit or the scale is probably wrong. N, B and K are then \
            wrong by the same factor: a log in g that is read as m/s² has a tenth of its noise.",
        remedy: "Check `--gyro-unit`, `--accel-unit`, the scales, and which columns are which. Do nothing if the \
            sensor was turning.",
        command: "zerorate imu log.csv --accel-unit g",
    },
    Self::UnitUnknown { ref path, ref column, unit, scale } => Row {
        code: "unit-unknown",
        text: format_args!("{path}: the unit of column {column} is not stated; give {unit} (dps, rad/s …) or {scale}"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The unit of a column is not stated, by its name or by the form of the log.",
        matters: "The result is in the unknown unit of the column, so coefficients have no units.",
        remedy: "Give the unit (dps, rad/s, m/s², g …) or the scale.",
        command: "zerorate allan log.csv --column gz --unit rad/s",
    },
    Self::ColumnsLeftOut { ref path, ref names } => Row {
        code: "columns-left-out",
        text: format_args!("{path}: neither gyroscope nor accelerometer: {names}"),
        says: Says::Warning,
        by: &["imu", "serve"],
        seen: "Columns of a log are neither gyroscope nor accelerometer; or they are 0 in every row, as in a \
            message from a part with fewer axes.",
        matters: "These columns are not analysed. If one of them were an axis, its number would be missing in the \
            file.",
        remedy: "If one of these columns is an axis, name the columns that are axes.",
        command: "zerorate imu log.csv --column gx,gy,gz",
    },
    Self::NoNumbers { ref path, ref names } =>
        Row { code: "columns-left-out", text: format_args!("{path}: left out, holding no numbers: {names}") },
    Self::BlanksLeftOut { ref path, ref names } =>
        Row { code: "columns-left-out", text: format_args!("{path}: left out, being 0 in every row: {names}") },
    Self::SeveralImus { ref path, count, kinds, column } => Row {
        code: "several-imus",
        text: format_args!("{path}: {count} columns are {kinds}, and an IMU has three; choose with {column}"),
        says: Says::Warning,
        by: &["imu", "serve"],
        seen: "More than three columns are gyroscopes, or accelerometers.",
        matters: "One IMU has three axes of each, so these columns belong to several IMUs. One file for a filter \
            would mix them.",
        remedy: "Choose the columns of one.",
        command: "zerorate imu log.csv --column gx,gy,gz",
    },
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
    Self::NotAlike(ref text) => Row {
        code: "not-alike",
        text: format_args!("{text}"),
        says: Says::Warning,
        by: &["allan"],
        seen: "Among records that were to have one model, one differs by more than chance. Either its angle random \
            walk N differs, or its slow noise (flicker, random walk or memory; the text gives the change of −2 ln L), \
            or it has no model of its own.",
        matters: "That record is left out of the common model. Of only two records both are kept, and both are \
            suspect.",
        remedy: "Look at it by itself. A third record would tell which is the exception.",
    },
});

impl LogWarning {
    /// The warning about a file whose end is missing; empty where the end is there.
    pub(crate) fn torn(text: Option<String>) -> Vec<Self> {
        text.map(|text| CaptureWarning::Torn(text).into()).into_iter().collect()
    }

    /// The warning as scripts read it: `code: text`.
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

#[cfg(test)]
mod tests {
    use super::*;

    /// [`LogWarning::LinesBroken`] names what is wrong in a line, which may be longer.
    #[test]
    fn a_warning_is_one_short_line() {
        let [path, column] = [|| "log.csv".to_owned(), || "gz_dps".to_owned()];
        let [topic, names] = [|| "/imu".to_owned(), || "mag_x, mag_y, mag_z, temp_c".to_owned()];
        let first = "ets Jun  8 2016 00:22:57, rst:0x1 (POWERON_RESET)".to_owned();
        let how = "12 rows come too late and are sorted (the first: row 3456)".to_owned();
        let beat = crate::clock::Beat { rate_hz: 200.0, gaps: Vec::new(), jitter: 0.15, as_losses: None };
        let held = (0..4000).map(|at| f64::from((at / 2) * (at / 2) % 1999 * 52_561)).collect();
        let resampled = crate::resampled::doubt(&crate::series::Series::Numbers(held)).expect("each is there twice");
        let marked = (0..4000).map(|at| if at % 20 == 0 { -9999.0 } else { f64::from(at) }).collect();
        let clipped = crate::clipped::doubt(&crate::series::Series::Numbers(marked)).expect("many are the least");
        let rounded = (0..4000).map(|at| i32::from(at % 40 == 0)).collect();
        let coarse = crate::coarse::doubt(&crate::series::Series::Codes(rounded)).expect("hardly one is another");
        let faster: Vec<f64> = (0..4000).map(|at| f64::from(at) * f64::from(at)).collect();
        let pace = crate::pace::doubt(&faster, &[], zerorate_record::TimeUnit::Us).expect("another rate in each part");
        let all = [
            LogWarning::Miscounted { path: "run_0".to_owned(), topic: topic(), stated: 12_000, found: 11_950 },
            LogWarning::RowsIncomplete { path: path(), lacking: 12, rows: 720_000 },
            LogWarning::OffCodes { path: path(), column: column(), by: 1.234e-4, unit: "°/s", codes: 0.52 },
            LogWarning::Stopped { path: path(), column: column(), same: 2000, len: 720_000 },
            LogWarning::Hung { path: path(), column: column(), same: 2000, len: 72_000, from_s: 15.0 },
            LogWarning::TimesMended { path: path(), column: "t_us".to_owned(), how },
            LogWarning::TimesJitter { path: path(), how: beat.jitter_text().expect("much jitter") },
            LogWarning::RateChanges { path: path(), how: pace },
            LogWarning::LinesSkipped { path: path(), lines: 4, first },
            LogWarning::Resampled { path: path(), column: column(), how: resampled },
            LogWarning::Clipped { path: path(), column: column(), how: clipped },
            LogWarning::CoarseCodes { path: path(), column: column(), how: coarse },
            LogWarning::Implausible { path: path(), what: "gravity is 1.003 m/s²".to_owned() },
            LogWarning::UnitUnknown { path: path(), column: "gz".to_owned(), unit: "--unit", scale: "--scale" },
            LogWarning::ColumnsLeftOut { path: path(), names: names() },
            LogWarning::BlanksLeftOut { path: path(), names: names() },
            LogWarning::SeveralImus { path: path(), count: 6, kinds: "accelerometers", column: "--column" },
            LogWarning::Gaps { path: path(), missing: 1200, among: 720_000, are_closed: true },
            LogWarning::Gaps { path: path(), missing: 1200, among: 720_000, are_closed: false },
        ];
        for line in all.map(|warning| warning.coded()) {
            assert!(line.chars().count() <= 100, "{line}");
        }
    }
}
