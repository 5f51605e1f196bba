//! The messages between the page and its reader of logs: `docs/formats/page.md`. Part of `web/src/protocol.ts`.

use crate::message::Download;
use serde::{Deserialize, Serialize};
#[cfg(feature = "types")]
use ts_rs::TS;
use zerorate_imu::{AxisReport, Kind};

/// The user's statements about a log. The rest is taken from the log itself.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
#[cfg_attr(feature = "types", derive(TS))]
#[cfg_attr(feature = "types", ts(optional_fields))]
pub struct LogSettings {
    /// The columns, by name or by number counted from 0; none: all axes.
    pub columns: Option<Vec<String>>,
    /// The topic of a bag with several IMUs.
    pub topic: Option<String>,
    /// The rows to read, as `SensorId=1` or `bus=0,sensor=1`: those in which the columns have these values.
    #[serde(rename = "where")]
    pub only: Option<String>,
    /// Samples per second, Hz.
    pub rate_hz: Option<f64>,
    /// The column with the times.
    pub time_column: Option<String>,
    /// `s`, `ms`, `us` or `ns`.
    pub time_unit: Option<String>,
    /// The column with the temperature, °C; none: one with a usual name.
    pub temp_column: Option<String>,
    /// Leaves out what is before this time: `45m` after the first sample, or a clock time.
    pub skip: Option<String>,
    /// Leaves out what follows this time.
    pub until: Option<String>,
    /// Unit of gyroscopes: `dps`, `rad/s` …
    pub gyro_unit: Option<String>,
    /// The value of one step, in that unit.
    pub gyro_scale: Option<f64>,
    /// Unit of accelerometers: `m/s²`, `g`, `mg` …
    pub accel_unit: Option<String>,
    /// The value of one step, in that unit.
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
    /// The log does not say enough about itself: ask the user, and look again with the answer.
    Question {
        /// What is missing, and why.
        text: String,
        /// A table to choose from: the head, then the rows.
        choices: Vec<String>,
        /// The settings, any of which answers the question.
        settings: Vec<LogSetting>,
    },
    /// The log cannot be read.
    Refused {
        /// What is wrong, and what to do.
        text: String,
    },
}

/// The content of a log.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogAbout {
    /// The format of the file: `Parquet`, `text, packed by gzip`.
    pub form: String,
    /// Number of samples of a column, including missing ones.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub samples: u64,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// Duration, s.
    pub duration_s: f64,
    /// The topic of a bag.
    pub topic: Option<String>,
    /// The columns that will be analysed, gyroscopes first.
    pub columns: Vec<LogColumn>,
    /// Warnings about the log.
    pub warnings: Vec<String>,
}

/// A column of a log.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogColumn {
    /// The name, or the number of a column without one.
    pub name: String,
    /// The quantity; none: neither of them, and no file for a filter can take the column.
    pub kind: Option<Kind>,
    /// The unit of the results; none: the unit of the column, which nobody stated.
    pub unit: Option<String>,
    /// Number of missing samples.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub missing: u64,
}

/// The results of a column.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogAxis {
    /// Deviations and noise model, as `zerorate imu --json` has them.
    pub axis: AxisReport,
    /// The terms of the noise model in words, the coefficients first.
    pub terms: Vec<LogTerm>,
}

/// A term of a noise model in words.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogTerm {
    /// Its name.
    pub name: String,
    /// The same value with its 95 % interval in each unit, or several values.
    pub values: Vec<String>,
    /// Whether the record tells it from zero.
    pub identified: bool,
    /// What is to be said beside it; it may be empty.
    pub remark: String,
}

/// The summary of all axes, after the last one.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogSummary {
    /// The pictures of each kind of axis: curves, spectra and records.
    pub pictures: Vec<LogPicture>,
    /// Warnings about several axes at once.
    pub warnings: Vec<String>,
    /// Why no file for a filter can be made, if so.
    pub no_noise_file: Option<String>,
}

/// The bias over temperature of a log whose temperature changes.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogBias {
    /// The curves in words, as `zerorate tempcal` prints them.
    pub text: String,
    /// The means, the curve and its band, for each kind of axis.
    pub pictures: Vec<LogPicture>,
    /// Warnings about the curves.
    pub warnings: Vec<String>,
    /// The files that can be made: a report, a table, a calibration, parameters of flight controllers.
    pub files: Vec<Download>,
    /// Why other files cannot be made.
    pub no_files: Vec<String>,
    /// Why there are no curves, if so; all else is empty then.
    pub why_not: Option<String>,
}

/// A picture.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct LogPicture {
    /// The name of its file: `gyroscope-allan.svg`.
    pub name: String,
    /// The title.
    pub title: String,
    /// The picture as SVG.
    pub svg: String,
}

/// A request for the file with the noise parameters of a filter.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct NoiseFileCommand {
    /// The filter: `kalibr`, `openvins`, `vins`, `orbslam3`, `kf-gins` or `ros`.
    pub format: String,
    /// The value of all axes of a kind, if the filter takes one number: `worst` or `mean`.
    pub combine: String,
    /// Factor on all noise, above 0; 1: as measured.
    pub inflate: f64,
    /// Also make it from rejected models; the file says so.
    pub accept_rejected: bool,
}
