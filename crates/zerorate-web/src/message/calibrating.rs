//! Messages about calibrations: the guided one, and those on file.

use super::MethodName;
use serde::Serialize;
#[cfg(feature = "types")]
use ts_rs::TS;

/// The guided calibration.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum Calibrating {
    /// There is none.
    Idle,
    /// It is running.
    Running(Running),
    /// It has a result.
    Done(CalibrationResult),
    /// It was refused.
    Refused {
        /// The method.
        method: MethodName,
        /// Why, and what to do.
        text: String,
    },
    /// It was ended without a result.
    Aborted {
        /// The method.
        method: MethodName,
        /// Why.
        text: String,
    },
}

/// A running calibration.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Running {
    /// The method.
    pub method: MethodName,
    /// All steps, in their order.
    pub steps: Vec<Step>,
    /// Time since the start, s.
    pub elapsed_s: f64,
    /// Time until the end, s.
    pub left_s: f64,
    /// The advice of what to do now.
    pub advice: String,
    /// Refusals that would follow if the step ended now.
    pub pending_refusals: Vec<String>,
    /// Temperature at the start and now, and the lowest and highest in between, °C.
    pub temps_c: Option<[f64; 4]>,
    /// The uncertainties if it had ended at the last look. Only `warmup` and `cycle` have them, unless refused.
    pub forecast: Option<Forecast>,
    /// Whether `finish-calibration` is possible now.
    pub can_finish: bool,
    /// Whether the goal is met: nothing would be refused, and the temperature of a warm-up has settled.
    pub is_enough: bool,
}

/// The uncertainties that a calibration would have stated if it had ended at a time.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Forecast {
    /// The time since the start, s.
    pub at_s: f64,
    /// Standard uncertainty of PBC, °/s.
    pub u_pbc_dps: f64,
    /// Standard uncertainty of BTC, °/s/°C.
    pub u_btc_dps_per_c: f64,
}

/// A step of a procedure.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Step {
    /// The name.
    pub name: String,
    /// Start of the step, s.
    pub from_s: f64,
    /// End of the step, s.
    pub to_s: f64,
}

/// The result of a calibration.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CalibrationResult {
    /// The method.
    pub method: MethodName,
    /// The calibration as it is on file.
    pub entry: CalibrationEntry,
    /// The results of each axis.
    pub axes: Vec<AxisResult>,
    /// Warnings about the result.
    pub warnings: Vec<String>,
    /// What every measurement by the same plan implies.
    pub remarks: Vec<String>,
}

/// The result of a calibration for an axis.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AxisResult {
    /// The name of the axis.
    pub name: String,
    /// PBC, °/s.
    pub pbc_dps: f64,
    /// Standard uncertainty of PBC, °/s.
    pub u_pbc_dps: f64,
    /// BTC, °/s/°C.
    pub btc_dps_per_c: f64,
    /// Standard uncertainty of BTC, °/s/°C.
    pub u_btc_dps_per_c: f64,
    /// T3, °C.
    pub t3_c: f64,
    /// The correction over the temperatures that occurred.
    pub curve: Vec<CurvePoint>,
    /// Mean rate in the last minute before the end, °/s.
    pub before_dps: Option<f64>,
    /// The same mean, corrected, °/s.
    pub after_dps: Option<f64>,
}

/// The correction at a temperature.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CurvePoint {
    /// Temperature, °C.
    pub temp_c: f64,
    /// The correction that is added to the rate, °/s.
    pub correction_dps: f64,
    /// Standard uncertainty, °/s.
    pub u_dps: Option<f64>,
    /// The result of a perfect measurement, °/s; only the twin knows it.
    pub truth_dps: Option<f64>,
}

/// A calibration on file.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CalibrationEntry {
    /// The id, made from the content.
    pub id: String,
    /// Serial number of the part, if it is stated.
    pub serial: Option<String>,
    /// The date of the measurement, if it is stated.
    pub created: Option<String>,
    /// The method, if it is stated.
    pub method: Option<String>,
    /// PBC of the first axis, °/s.
    pub pbc_dps: f64,
    /// BTC of the first axis, °/s/°C.
    pub btc_dps_per_c: f64,
    /// T3 of the first axis, °C.
    pub t3_c: f64,
    /// The range of temperatures in which it holds, °C.
    pub range_c: Option<[f64; 2]>,
    /// Whether it is applied.
    pub applied: bool,
    /// The text of its file, which the page of a static site keeps.
    pub toml: String,
}
