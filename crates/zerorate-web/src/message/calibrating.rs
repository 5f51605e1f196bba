//! Messages about calibrations: the guided one, and the stored ones.

use super::MethodName;
use serde::Serialize;
#[cfg(feature = "types")]
use ts_rs::TS;

/// The state of the guided calibration.
#[derive(Clone, Debug, Serialize)]
#[serde(tag = "is", rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(TS))]
pub enum Calibrating {
    /// No calibration was started, or its result was dismissed.
    Idle,
    /// A calibration is running.
    Running(Running),
    /// The calibration is complete.
    Done(CalibrationResult),
    /// The calibration was refused.
    Refused {
        /// The method of the calibration.
        method: MethodName,
        /// The reason, and what to do.
        text: String,
    },
    /// The calibration ended without a result.
    Aborted {
        /// The method of the calibration.
        method: MethodName,
        /// The reason why it ended.
        text: String,
    },
}

/// The progress of a running calibration.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Running {
    /// The procedure that runs.
    pub method: MethodName,
    /// All steps in order.
    pub steps: Vec<Step>,
    /// Time since the start of the calibration, s.
    pub elapsed_s: f64,
    /// Remaining time of the calibration, s.
    pub left_s: f64,
    /// The instruction for the user at this moment.
    pub advice: String,
    /// The refusals that would result if the step ended now.
    pub pending_refusals: Vec<String>,
    /// Temperatures, °C: at the start, now, the lowest and the highest; null if none was read yet.
    pub temps_c: Option<[f64; 4]>,
    /// The uncertainties that an end at the last check would have given. Null before the first check, if the
    /// calibration would be refused, and for methods other than `warmup` and `cycle`.
    pub forecast: Option<Forecast>,
    /// True if `finish-calibration` is allowed now.
    pub can_finish: bool,
    /// True if `warmup` or `cycle` has enough samples: nothing would be refused, and a `warmup` has settled.
    pub is_enough: bool,
}

/// The uncertainties that a calibration would have had if it had ended at a certain time.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct Forecast {
    /// The assumed end, s after the start of the calibration.
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
    /// The name that the page shows.
    pub name: String,
    /// Start of the step, s after the start of the calibration.
    pub from_s: f64,
    /// End of the step, s after the start of the calibration.
    pub to_s: f64,
}

/// The result of a calibration.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CalibrationResult {
    /// The procedure that was run.
    pub method: MethodName,
    /// The calibration as stored.
    pub entry: CalibrationEntry,
    /// The results of each axis.
    pub axes: Vec<AxisResult>,
    /// Warnings about the result.
    pub warnings: Vec<String>,
    /// Remarks that follow from the plan of the calibration, not from the measured values.
    pub remarks: Vec<String>,
}

/// The result of a calibration for one axis.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AxisResult {
    /// The name of the axis.
    pub name: String,
    /// PBC: the correction at the temperature T3, °/s.
    pub pbc_dps: f64,
    /// Standard uncertainty of PBC, °/s.
    pub u_pbc_dps: f64,
    /// BTC: the change of the correction with the temperature, °/s/°C.
    pub btc_dps_per_c: f64,
    /// Standard uncertainty of BTC, °/s/°C.
    pub u_btc_dps_per_c: f64,
    /// T3: the temperature at which the correction is PBC, °C.
    pub t3_c: f64,
    /// The correction over the temperatures that were measured.
    pub curve: Vec<CurvePoint>,
    /// Uncorrected mean rate over the last minute of the calibration, °/s; null if unknown.
    pub before_dps: Option<f64>,
    /// Corrected mean rate over the last minute of the calibration, °/s; null if unknown.
    pub after_dps: Option<f64>,
}

/// A correction at one temperature.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CurvePoint {
    /// Temperature, °C.
    pub temp_c: f64,
    /// The correction, which is added to the rate, °/s.
    pub correction_dps: f64,
    /// Standard uncertainty of the correction, °/s; null if unknown.
    pub u_dps: Option<f64>,
    /// The result of a perfect measurement, °/s; null unless the part is the twin itself, not a recording.
    pub truth_dps: Option<f64>,
}

/// A stored calibration.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CalibrationEntry {
    /// The id, computed from the content.
    pub id: String,
    /// Serial number of the part; null if not stated.
    pub serial: Option<String>,
    /// The date of the measurement; null if not stated.
    pub created: Option<String>,
    /// The method; null if not stated.
    pub method: Option<String>,
    /// PBC of the first axis, °/s.
    pub pbc_dps: f64,
    /// BTC of the first axis, °/s/°C.
    pub btc_dps_per_c: f64,
    /// T3 of the first axis, °C.
    pub t3_c: f64,
    /// Lowest and highest valid temperature, °C; null if not stated.
    pub range_c: Option<[f64; 2]>,
    /// True if the calibration is applied to the readings.
    pub applied: bool,
    /// The text of the calibration file. A page without a server stores it.
    pub toml: String,
}
