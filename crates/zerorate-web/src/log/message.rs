//! What the page and its reader of logs say to each other: `docs/formats/page.md`. Part of `web/src/protocol.ts`.

use serde::{Deserialize, Serialize};
#[cfg(test)]
use ts_rs::TS;

/// What a log may not say of itself, as the user says; what is left out is as the log says.
#[derive(Clone, Debug, Default, Deserialize)]
#[serde(default)]
#[cfg_attr(test, derive(TS))]
#[cfg_attr(test, ts(optional_fields))]
pub struct LogSettings {
    /// The columns, by name or by number counted from 0; none: all that are axes.
    pub columns: Option<Vec<String>>,
    /// The topic of a bag with several IMUs.
    pub topic: Option<String>,
    /// Samples per second, Hz.
    pub rate_hz: Option<f64>,
    /// The column with the times.
    pub time_column: Option<String>,
    /// `s`, `ms`, `us` or `ns`.
    pub time_unit: Option<String>,
    /// Of gyroscopes: `dps`, `rad/s` …
    pub gyro_unit: Option<String>,
    /// What a step of 1 is, in that unit.
    pub gyro_scale: Option<f64>,
    /// Of accelerometers: `m/s²`, `g`, `mg` …
    pub accel_unit: Option<String>,
    /// What a step of 1 is, in that unit.
    pub accel_scale: Option<f64>,
    /// What stands before the decimals: `point` or `comma`.
    pub decimal: Option<String>,
}

/// A field of [`LogSettings`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(test, derive(TS))]
#[expect(missing_docs, reason = "those of `LogSettings`")]
pub enum LogSetting {
    Columns,
    Topic,
    RateHz,
    TimeColumn,
    TimeUnit,
    GyroUnit,
    GyroScale,
    AccelUnit,
    AccelScale,
    Decimal,
}

/// What a look into a log gives.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
pub enum Looked {
    /// It was read, and can be analysed.
    Log(LogAbout),
    /// It does not say enough of itself: ask, and look again with what is answered.
    Question {
        /// What is missing, and why.
        text: String,
        /// A table to choose from: the head, then a row each.
        choices: Vec<String>,
        /// Any of these answers it.
        settings: Vec<LogSetting>,
    },
    /// It cannot be read: what is wrong, and what to do.
    Refused {
        /// In words.
        text: String,
    },
}

/// What is in a log.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogAbout {
    /// What kind of file it is: `Parquet`, `text, packed by gzip`.
    pub form: String,
    /// Samples of a column, those that are missing included.
    #[cfg_attr(test, ts(type = "number"))]
    pub samples: u64,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// How long it is, s.
    pub duration_s: f64,
    /// The topic of a bag.
    pub topic: Option<String>,
    /// What will be analysed, gyroscopes first.
    pub columns: Vec<LogColumn>,
    /// What there is to say of it.
    pub warnings: Vec<String>,
}

/// What an axis is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
#[expect(missing_docs, reason = "the names say it")]
pub enum AxisKind {
    Gyroscope,
    Accelerometer,
}

/// A column of a log.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogColumn {
    /// What it is called, or its number.
    pub name: String,
    /// None: neither, and no file for a filter can have it.
    pub kind: Option<AxisKind>,
    /// The unit of its results; none: its own, which nobody stated.
    pub unit: Option<String>,
    /// Samples that are missing.
    #[cfg_attr(test, ts(type = "number"))]
    pub missing: u64,
}

/// What was found in a column.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogAxis {
    /// The column.
    pub column: LogColumn,
    /// Overlapping Allan deviation at octaves, in the unit of the column.
    pub points: Vec<LogPoint>,
    /// N, B, K and what else the noise model has.
    pub coefficients: Vec<LogCoefficient>,
    /// Other terms of the model, in words.
    pub terms: Vec<String>,
    /// By how much the model may be off, as a share; none: there is no model.
    pub model_error: Option<f64>,
    /// Why the coefficients are no result, if they are none.
    pub doubt: Option<String>,
    /// What there is to say: `code: text`.
    pub warnings: Vec<String>,
}

/// A point of an Allan deviation, in the unit of its column.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogPoint {
    /// s.
    pub tau_s: f64,
    /// The deviation.
    pub dev: f64,
    /// One sigma, lower.
    pub lo: f64,
    /// One sigma, upper.
    pub hi: f64,
    /// What the model expects.
    pub model: Option<f64>,
}

/// A coefficient of a noise model.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogCoefficient {
    /// `N`, `B`, `K`, `Q` or `R`, as IEEE Std 952 has them.
    pub symbol: String,
    /// Its name.
    pub name: String,
    /// In each of its units, the usual one first.
    pub values: Vec<LogValue>,
    /// Whether to believe it; if not, only `hi` says something.
    pub identified: bool,
    /// What is to be said of one that is not identified.
    pub remark: String,
}

/// A number with its 95 % interval.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogValue {
    /// The number.
    pub value: f64,
    /// Lower end.
    pub lo: f64,
    /// Upper end.
    pub hi: f64,
    /// Of all three.
    pub unit: String,
}

/// What all axes come to, after the last.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogSummary {
    /// The curves of each kind, spectra and records.
    pub pictures: Vec<LogPicture>,
    /// What there is to say of several axes at once.
    pub warnings: Vec<String>,
    /// Why no file for a filter can be had, if so.
    pub no_noise_file: Option<String>,
}

/// A picture.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct LogPicture {
    /// What it is called as a file: `gyroscope-allan.svg`.
    pub name: String,
    /// What it shows.
    pub title: String,
    /// SVG.
    pub svg: String,
}

/// A file for the filter that takes the noise.
#[derive(Clone, Debug, Deserialize)]
#[cfg_attr(test, derive(TS))]
pub struct NoiseFileCommand {
    /// Who reads it: `kalibr`, `openvins`, `vins`, `orbslam3`, `kf-gins` or `ros`.
    pub format: String,
    /// What stands for all axes of a kind where the reader takes one number: `worst` or `mean`.
    pub combine: String,
    /// Factor on all noise, above 0; 1: as measured.
    pub inflate: f64,
    /// Also make it from rejected models; the file says so.
    pub accept_rejected: bool,
}
