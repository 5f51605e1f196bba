//! The bias over temperature of any gyroscope or accelerometer, from one log or several, without knowledge of the
//! sensor.
//!
//! value = bias(T) + flicker + random walk + white noise. The bias is a Chebyshev series of order 6 in the
//! temperature that it follows (`follow.rs`). Its coefficients are normal and shrink with their order. The
//! strength of the noises, the size and the shrinkage of the series, lag and play are not known beforehand. Each
//! combination is a model that weighs by its marginal likelihood (`evidence.rs`), and the result is the mean over
//! all of them (`search.rs`). Half of the prior probability is on a bias without lag, unless other axes show a lag
//! (`lag.rs`). Steps and outliers are found in the whitened record and removed (`disturbances.rs`).

mod conditions;
mod disturbances;
mod evidence;
mod lag;
mod left_out;
mod means;
mod search;
mod series;
#[cfg(test)]
mod tests;
mod thermometer;
mod warning;

use super::follow::LagAndPlay;
use super::{TERMS, ThermalError, gls};
use crate::noise::NoiseModel;
use crate::temperature::sweeps;
use alloc::vec::Vec;
use conditions::Conditions;
use evidence::{Model, Record};
pub use lag::LagLikelihood;
pub use means::{LogMeans, MeansBuilder};
use series::Series;
pub use thermometer::Thermometer;
pub use warning::{CurveRefusal, CurveWarning, check};

/// Number of coefficients of the series, from the constant one to order 6.
pub const COEFFICIENTS: usize = 7;

/// Smallest temperature span that gives a curve, °C.
pub const LEAST_SPAN_C: f64 = 5.0;

/// Largest share of the blocks of a log that may be left out because the sensor moves. Above it there is no curve.
pub const MOST_MOTION: f64 = 0.3;

/// The bias of one axis over temperature. Values without a stated unit are in the unit of the samples.
#[derive(Clone, Debug, PartialEq)]
pub struct LogCurve {
    series: Series,
    /// Coefficients of the series, the constant first.
    coefficients: [f64; COEFFICIENTS],
    covariance: [[f64; COEFFICIENTS]; COEFFICIENTS],
    /// The lag and the play of the bias behind the temperature of the sensor, as the mean over all models.
    pub following: LagAndPlay,
    /// Lag of the thermometer behind the sensor, s, which is taken out of its readings.
    pub thermometer_late_s: f64,
    /// The longest lag that is tried, s, if no lag was taken: a lag near it would fit best, or a draught may cause it.
    pub long_lag_s: Option<f64>,
    /// The lag that explains the logs as well as a draught that only the thermometer feels, s. No lag was taken then,
    /// and the uncertainty covers both.
    pub lag_or_draught_s: Option<f64>,
    /// Posterior probability that the bias lags.
    pub late_probability: f64,
    /// Whether the sensor was probably on before the logs began. False for logs that state it or that warm and cool.
    pub was_on: bool,
    /// Largest standard uncertainty of the bias if the sensor was on before the logs began and its bias lags.
    /// `None` if the probability of that is at most 1 %.
    pub u_if_on_before: Option<f64>,
    /// Half of the difference of the bias between warming and cooling, in the middle of the temperatures. `None` if
    /// the logs have one direction only.
    pub hysteresis: Option<f64>,
    /// Standard deviation of the bias from one log to the next. `None` with one log.
    pub spread_of_starts: Option<f64>,
    /// Standard uncertainty by rounding to codes. It is zero if the noise averages the rounding out.
    pub rounding: f64,
    /// The noise: white as measured, B and K as geometric means over all models.
    pub noise: NoiseModel,
    /// Steps of the level that were removed.
    pub steps: Vec<CurveStep>,
    /// Number of blocks that were left out as outliers.
    pub glitches: usize,
    /// Log evidence of the best model, with its prior, less that of a bias that does not depend on the temperature.
    pub log_odds: f64,
    /// Change of the bias that was still to come at the end of the last log, because the bias lags.
    pub unsettled: f64,
    /// Cross-validation: the span of the means without the removed steps, before and after the correction by a model
    /// that comes from the other parts of the record.
    pub span: BeforeAfter,
}

