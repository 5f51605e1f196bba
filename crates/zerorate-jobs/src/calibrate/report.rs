//! The result of a calibration: what `calibrate --json` prints, and what Python's `Calibrated` holds.

use crate::warning::{CodedWarning, JobWarning};
use adis16130_twin::Truth;
use serde::Serialize;
use std::path::PathBuf;
use zerorate::calibration::{CalibratedAxis, Contribution, Run};
use zerorate::temperature::{BiasCurve, Step, TERMS};
use zerorate::{Calibration, Outcome, SettingNames, Uncertainty, Warning};

/// The JSON object of `calibrate --json`. The field names must not change.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct CalibrationReport {
    /// The results of a part with one axis. `None` for a part with several axes, whose results are in `axes`.
    #[serde(flatten)]
    pub only: Option<AxisNumbers>,
    pub coverage: f64,
    pub coverage_factor: f64,
    pub rdy_hz: f64,
    pub rate_hz: f64,
    pub samples: u64,
    pub lost_samples: u64,
    pub duration_s: f64,
    pub temp_min_c: f64,
    pub temp_max_c: f64,
    pub method: Option<String>,
    pub part: String,
    pub serial: Option<String>,
    pub device: Option<String>,
    /// Time of recording, RFC 3339, or `SIMULATED` for a simulated part; `None` if unknown.
    pub created: Option<String>,
    pub calibration_id: String,
    /// True if the part was the twin, the simulated sensor.
    pub simulated: bool,
    /// The file of the calibration; `None` if none was to be saved, or if it or the log could not be written.
    pub file: Option<PathBuf>,
    pub capture_sha256: Option<String>,
    /// Warnings about all axes.
    pub warnings: Vec<CodedWarning>,
    /// Standing remarks about all axes: consequences of the plan alone, independent of the samples.
    pub remarks: Vec<CodedWarning>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<AxisReport>,
    /// The calibration, if a requested file could not be written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rescued: Option<RescuedCalibration>,
}

/// The results of an axis of a part with several axes.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct AxisReport {
    pub name: String,
    #[serde(flatten)]
    pub numbers: AxisNumbers,
    /// Warnings about this axis only.
    pub warnings: Vec<CodedWarning>,
    /// Standing remarks about this axis only.
    pub remarks: Vec<CodedWarning>,
}

/// The correction of one axis, its uncertainties, and the means behind it.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct AxisNumbers {
    /// B1, T1, B2 and T2 are the averages of steps 4 and 6 of AN-1042; `None` with another method.
    pub b1_dps: Option<f64>,
    pub t1_c: Option<f64>,
    pub b2_dps: Option<f64>,
    pub t2_c: Option<f64>,
    pub btc_dps_per_c: f64,
    pub pbc_dps: f64,
    pub t3_c: f64,
    /// The terms above first order, if a curve was fitted. Otherwise `None`, and the JSON lacks these fields.
    #[serde(flatten)]
    pub higher: Option<CurveTerms>,
    pub u_pbc_dps: f64,
    pub u_btc_dps_per_c: f64,
    pub u_t3_c: f64,
    pub cov_pbc_btc_dps2_per_c: f64,
    /// The uncertainty budget: each contribution to the uncertainties.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub budget: Vec<Contribution>,
    pub impossible_readings: u64,
    /// The correction at [`POINTS`] evenly spaced temperatures over the measured span.
    pub curve: Vec<CurvePoint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthReport>,
}

/// The terms of second and third order of a fitted curve, and the lag, play, noise, steps and base motion that were
/// estimated with them.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct CurveTerms {
    pub order: usize,
    pub order_weights: [f64; TERMS],
    pub btc2_dps_per_c2: f64,
    pub btc3_dps_per_c3: f64,
    pub lag_s: f64,
    pub play_c: f64,
    pub bias_instability_dps: f64,
    pub rate_random_walk_dps_per_rt_s: f64,
    pub steps: Vec<StepReport>,
    /// Posterior probability that the base under the part moved slowly during the recording.
    pub sway_probability: f64,
}

/// A step of the bias level that was removed from the data.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct StepReport {
    pub at_s: f64,
    pub size_dps: f64,
    pub u_dps: f64,
}

/// The correction at one temperature.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct CurvePoint {
    pub temp_c: f64,
    pub correction_dps: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub u_dps: Option<f64>,
}

/// The truth of the twin: the values that a perfect measurement would find at the reported T3.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct TruthReport {
    pub pbc_dps: f64,
    pub btc_dps_per_c: f64,
    pub curve: Vec<CurvePoint>,
}

/// Number of points of a reported curve.
pub const POINTS: u8 = 9;

impl CurvePoint {
    /// [`POINTS`] evenly spaced temperatures from `low_c` to `high_c`, both included, °C.
    pub fn temps_c(low_c: f64, high_c: f64) -> impl Iterator<Item = f64> {
        (0..POINTS).map(move |k| low_c + (high_c - low_c) * f64::from(k) / f64::from(POINTS - 1))
    }
}

impl TruthReport {
    /// The true values at `t3_c`, and the true curve from `low_c` to `high_c`.
    pub fn new(truth: &Truth, t3_c: f64, (low_c, high_c): (f64, f64)) -> Self {
        let point = |temp_c| CurvePoint { temp_c, correction_dps: truth.pbc_dps(temp_c), u_dps: None };
        Self {
            pbc_dps: truth.pbc_dps(t3_c),
            btc_dps_per_c: truth.btc_dps_per_c(t3_c),
            curve: CurvePoint::temps_c(low_c, high_c).map(point).collect(),
        }
    }
}

