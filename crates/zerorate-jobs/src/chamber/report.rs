//! The results of a measurement in a chamber.

use crate::calibrate::{CurvePoint, TruthReport};
use crate::warning::CodedWarning;
use adis16130_twin::Truth;
use serde::Serialize;
use zerorate::chamber::{Branches, ChamberOutcome, Record};
use zerorate::{Calibration, Correction, Uncertainty};

/// The JSON object of `chamber --json`. The field names must not change.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct ChamberReport {
    /// The results of a part with one axis. `None` for a part with several axes, whose results are in `axes`.
    #[serde(flatten)]
    pub only: Option<AxisReport>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub axes: Vec<AxisReport>,
    pub method: &'static str,
    pub plan: String,
    pub device: Option<String>,
    pub coverage: f64,
    pub coverage_factor: f64,
    pub samples: u64,
    pub lost_samples: u64,
    pub impossible_readings: u64,
    pub duration_s: f64,
    pub temp_min_c: f64,
    pub temp_max_c: f64,
    /// Share of the time in which the part was not at rest. That time is excluded from the results.
    pub restless: f64,
    pub calibration_id: String,
    /// True if the part was the twin, the simulated sensor.
    pub simulated: bool,
    pub capture_sha256: Option<String>,
    pub warnings: Vec<CodedWarning>,
    /// Standing remarks: consequences of the options alone, independent of the samples.
    pub remarks: Vec<CodedWarning>,
}

/// The results of an axis.
#[derive(Clone, Debug, Serialize)]
#[expect(missing_docs, reason = "the names and units are a contract; docs/formats states them")]
pub struct AxisReport {
    pub name: String,
    pub pbc_dps: f64,
    pub btc_dps_per_c: f64,
    pub btc2_dps_per_c2: f64,
    pub btc3_dps_per_c3: f64,
    pub t3_c: f64,
    pub u_pbc_dps: f64,
    pub u_btc_dps_per_c: f64,
    pub u_btc2_dps_per_c2: f64,
    pub u_btc3_dps_per_c3: f64,
    pub order: usize,
    pub order_weights: Vec<f64>,
    pub lag_s: f64,
    pub play_c: f64,
    pub bias_instability_dps: f64,
    pub rate_random_walk_dps_per_rt_s: f64,
    /// The correction at evenly spaced temperatures over the measured span.
    pub curve: Vec<CurvePoint>,
    pub points: Vec<Point>,
    #[serde(rename = "loop")]
    pub branches: Option<Loop>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthReport>,
}

/// The measurement at one soak temperature.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    pub step: usize,
    pub set_c: f64,
    pub start_s: f64,
    pub end_s: f64,
    pub temp_c: f64,
    pub rate_dps: f64,
    pub residual_dps: f64,
    pub drift_c_per_min: f64,
    pub settled: bool,
}

/// Hysteresis: the difference between warming and cooling.
#[derive(Clone, Debug, Serialize)]
pub struct Loop {
    pub half_width_dps: f64,
    pub u_dps: f64,
    pub temp_min_c: f64,
    pub temp_max_c: f64,
}

impl ChamberReport {
    pub(super) fn new(
        plan: &str,
        calibration: &Calibration,
        record: &Record,
        outcomes: &[ChamberOutcome],
        truths: &[Truth],
        (remarks, warnings): (Vec<CodedWarning>, Vec<CodedWarning>),
    ) -> Self {
        let (temp_min_c, temp_max_c) = record.span_c().unwrap_or_default();
        let axis = |(index, outcome): (usize, &ChamberOutcome)| {
            let name = calibration.axes.get(index).map_or(String::new(), |axis| axis.name.clone());
            AxisReport::new(name, index, record, outcome, truths.get(index))
        };
        let mut axes: Vec<AxisReport> = outcomes.iter().enumerate().map(axis).collect();
        let only = if axes.len() == 1 { axes.pop() } else { None };
        Self {
            only,
            axes,
            method: "chamber",
            plan: plan.to_owned(),
            device: calibration.device.clone(),
            coverage: Uncertainty::COVERAGE,
            coverage_factor: Uncertainty::FACTOR,
            samples: record.samples,
            lost_samples: record.lost,
            impossible_readings: record.impossible,
            duration_s: calibration.run.map_or(0.0, |run| run.duration_s),
            temp_min_c,
            temp_max_c,
            restless: record.restless(),
            calibration_id: calibration.id(),
            simulated: calibration.is_simulated(),
            capture_sha256: calibration.capture_sha256.clone(),
            warnings,
            remarks,
        }
    }

    /// The reports of all axes.
    pub fn all(&self) -> impl Iterator<Item = &AxisReport> {
        self.only.iter().chain(&self.axes)
    }
}

impl AxisReport {
    fn new(name: String, index: usize, record: &Record, outcome: &ChamberOutcome, truth: Option<&Truth>) -> Self {
        let curve = &outcome.curve;
        let Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 } = curve.correction;
        let (low_c, high_c) = record.span_c().unwrap_or_default();
        let point = |temp_c| {
            let correction_dps = curve.correction.at(temp_c);
            CurvePoint { temp_c, correction_dps, u_dps: Some(curve.u_dps(temp_c)) }
        };
        let u = |term: usize| curve.covariance[term][term].max(0.0).sqrt();
        Self {
            name,
            pbc_dps,
            btc_dps_per_c,
            btc2_dps_per_c2,
            btc3_dps_per_c3,
            t3_c,
            u_pbc_dps: curve.u_dps(t3_c),
            u_btc_dps_per_c: u(1),
            u_btc2_dps_per_c2: u(2),
            u_btc3_dps_per_c3: u(3),
            order: curve.order,
            order_weights: curve.order_weights.to_vec(),
            lag_s: curve.following.lag_s,
            play_c: curve.following.play_c,
            bias_instability_dps: curve.noise.bias_instability_dps,
            rate_random_walk_dps_per_rt_s: curve.noise.rate_random_walk_dps_per_rt_s,
            curve: CurvePoint::temps_c(low_c, high_c).map(point).collect(),
            points: points(index, record, outcome),
            branches: outcome.branches.map(Loop::from),
            truth: truth.map(|truth| TruthReport::new(truth, t3_c, (low_c, high_c))),
        }
    }
}

fn points(axis: usize, record: &Record, outcome: &ChamberOutcome) -> Vec<Point> {
    let point = |(soak, residual_dps): (&zerorate::chamber::Soak, &f64)| Point {
        step: soak.step + 1,
        set_c: soak.set_c,
        start_s: soak.start_s,
        end_s: soak.end_s,
        temp_c: soak.temp_c,
        rate_dps: soak.rates_dps.get(axis).copied().unwrap_or(f64::NAN),
        residual_dps: *residual_dps,
        drift_c_per_min: soak.drift_c_per_min,
        settled: soak.settled,
    };
    record.soaks.iter().zip(&outcome.soak_residuals_dps).map(point).collect()
}

impl From<Branches> for Loop {
    fn from(branches: Branches) -> Self {
        let Branches { half_width_dps, u_dps, span_c: (temp_min_c, temp_max_c) } = branches;
        Self { half_width_dps, u_dps, temp_min_c, temp_max_c }
    }
}