/// A polynomial of order 3 in place of the curve: the bias is the sum of `terms[k]` · (T − `about_c`)ᵏ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic {
    /// The temperature that the polynomial refers to, °C.
    pub about_c: f64,
    /// The terms, the constant first.
    pub terms: [f64; TERMS],
    /// Covariance of the terms.
    pub covariance: [[f64; TERMS]; TERMS],
    /// Largest difference from the curve.
    pub left: f64,
}

impl Cubic {
    /// The bias at the temperature `temp_c`, °C, in the unit of the samples.
    #[must_use]
    pub fn at(&self, temp_c: f64) -> f64 {
        self.terms.iter().rev().fold(0.0, |sum, term| sum * (temp_c - self.about_c) + term)
    }
}

/// A step of the level that was removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveStep {
    /// Index of the log.
    pub log: usize,
    /// Time in that log, s.
    pub at_s: f64,
    /// The level after the step less the level before it.
    pub size: f64,
}

/// The span of the means before and after the correction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BeforeAfter {
    /// Largest less smallest mean, without a correction.
    pub before: f64,
    /// Largest less smallest mean, with the correction.
    pub after: f64,
}

impl LogCurve {
    /// Lowest and highest temperature of the logs, °C.
    #[must_use]
    pub fn span_c(&self) -> (f64, f64) {
        self.series.span_c()
    }

    /// The bias at the temperature `temp_c`, °C, in the unit of the samples.
    #[must_use]
    pub fn at(&self, temp_c: f64) -> f64 {
        gls::dot(&self.series.at(temp_c), &self.coefficients)
    }

    /// Standard uncertainty of the bias at the temperature `temp_c`, °C, in the unit of the bias. It includes
    /// hysteresis, the spread from log to log, and rounding to codes.
    #[must_use]
    pub fn u_at(&self, temp_c: f64) -> f64 {
        libm::sqrt(self.variance(&self.series.at(temp_c)) + self.level_variance())
    }

    /// Variance of the level by hysteresis (uniform between both directions), by the spread from log to log and by
    /// rounding.
    fn level_variance(&self) -> f64 {
        let [hysteresis, spread] = [self.hysteresis, self.spread_of_starts].map(|value| value.unwrap_or(0.0));
        hysteresis * hysteresis / 3.0 + spread * spread + self.rounding * self.rounding
    }

    /// Standard uncertainty of the change of the bias from `from_c` to `to_c` (°C), in the unit of the bias. It
    /// includes hysteresis and rounding to codes, but not the spread from log to log.
    #[must_use]
    pub fn u_change(&self, from_c: f64, to_c: f64) -> f64 {
        let (from, to) = (self.series.at(from_c), self.series.at(to_c));
        let hysteresis = self.hysteresis.unwrap_or(0.0);
        let variance = self.variance(&core::array::from_fn(|k| to[k] - from[k]));
        libm::sqrt(variance + hysteresis * hysteresis / 3.0 + 2.0 * self.rounding * self.rounding)
    }

    /// Lag of the bias behind the readings of the thermometer, s. It is negative if the thermometer lags more.
    #[must_use]
    pub fn lag_s(&self) -> f64 {
        self.following.lag_s - self.thermometer_late_s
    }

    /// Slope of the bias at a temperature, per °C.
    #[must_use]
    pub fn slope_at(&self, temp_c: f64) -> f64 {
        gls::dot(&self.series.slope_at(temp_c), &self.coefficients)
    }

    /// Standard uncertainty of [`LogCurve::slope_at`].
    #[must_use]
    pub fn u_slope_at(&self, temp_c: f64) -> f64 {
        libm::sqrt(self.variance(&self.series.slope_at(temp_c)))
    }