/// A calibration that could not be written to its requested file.
#[derive(Clone, Debug, Serialize)]
pub struct RescuedCalibration {
    /// The rescue file that holds the calibration; `None` if no folder could be written.
    pub file: Option<PathBuf>,
    /// The text of the calibration file.
    pub calibration: String,
}

impl AxisNumbers {
    fn new(outcome: &Outcome, axis: &CalibratedAxis, truth: Option<&Truth>) -> Self {
        let t3_c = outcome.correction.t3_c;
        let (low_c, high_c) = (outcome.temp_min_c, outcome.temp_max_c);
        let point = |temp_c| CurvePoint {
            temp_c,
            correction_dps: outcome.correction.at(temp_c),
            u_dps: axis.u_correction_dps(temp_c),
        };
        Self {
            b1_dps: outcome.means.map(|means| means.b1_dps),
            t1_c: outcome.means.map(|means| means.t1_c),
            b2_dps: outcome.means.map(|means| means.b2_dps),
            t2_c: outcome.means.map(|means| means.t2_c),
            higher: outcome.curve.as_ref().map(CurveTerms::new),
            curve: CurvePoint::temps_c(low_c, high_c).map(point).collect(),
            btc_dps_per_c: outcome.correction.btc_dps_per_c,
            pbc_dps: outcome.correction.pbc_dps,
            t3_c,
            u_pbc_dps: outcome.uncertainty.u_pbc_dps,
            u_btc_dps_per_c: outcome.uncertainty.u_btc_dps_per_c,
            u_t3_c: outcome.uncertainty.u_t3_c,
            cov_pbc_btc_dps2_per_c: outcome.uncertainty.cov_pbc_btc,
            budget: axis.budget(),
            impossible_readings: outcome.impossible_readings,
            truth: truth.map(|truth| TruthReport::new(truth, t3_c, (low_c, high_c))),
        }
    }
}

impl CurveTerms {
    fn new(curve: &BiasCurve) -> Self {
        let step = |step: Step| StepReport { at_s: step.at_s, size_dps: step.size_dps, u_dps: step.u_dps };
        Self {
            order: curve.order,
            order_weights: curve.order_weights.map(|weight| (1e4 * weight).round() / 1e4),
            btc2_dps_per_c2: curve.correction.btc2_dps_per_c2,
            btc3_dps_per_c3: curve.correction.btc3_dps_per_c3,
            lag_s: curve.following.lag_s,
            play_c: curve.following.play_c,
            bias_instability_dps: curve.noise.bias_instability_dps,
            rate_random_walk_dps_per_rt_s: curve.noise.rate_random_walk_dps_per_rt_s,
            steps: curve.steps.into_iter().flatten().map(step).collect(),
            sway_probability: (1e4 * curve.sources.base_motion_probability).round() / 1e4,
        }
    }
}

impl CalibrationReport {
    /// Reports all axes in the order of the calibration. `truths` are the twin's true states at the end of step 8 or
    /// of the recording. They are empty for a real part and for a replay.
    pub fn new(outcomes: &[Outcome], calibration: &Calibration, truths: &[Truth], names: SettingNames) -> Self {
        let common: Vec<&Warning> = Outcome::shared_warnings(outcomes).collect();
        let coded = |warnings: &mut dyn Iterator<Item = &Warning>| JobWarning::remarks_apart(warnings.copied(), names);
        let mut axes: Vec<AxisReport> = Vec::new();
        for (index, (outcome, axis)) in outcomes.iter().zip(&calibration.axes).enumerate() {
            let (remarks, warnings) = coded(&mut outcome.warnings.iter().filter(|warning| !common.contains(warning)));
            axes.push(AxisReport {
                name: axis.name.clone(),
                numbers: AxisNumbers::new(outcome, axis, truths.get(index)),
                warnings,
                remarks,
            });
        }
        let only = if axes.len() == 1 { axes.pop().map(|axis| axis.numbers) } else { None };
        let (remarks, warnings) = coded(&mut common.into_iter());
        let (run, span) = (calibration.run, calibration.validity);
        let of_run = |number: fn(&Run) -> f64| run.as_ref().map_or(f64::NAN, number);
        Self {
            only,
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            rdy_hz: of_run(|run| run.rdy_hz),
            rate_hz: of_run(|run| run.rate_hz),
            samples: run.map_or(0, |run| run.samples),
            lost_samples: run.map_or(0, |run| run.lost_samples),
            duration_s: of_run(|run| run.duration_s),
            temp_min_c: span.map_or(f64::NAN, |span| span.temp_min_c),
            temp_max_c: span.map_or(f64::NAN, |span| span.temp_max_c),
            method: calibration.method.clone(),
            part: calibration.part.clone(),
            serial: calibration.serial.clone(),
            created: calibration.created.clone(),
            device: calibration.device.clone(),
            calibration_id: calibration.id(),
            simulated: calibration.is_simulated(),
            file: None,
            capture_sha256: calibration.capture_sha256.clone(),
            warnings,
            remarks,
            axes,
            rescued: None,
        }
    }
}
