//! The report of a column: every number, interval, verdict and warning that a front end shows, as plain data.

mod advice;
mod fit;
mod imu;

pub use fit::{CoefficientReport, FitReport, UnitReport};
pub use imu::{AxisReport, ImuReport, LineReport, MotionReport, SheetReport};

use crate::Record;
use serde::Serialize;
#[cfg(feature = "types")]
use ts_rs::TS;
use zerorate_allan::{self as allan, DetrendedRate, Stat, Unavailable};
use zerorate_logs::Quantity;

/// The deviations of a column and its noise model. Scripts read it as the JSON of `zerorate allan --json`.
///
/// Deviations are in [`unit`](Self::unit). Each coefficient of the model states its unit.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AllanReport {
    /// The path of the log, or `pool` for the common model of several records.
    pub file: String,
    /// The name of the column.
    pub column: String,
    /// Samples per second, Hz.
    pub rate_hz: f64,
    /// Number of samples from the first to the last, including missing ones.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub samples: u64,
    /// Number of missing samples.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub missing: u64,
    /// The estimator of the deviations.
    #[cfg_attr(feature = "types", ts(type = "string"))]
    pub stat: Stat,
    /// The unit of the deviations; `None` if the unit of the column is unknown.
    pub unit: Option<&'static str>,
    /// The probability that an interval contains the true deviation.
    pub confidence: f64,
    /// The deviation at each averaging time.
    pub points: Vec<PointReport>,
    /// The averaging times without a deviation.
    pub unavailable: Vec<UnavailableReport>,
    /// The noise model; `None` if none was requested.
    pub fit: Option<FitReport>,
    /// The reason why there is no noise model, if one was requested.
    pub fit_error: Option<String>,
    /// The reason why the coefficients are not a result, if a model was requested: the model is missing or rejected.
    pub rejection: Option<String>,
    /// The glitches and steps that were removed before the fit.
    pub cleaned: CleanedReport,
    /// The averaging times that the model advises, a sentence each.
    pub advice: Vec<String>,
    /// The polynomial over temperature that was removed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub detrend: Option<DetrendReport>,
    /// The time left out at the beginning, s.
    #[serde(skip_serializing_if = "is_zero")]
    pub skipped_s: f64,
    /// The warnings, each `code: text`, those about the log first.
    pub warnings: Vec<String>,
}

fn is_zero(seconds: &f64) -> bool {
    *seconds == 0.0
}

/// A deviation, with the model at the same averaging time.
#[derive(Clone, Copy, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct PointReport {
    /// Averaging time, s.
    pub tau_s: f64,
    /// Samples in an average.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub m: u64,
    /// The deviation, in the unit of the report.
    pub dev: f64,
    /// Lower end of the deviation's interval.
    pub lo: f64,
    /// Upper end of the deviation's interval.
    pub hi: f64,
    /// Equivalent degrees of freedom.
    pub edf: f64,
    /// Exponent α of the noise S(f) ∝ f^α that dominates.
    pub alpha: i32,
    /// Number of terms in the mean square.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub n: u64,
    /// The name of the dominating noise; `None` if the record is too short to tell.
    pub noise: Option<&'static str>,
    /// The deviation that the model predicts for this record.
    pub model: Option<f64>,
    /// Lower end of the band in which the model expects 95 % of the deviations of this record.
    pub model_lo: Option<f64>,
    /// Upper end of the band around `model`.
    pub model_hi: Option<f64>,
    /// The predicted deviation of another record of this sensor, for averages up to 1/128 of the record.
    pub predicted: Option<f64>,
    /// Lower end of the band in which 95 % of the deviations of other records lie.
    pub predicted_lo: Option<f64>,
    /// Upper end of the band around `predicted`.
    pub predicted_hi: Option<f64>,
}

/// An averaging time without a deviation.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct UnavailableReport {
    /// The averaging time, s.
    pub tau_s: f64,
    /// The reason why there is no deviation.
    pub reason: String,
}

/// The glitches and steps that were removed from a record before the fit.
#[derive(Clone, Debug, Default, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct CleanedReport {
    /// Number of glitches whose samples were replaced.
    #[cfg_attr(feature = "types", ts(type = "number"))]
    pub glitches: u64,
    /// Steps of the level that were removed.
    #[cfg_attr(feature = "types", ts(type = "{ at_s: number, size: number }[]"))]
    pub steps: Vec<allan::Step>,
}

/// A polynomial over temperature that was removed from a record.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct DetrendReport {
    /// The variable: `temperature`.
    pub over: &'static str,
    /// The order of the polynomial.
    pub order: usize,
    /// The method of the fit: [`DetrendReport::METHOD`].
    pub method: &'static str,
    /// The unit of the rate; `None` if it is unknown.
    pub unit: Option<&'static str>,
    /// Coefficients from the first power on: unit of the rate per °C, °C², °C³, about `mean_c`.
    pub coefficients: Vec<f64>,
    /// Mean temperature, °C.
    pub mean_c: f64,
    /// Share of the variance of the slow rate that the polynomial explains.
    pub explained: f64,
    /// Degrees of freedom that the polynomial takes besides the mean.
    pub lost_dof: usize,
    /// Share of the variance of a random walk that remains.
    pub walk_kept: f64,
}