    fn variance(&self, weights: &[f64; COEFFICIENTS]) -> f64 {
        let row = |row: &[f64; COEFFICIENTS]| gls::dot(row, weights);
        let variance: f64 = self.covariance.iter().zip(weights).map(|(of, weight)| weight * row(of)).sum();
        variance.max(0.0)
    }

    /// Returns the polynomial of order 3 about a temperature that fits the curve best, by least squares over its span.
    /// Its covariance includes hysteresis, the spread from log to log, rounding to codes, and the difference from the
    /// curve.
    #[must_use]
    pub fn cubic(&self, about_c: f64) -> Cubic {
        let half_c = (self.span_c().1 - self.span_c().0) / 2.0;
        let points = self.even_temps_c(POINTS);
        let power = |term: usize, temp_c: &f64| libm::pow((temp_c - about_c) / half_c, term as f64);
        let columns: Vec<Vec<f64>> =
            (0..TERMS).map(|term| points.iter().map(|temp_c| power(term, temp_c)).collect()).collect();
        // the terms are linear in the coefficients
        let terms_of = |k: usize| {
            let values: Vec<f64> = points.iter().map(|temp_c| self.series.at(*temp_c)[k]).collect();
            let fit = gls::Fit::new(&columns, &values).map_or_else(|| alloc::vec![0.0; TERMS], |fit| fit.coefficients);
            core::array::from_fn::<f64, TERMS, _>(|term| fit[term] / libm::pow(half_c, term as f64))
        };
        let by_coefficient: [[f64; TERMS]; COEFFICIENTS] = core::array::from_fn(terms_of);
        let weights = |term: usize| -> [f64; COEFFICIENTS] { core::array::from_fn(|k| by_coefficient[k][term]) };
        let terms = core::array::from_fn(|term| gls::dot(&weights(term), &self.coefficients));
        let mut cubic = Cubic { about_c, terms, covariance: [[0.0; TERMS]; TERMS], left: 0.0 };
        let left = points.iter().map(|temp_c| (self.at(*temp_c) - cubic.at(*temp_c)).abs());
        cubic.left = left.fold(0.0, f64::max);
        let product = |i: usize, j: usize| {
            let row = |row: &[f64; COEFFICIENTS]| gls::dot(row, &weights(j));
            self.covariance.iter().zip(weights(i)).map(|(of, weight)| weight * row(of)).sum::<f64>()
        };
        cubic.covariance = core::array::from_fn(|i| core::array::from_fn(|j| product(i, j)));
        cubic.covariance[0][0] += self.level_variance() + cubic.left * cubic.left / 3.0;
        cubic
    }

    /// Returns `count` temperatures, at least two, that are spaced evenly over the span, °C.
    #[must_use]
    pub fn even_temps_c(&self, count: usize) -> Vec<f64> {
        let (low_c, high_c) = self.span_c();
        (0..count).map(|k| low_c + (high_c - low_c) * k as f64 / (count - 1) as f64).collect()
    }
}

/// Number of temperatures over the span at which a curve is evaluated.
const POINTS: usize = 81;

/// Smallest number of blocks for a curve.
const FEWEST: usize = 40;

/// The logs of one axis of one unit, without their outliers, and with their steps found.
pub struct AxisRecord {
    record: Record,
    /// The logs with a lag, and the lag, s, if `record` has a draught at the thermometer in its place.
    with_lag: Option<(Record, f64)>,
    glitches: usize,
    lag: LagLikelihood,
}

