//! What the page is told of calibrations: the guided one, and those on file.

use super::MethodName;
use serde::Serialize;
#[cfg(test)]
use ts_rs::TS;

/// The guided calibration.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
#[cfg_attr(test, derive(TS))]
pub enum Calibrating {
    /// None.
    Idle,
    /// Under way.
    Running(Running),
    /// It came to a result.
    Done(CalibrationResult),
    /// It must not become a calibration.
    Refused {
        /// By which method.
        method: MethodName,
        /// Why, and what to do.
        text: String,
    },
    /// It was ended without a result, and why.
    Aborted {
        /// By which method.
        method: MethodName,
        /// Why.
        text: String,
    },
}

/// A calibration under way.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Running {
    /// By which method.
    pub method: MethodName,
    /// All steps, in their order.
    pub steps: Vec<Step>,
    /// Since it began, s.
    pub elapsed_s: f64,
    /// Until it ends, s.
    pub left_s: f64,
    /// What to do now.
    pub advice: String,
    /// What would be refused if the step ended here.
    pub threats: Vec<String>,
    /// Temperature at the beginning and now, and the lowest and highest in between, °C.
    pub temps_c: Option<[f64; 4]>,
    /// By `warmup` and `cycle`: standard uncertainty of the correction by now, °/s.
    pub u_dps: Option<f64>,
    /// Whether `finish-calibration` may be asked for.
    pub can_finish: bool,
}

/// A step of a procedure.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct Step {
    /// What it is called.
    pub name: String,
    /// From its beginning, s.
    pub from_s: f64,
    /// To its end, s.
    pub to_s: f64,
}

/// What a calibration came to.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct CalibrationResult {
    /// By which method.
    pub method: MethodName,
    /// As it stands on file.
    pub entry: CalibrationEntry,
    /// Of each axis.
    pub axes: Vec<AxisResult>,
    /// What there is to say.
    pub warnings: Vec<String>,
}

/// What a calibration found of an axis.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct AxisResult {
    /// What it is called.
    pub name: String,
    /// °/s.
    pub pbc_dps: f64,
    /// Standard uncertainty, °/s.
    pub u_pbc_dps: f64,
    /// °/s/°C.
    pub btc_dps_per_c: f64,
    /// Standard uncertainty, °/s/°C.
    pub u_btc_dps_per_c: f64,
    /// °C.
    pub t3_c: f64,
    /// Over the temperatures seen.
    pub curve: Vec<CurvePoint>,
    /// Mean rate in the last minute before the end, °/s.
    pub before_dps: Option<f64>,
    /// The same corrected, °/s.
    pub after_dps: Option<f64>,
}

/// What is added to a rate at a temperature.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct CurvePoint {
    /// °C.
    pub temp_c: f64,
    /// °/s.
    pub correction_dps: f64,
    /// Standard uncertainty, °/s.
    pub u_dps: Option<f64>,
    /// What a perfect measurement would find, °/s: of the twin.
    pub truth_dps: Option<f64>,
}

/// A calibration on file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(test, derive(TS))]
pub struct CalibrationEntry {
    /// By its content.
    pub id: String,
    /// Of which part.
    pub serial: Option<String>,
    /// When, if that is stated.
    pub created: Option<String>,
    /// By which method, if that is stated.
    pub method: Option<String>,
    /// Of the first axis, °/s.
    pub pbc_dps: f64,
    /// Of the first axis, °/s/°C.
    pub btc_dps_per_c: f64,
    /// Of the first axis, °C.
    pub t3_c: f64,
    /// Where it holds, °C.
    pub range_c: Option<[f64; 2]>,
    /// Whether it is applied.
    pub applied: bool,
    /// Its file, which the page of a static site keeps.
    pub toml: String,
}
