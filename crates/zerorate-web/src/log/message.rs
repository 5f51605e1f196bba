//! The messages between the page and its reader of logs: `docs/formats/page.md`. Part of `web/src/protocol.ts`.

use crate::message::Download;
use serde::{Deserialize, Serialize};
#[cfg(feature = "types")]
use ts_rs::TS;
use zerorate_imu::{AxisReport, Kind};

/// The user's statements about a log. All else is taken from the log itself.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "types", derive(TS), ts(optional_fields))]
pub struct LogSettings {
    /// The columns, by name or by number counted from 0; null: all axes, or all columns of a log without axes.
    pub columns: Option<Vec<String>>,
    /// The topic or message to read, if a log has several IMUs.
    pub topic: Option<String>,
    /// The condition for rows to read, such as `SensorId=1` or `bus=0,sensor=1`; null: all rows.
    #[serde(rename = "where")]
    pub only: Option<String>,
    /// Sample rate, Hz; null: as the log states.
    pub rate_hz: Option<f64>,
    /// The column with the timestamps.
    pub time_column: Option<String>,
    /// The unit of the timestamps: `s`, `ms`, `us` or `ns`.
    pub time_unit: Option<String>,
    /// The column with the temperature, °C; null: a column with a usual name.
    pub temp_column: Option<String>,
    /// The start of the analysis: a duration such as `45m` after the first sample, or a time of day.
    pub skip: Option<String>,
    /// The end of the analysis, in the form of `skip`.
    pub until: Option<String>,
    /// Unit of the gyroscopes: `dps`, `rad/s` …
    pub gyro_unit: Option<String>,
    /// The value of one digit (LSB) of the gyroscopes, in `gyro_unit`.
    pub gyro_scale: Option<f64>,
    /// Unit of the accelerometers: `m/s²`, `g`, `mg` …
    pub accel_unit: Option<String>,
    /// The value of one digit (LSB) of the accelerometers, in `accel_unit`.
    pub accel_scale: Option<f64>,
    /// The decimal mark: `point` or `comma`.
    pub decimal: Option<String>,
}

/// A field of [`LogSettings`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(feature = "types", derive(TS))]
#[expect(missing_docs, reason = "those of `LogSettings`")]
pub enum LogSetting {
    Columns,
    Topic,
    Where,
    RateHz,
    TimeColumn,
    TimeUnit,
    TempColumn,
    Skip,
    Until,
    GyroUnit,
    GyroScale,
    AccelUnit,
    AccelScale,
    Decimal,
}

/// The result of opening a log.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum LogInspection {
    /// The log was read and can be analysed.
    Log(LogAbout),
    /// The log does not describe itself sufficiently. Ask the user, then open it again with the answer.
    Question {
        /// The question: what is missing, and why.
        text: String,
        /// A table to choose from: the head, then the rows.
        choices: Vec<String>,
        /// The settings that the text mentions: alternatives, or answers to its two questions.
        settings: Vec<LogSetting>,
    },
    /// The log cannot be read.
    Refused {
        /// The fault of the log, and the remedy.
        text: String,
    },
}

/// The facts about a log that was opened.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogAbout {
    /// The format of the file: `Parquet`, `text, packed by gzip`.
    pub form: String,
    /// Number of samples of the first column, including missing ones.
    pub samples: u64,
    /// Sample rate of the first column, Hz.
    pub rate_hz: f64,
    /// Duration of the first column, s.
    pub duration_s: f64,
    /// The topic that was read, if the log is a bag.
    pub topic: Option<String>,
    /// The columns that will be analysed: the axes, gyroscopes first, or all columns of a log without axes.
    pub columns: Vec<LogColumn>,
    /// Warnings about the log.
    pub warnings: Vec<String>,
}

/// A column that will be analysed.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogColumn {
    /// The name, or the number if the column has no name.
    pub name: String,
    /// The kind of sensor; null: neither a gyroscope nor an accelerometer, so the column is in no file for a filter.
    pub kind: Option<Kind>,
    /// The unit of the results; null: unknown, so the results are in the column's own unit.
    pub unit: Option<String>,
    /// Number of missing samples.
    pub missing: u64,
}

/// The results for a column.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogAxis {
    /// Deviations and noise model, as in `zerorate imu --json`.
    pub axis: AxisReport,
    /// The terms of the noise model in words, the coefficients first.
    pub terms: Vec<LogTerm>,
}

/// A term of a noise model in words.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogTerm {
    /// The name of the coefficient or other term.
    pub name: String,
    /// The value with its 95 % interval in each unit, or the values of a term that has several, such as σ and
    /// correlation time. If a value is not identified, its upper limit only.
    pub values: Vec<String>,
    /// True if the value differs significantly from zero.
    pub identified: bool,
    /// A remark beside the values; may be empty.
    pub remark: String,
}

/// The summary of all axes, sent after the last axis.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogSummary {
    /// The plots for each kind of axis: deviations, and spectra and records if all its axes have them.
    pub pictures: Vec<LogPicture>,
    /// Warnings about several axes at once.
    pub warnings: Vec<String>,
    /// The reason why no file for a filter can be made; null if a file can be made.
    pub no_noise_file: Option<String>,
}

/// The bias over temperature of a log in which the temperature changes.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogBias {
    /// The curves as text, as `zerorate tempcal` prints them.
    pub text: String,
    /// The plots for each kind of axis: the means, the curve and its band.
    pub pictures: Vec<LogPicture>,
    /// Warnings about the curves.
    pub warnings: Vec<String>,
    /// The files: a report, a table, a calibration, parameters of flight controllers.
    pub files: Vec<Download>,
    /// The reasons why other files cannot be made.
    pub no_files: Vec<String>,
    /// The reason why there are no curves; null if there are curves. With a reason, all other fields are empty.
    pub why_not: Option<String>,
}

/// A plot as a file.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogPicture {
    /// The file name: `gyroscope-allan.svg`.
    pub name: String,
    /// The title above the plot.
    pub title: String,
    /// The plot as SVG.
    pub svg: String,
}

/// A request for a file with the noise parameters for a filter.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct NoiseFileCommand {
    /// The filter: `kalibr`, `openvins`, `vins`, `orbslam3`, `kf-gins` or `ros`.
    pub format: String,
    /// The rule that combines the axes of a kind, if the filter takes one number for all: `worst` or `mean`.
    pub combine: String,
    /// Factor on all noise, above 0; 1 means as measured.
    pub inflate: f64,
    /// True to make the file from rejected models too. The file then says so.
    pub accept_rejected: bool,
}