impl AxisRecord {
    /// Prepares the logs of one axis.
    ///
    /// # Errors
    /// Returns an error if there are too few blocks, or no model can explain them.
    pub fn new(logs: Vec<LogMeans>) -> Result<Self, ThermalError> {
        let blocks: usize = logs.iter().map(|log| log.blocks().len()).sum();
        if blocks < FEWEST {
            return Err(ThermalError::TooFew { blocks, needed: FEWEST });
        }
        let found = Conditions::of(&logs).ok_or(ThermalError::Degenerate)?;
        let Conditions { mut record, model, with_lag } = found;
        let (glitches, best) = disturbances::take_out(&mut record, model);
        let lag = search::lag_likelihood(&record, &best);
        let with_lag = with_lag.map(|(other, lag_s)| (other.without_disturbances_of(&record), lag_s));
        Ok(Self { record, with_lag, glitches, lag })
    }

    /// The means of the logs, without their outliers.
    #[must_use]
    pub fn logs(&self) -> &[LogMeans] {
        &self.record.logs
    }

    /// The likelihood of the lag, for the other axes of the sensor.
    #[must_use]
    pub fn lag(&self) -> &LagLikelihood {
        &self.lag
    }

    /// Finds the bias over temperature. `others` are the lag likelihoods of the other axes of the sensor.
    ///
    /// # Errors
    /// Returns an error if no model can explain the record.
    pub fn curve(&self, others: &[&LagLikelihood]) -> Result<LogCurve, ThermalError> {
        let Self { record, glitches, .. } = self;
        let models = models(record, others);
        let best = models.iter().max_by(|one, other| one.weight.total_cmp(&other.weight));
        let best = best.ok_or(ThermalError::Degenerate)?;
        let curve = average(record, &models, best, *glitches, left_out::span(record, best));
        Ok(match &self.with_lag {
            Some((with_lag, lag_s)) => curve.or_with_lag(&self::models(with_lag, others), *lag_s),
            None => curve,
        })
    }
}

/// All models of a record that may matter, with their weights.
fn models(record: &Record, others: &[&LagLikelihood]) -> Vec<Model> {
    let mut models: Vec<Model> = record.starts().iter().flat_map(|start| search::all(start, others)).collect();
    search::weigh(&mut models);
    models
}

/// Share of the difference to the curve with a lag that counts as a standard uncertainty where a draught at the
/// thermometer explains the logs nearly as well. The band of 95 % then holds the curves of both.
const OF_LAG: f64 = 0.515;

impl LogCurve {
    /// This curve, with the difference to the models with a lag, which explain the logs as well, in its uncertainty.
    fn or_with_lag(self, models: &[Model], lag_s: f64) -> Self {
        let late = |k: usize| mean(models, &|model| model.coefficients[k]);
        let apart: [f64; COEFFICIENTS] = core::array::from_fn(|k| OF_LAG * (late(k) - self.coefficients[k]));
        let product = |i: usize, j: usize| self.covariance[i][j] + apart[i] * apart[j];
        let covariance = core::array::from_fn(|i| core::array::from_fn(|j| product(i, j)));
        Self { covariance, lag_or_draught_s: Some(lag_s), ..self }
    }
}

/// Whether one log covers more than the share [`SHARED`] of all temperatures while the sensor warms, and the same or
/// another log does while it cools.
fn has_two_directions(logs: &[LogMeans]) -> bool {
    let temps = logs.iter().flat_map(|log| log.blocks().iter().map(|block| block.temp_c));
    let (low_c, high_c) = temps.fold((f64::MAX, f64::MIN), |(low, high): (f64, f64), c| (low.min(c), high.max(c)));
    let covered = logs.iter().map(|log| sweeps::covered_c(log.blocks().iter().map(|block| block.temp_c)));
    let (rises_c, falls_c) = covered.fold((0.0, 0.0), |(up, down): (f64, f64), (r, f)| (up.max(r), down.max(f)));
    rises_c.min(falls_c) > SHARED * (high_c - low_c)
}

/// Share of the temperature span of which a log must cover more in a direction for this direction to count.
const SHARED: f64 = 0.25;