impl AllanReport {
    /// The label that tells this column from others: the log, and the column.
    #[must_use]
    pub fn label(&self) -> String {
        format!("{}, column {}", self.file, self.column)
    }

    /// The noise model; `None` if none was fitted.
    #[must_use]
    pub fn model(&self) -> Option<&FitReport> {
        self.fit.as_ref().filter(|fit| fit.model_error.is_some())
    }

    /// The model, if its coefficients are a result.
    #[must_use]
    pub fn valid_model(&self) -> Option<&FitReport> {
        self.model().filter(|fit| !fit.rejected)
    }

    /// Reports on a column.
    #[must_use]
    pub fn new(record: &Record) -> Self {
        let analysis = &record.analysis;
        let unavailable =
            |&Unavailable { tau_s, reason }: &Unavailable| UnavailableReport { tau_s, reason: reason.to_string() };
        let asked = record.fit.as_ref();
        let rate_unit = record.quantity.map(Quantity::unit);
        Self {
            file: record.file.display().to_string(),
            column: record.column.clone(),
            rate_hz: analysis.rate_hz,
            samples: analysis.samples,
            missing: analysis.missing,
            stat: analysis.stat,
            unit: record.deviation_unit(),
            confidence: record.confidence,
            points: analysis.points.iter().map(|point| PointReport::new(record, point)).collect(),
            unavailable: analysis.unavailable.iter().map(unavailable).collect(),
            fit: asked.map(|_| FitReport::new(record.model(), record.quantity)),
            fit_error: asked.and_then(|fit| fit.as_ref().err()).map(ToString::to_string),
            rejection: asked.and_then(|_| record.valid_model().err()).map(|why| why.to_string()),
            cleaned: record.model().map(|fit| CleanedReport::new(&fit.cleaned)).unwrap_or_default(),
            advice: advice::advice(record),
            detrend: record.detrended.as_ref().map(|taken| DetrendReport::new(taken, rate_unit)),
            skipped_s: record.skipped_s,
            warnings: record.warnings(),
        }
    }
}

impl PointReport {
    fn new(record: &Record, point: &allan::Point) -> Self {
        let &allan::Point { tau_s, m, dev, lo, hi, edf, alpha, n } = point;
        let is_told = record.analysis.samples as f64 >= TELLING * m as f64;
        let (model, predicted) = (record.expected(point), record.predicted(point));
        Self {
            tau_s,
            m,
            dev,
            lo,
            hi,
            edf,
            alpha,
            n,
            noise: is_told.then(|| noise(alpha, record.quantity)),
            model: model.map(|band| band.dev),
            model_lo: model.map(|band| band.lo),
            model_hi: model.map(|band| band.hi),
            predicted: predicted.map(|band| band.dev),
            predicted_lo: predicted.map(|band| band.lo),
            predicted_hi: predicted.map(|band| band.hi),
        }
    }
}

/// Least number of averages in the record for a named noise. The exponent is found to about 2/√averages and rounded to
/// a whole number. With 62 averages, this number is right in 19 of 20 records.
const TELLING: f64 = 62.0;

/// The usual name of the noise whose spectral density has the exponent α.
fn noise(alpha: i32, quantity: Option<Quantity>) -> &'static str {
    match alpha {
        2 if quantity == Some(Quantity::Acceleration) => "white velocity",
        1 if quantity == Some(Quantity::Acceleration) => "flicker velocity",
        0 if quantity == Some(Quantity::Acceleration) => "velocity random walk",
        -2 if quantity == Some(Quantity::Acceleration) => "acceleration random walk",
        2 => "white angle",
        1 => "flicker angle",
        0 => "angle random walk",
        -1 => "bias instability",
        -2 => "rate random walk",
        _ => "ramp or drift",
    }
}

impl CleanedReport {
    /// Reports on the glitches and steps that were removed.
    #[must_use]
    pub fn new(cleaned: &allan::Cleaning) -> Self {
        Self { glitches: cleaned.glitches, steps: cleaned.steps.clone() }
    }
}

impl DetrendReport {
    /// The method of the fit.
    pub const METHOD: &str = "least squares over means of at most 128 parts";

    /// Reports on a polynomial over temperature that was removed from a rate of this unit.
    #[must_use]
    pub fn new(detrended: &DetrendedRate, unit: Option<&'static str>) -> Self {
        Self {
            over: "temperature",
            order: detrended.lost_dof,
            method: Self::METHOD,
            unit,
            coefficients: detrended.coefficients.clone(),
            mean_c: detrended.mean_c,
            explained: detrended.explained,
            lost_dof: detrended.lost_dof,
            walk_kept: detrended.walk_kept(),
        }
    }
}

impl Record {
    /// The unit of the deviations; `None` if the unit of the column is unknown.
    #[must_use]
    pub fn deviation_unit(&self) -> Option<&'static str> {
        let quantity = self.quantity?;
        if !self.analysis.stat.is_times_s() {
            return Some(quantity.unit());
        }
        Some(match quantity {
            Quantity::AngularRate => "°",
            Quantity::Acceleration => "m/s",
            Quantity::Temperature => "°C·s",
        })
    }
}