fn mean(models: &[Model], of: &dyn Fn(&Model) -> f64) -> f64 {
    models.iter().map(|model| model.weight * of(model)).sum()
}

/// Covariance of the coefficients over all models, about given coefficients.
fn covariance(models: &[Model], about: &[f64; COEFFICIENTS]) -> [[f64; COEFFICIENTS]; COEFFICIENTS] {
    core::array::from_fn(|i| {
        core::array::from_fn(|j| {
            let off = |model: &Model, k: usize| model.coefficients[k] - about[k];
            mean(models, &|model| model.covariance[i][j] + off(model, i) * off(model, j))
        })
    })
}

/// Probability above which the uncertainty is stated for a sensor that was on before the logs began and lags.
const POSSIBLE: f64 = 0.01;

/// Largest standard uncertainty of a curve if the sensor was on before the logs began and lags.
fn u_if_on_before(models: &[Model], curve: &LogCurve) -> Option<f64> {
    let is_behind = |model: &&Model| model.was_on && model.following.lag_s > 0.0;
    let mut on: Vec<Model> = models.iter().filter(is_behind).cloned().collect();
    let total: f64 = on.iter().map(|model| model.weight).sum();
    on.iter_mut().for_each(|model| model.weight /= total);
    let of_on = LogCurve { covariance: covariance(&on, &curve.coefficients), ..curve.clone() };
    let u = curve.even_temps_c(POINTS).into_iter().map(|temp_c| of_on.u_at(temp_c));
    (total > POSSIBLE).then(|| u.fold(0.0, f64::max))
}

fn average(record: &Record, models: &[Model], best: &Model, glitches: usize, span: BeforeAfter) -> LogCurve {
    let mean = |of: &dyn Fn(&Model) -> f64| mean(models, of);
    let coefficients: [f64; COEFFICIENTS] = core::array::from_fn(|k| mean(&|model| model.coefficients[k]));
    let covariance = covariance(models, &coefficients);
    let geometric = |of: &dyn Fn(&Model) -> f64| libm::exp(mean(&|model| libm::log(of(model).max(f64::MIN_POSITIVE))));
    let following =
        LagAndPlay { lag_s: mean(&|model| model.following.lag_s), play_c: mean(&|model| model.following.play_c) };
    let curve = LogCurve {
        series: record.series,
        coefficients,
        covariance,
        following,
        lag_or_draught_s: None,
        long_lag_s: record.without_lag.then(|| search::longest_lag_s(&record.logs)),
        thermometer_late_s: record.logs.first().map_or(0.0, |log| log.thermometer().late_s),
        late_probability: mean(&|model| f64::from(u8::from(model.following.lag_s > 0.0))),
        hysteresis: None,
        spread_of_starts: (record.logs.len() > 1).then(|| mean(&|model| model.shape.starts)),
        rounding: record.logs.iter().map(|log| log.rounding).fold(0.0, f64::max),
        noise: NoiseModel {
            white_dps_per_rt_hz: record.white(),
            bias_instability_dps: geometric(&|model| model.noise[0]),
            rate_random_walk_dps_per_rt_s: geometric(&|model| model.noise[1]),
        },
        was_on: mean(&|model| f64::from(u8::from(model.was_on))) > 0.5,
        u_if_on_before: None,
        steps: record.steps_of(best),
        glitches,
        log_odds: best.log_odds,
        unsettled: 0.0,
        span,
    };
    let (low_c, high_c) = curve.span_c();
    let middle_c = (low_c + high_c) / 2.0;
    let by_play = curve.slope_at(middle_c).abs() * following.play_c;
    let hysteresis = record.two_directions.then(|| by_play + mean(&|model| model.direction).abs());
    let unsettled = record.unsettled(&following, |temp_c| curve.at(temp_c));
    let curve = LogCurve { hysteresis, unsettled, ..curve };
    LogCurve { u_if_on_before: u_if_on_before(models, &curve), ..curve }
}
