//! One model of the logs: its coefficients, and how well it explains the means.

use super::means::slope_per_c;
use super::series::Series;
use super::{COEFFICIENTS, CurveStep, LogMeans, has_two_directions};
use crate::temperature::filter::Filter;
use crate::temperature::follow::LagAndPlay;
use crate::temperature::{Block, Noise, gls};
use alloc::vec;
use alloc::vec::Vec;
use zerorate_allan::linear::Cholesky;

/// The logs of one axis, and the assumptions that all models of them share.
pub(super) struct Record {
    pub(super) logs: Vec<LogMeans>,
    pub(super) series: Series,
    /// Largest mean less smallest mean.
    pub(super) scale: f64,
    pub(super) two_directions: bool,
    /// Steps of the level that are in every model.
    pub(super) steps: Vec<StepAt>,
    /// Mean of all means. The models describe the deviations from it.
    centre: f64,
    /// Slope of a line through all means, which turns noise of the temperature into noise of the means.
    slope_per_c: f64,
    /// Whether the sensor is assumed to have been on before the logs began, for logs that do not state it.
    was_on: bool,
    /// Logarithm of the prior probability of `was_on`.
    log_start: f64,
    /// Whether no lag is tried, because the best one stands for another effect: a draught, or one of long duration.
    pub(super) without_lag: bool,
    /// Half of the share of the temperature span over which the bias passes from one branch of the hysteresis to the
    /// other after the temperature has reversed.
    pub(super) turns: f64,
}

/// The log of a step, and the time in it at which the level changes, s.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct StepAt {
    pub(super) log: usize,
    pub(super) at_s: f64,
}

/// The means of a log, followed by the columns of its model.
pub(super) type Columns = Vec<Vec<f64>>;

/// Bias instability B and rate random walk K, in the unit of the samples, and in this unit per √s.
pub(super) type SlowNoise = [f64; 2];

/// Prior standard deviations of the coefficients.
#[derive(Clone, Copy, Debug)]
pub(super) struct PriorSpreads {
    /// Standard deviation of the first order of the series.
    size: f64,
    /// Ratio of the standard deviation of each order to that of the order before.
    shrink: f64,
    /// Standard deviation of the offset that changes sign with the direction of the temperature (hysteresis).
    direction: f64,
    /// Standard deviation of the offset of each log.
    pub(super) starts: f64,
    /// Whether a sensor that lags may begin out of balance with its thermometer.
    is_unsettled: bool,
}

#[derive(Clone, Debug)]
pub(super) struct Model {
    /// Posterior probability.
    pub(super) weight: f64,
    /// Logarithm of the product of evidence and prior probability.
    pub(super) log_score: f64,
    /// `log_score` less the log evidence of a bias that does not depend on the temperature.
    pub(super) log_odds: f64,
    pub(super) noise: SlowNoise,
    pub(super) following: LagAndPlay,
    pub(super) was_on: bool,
    pub(super) shape: PriorSpreads,
    /// All coefficients: those of the series, the hysteresis offset (with two directions), the offset of each log
    /// (with several logs), the transient of each log, and the size of each step.
    pub(super) all: Vec<f64>,
    pub(super) coefficients: [f64; COEFFICIENTS],
    pub(super) covariance: [[f64; COEFFICIENTS]; COEFFICIENTS],
    pub(super) direction: f64,
}

/// Sums of products of all whitened columns, the means first.
pub(super) struct Products {
    gram: Vec<Vec<f64>>,
    log_determinant: f64,
}

/// Values that are tried for the prior standard deviation of the first order, as ratios of the scale.
const SIZES: [f64; 3] = [0.3, 1.0, 3.0];
/// Values that are tried for the ratio of the prior standard deviation of each order to that of the order before.
const SHRINKS: [f64; 2] = [0.15, 0.35];
/// Values that are tried for the prior standard deviation of the hysteresis offset, as ratios of the scale.
const DIRECTIONS: [f64; 3] = [0.0, 0.01, 0.1];
/// Values that are tried for the prior standard deviation of the logs' offsets, as ratios of the scale.
const STARTS: [f64; 9] = [1e-3, 2e-3, 5e-3, 1e-2, 2e-2, 5e-2, 1e-1, 0.3, 1.0];
/// Prior probability that a sensor that lags begins out of balance with its thermometer.
const UNSETTLED: f64 = 0.02;
/// Prior probability that the sensor was on before the log began, if nothing says so.
const WAS_ON: f64 = 0.1;
/// Lag above which the prior probability falls, s, for a sensor that was on before the log. The start of the log does
/// not show the lag then, and in still air the rest of the log shows little of the lag.
const USUAL_LAG_S: f64 = 80.0;
/// If a sensor lags and was on before the log, the bias is behind its steady value at the start. The difference is
/// uncertain by this share of the expected difference (1 σ of the prior).
const BEHIND: f64 = 0.3;
/// Prior standard deviation of the level, as a ratio of the scale.
const LEVEL: f64 = 10.0;
/// Values of [`Record::turns`] that are tried, the usual one first.
pub(super) const TURNS: [f64; 5] = [0.05, 0.02, 0.1, 0.2, 0.3];
/// Least white noise of a mean, as a ratio of the scale.
const LEAST_WHITE: f64 = 1e-6;

impl Record {
    pub(super) fn new(logs: Vec<LogMeans>) -> Self {
        let blocks = || logs.iter().flat_map(LogMeans::blocks);
        let series = Series::over(blocks().map(|block| block.temp_c));
        let ends = |(low, high): (f64, f64), block: &Block| (low.min(block.rate_dps), high.max(block.rate_dps));
        let (low, high) = blocks().fold((f64::MAX, f64::MIN), ends);
        let centre = blocks().map(|block| block.rate_dps).sum::<f64>() / blocks().count().max(1) as f64;
        let scale = (high - low).max(f64::MIN_POSITIVE);
        let two_directions = has_two_directions(&logs);
        let slope_per_c = slope_per_c(blocks());
        Self {
            logs,
            series,
            scale,
            two_directions,
            steps: Vec::new(),
            centre,
            slope_per_c,
            was_on: false,
            log_start: 0.0,
            without_lag: false,
            turns: TURNS[0],
        }
    }

    /// Returns the record for each possible start: the sensor was switched on with the logs, or was on before. There
    /// is only one record if the start is known. The same is true if the temperature rises and falls, because the lag
    /// then shows without the start.
    pub(super) fn starts(&self) -> Vec<Self> {
        let either = !self.two_directions && self.logs.iter().any(LogMeans::may_have_been_on);
        let starts = if either { &[false, true][..] } else { &[false] };
        let with = |was_on: &bool| Self {
            logs: self.logs.clone(),
            steps: self.steps.clone(),
            was_on: *was_on,
            log_start: match (either, was_on) {
                (true, true) => libm::log(WAS_ON),
                (true, false) => libm::log(1.0 - WAS_ON),
                (false, _) => 0.0,
            },
            ..*self
        };
        starts.iter().map(with).collect()
    }

    /// Returns the record with only some blocks of one log. Centre and scale stay the same.
    pub(super) fn others(&self, index: usize, is_kept: impl Fn(usize) -> bool) -> Self {
        let mut logs = self.logs.clone();
        logs[index].keep(is_kept);
        Self { logs, steps: self.steps.clone(), ..*self }
    }

    pub(super) fn without_lag(self) -> Self {
        Self { without_lag: true, ..self }
    }

    /// Returns the record with `series` in place of its own. Coefficients of the same series can be averaged.
    pub(super) fn over(self, series: Series) -> Self {
        Self { series, ..self }
    }

    /// Returns the record with the steps of `found`, and only with the blocks that `found` has of the same logs.
    pub(super) fn without_disturbances_of(mut self, found: &Self) -> Self {
        self.steps.clone_from(&found.steps);
        self.logs.iter_mut().zip(&found.logs).for_each(|(log, found)| log.keep_blocks_of(found));
        self
    }

    pub(super) fn turning_within(&self, turns: f64) -> Self {
        Self { logs: self.logs.clone(), steps: self.steps.clone(), turns, ..*self }
    }

    /// One-sided density of the white noise: the mean over the logs.
    pub(super) fn white(&self) -> f64 {
        self.logs.iter().map(|log| log.white(self.slope_per_c)).sum::<f64>() / self.logs.len().max(1) as f64
    }

    /// Standard deviation of a mean by white noise, and length of the longest log, s.
    pub(super) fn white_of_mean(&self) -> (f64, f64) {
        let block_s = self.logs.first().map_or(1.0, LogMeans::block_s);
        let length_s = self.logs.iter().map(LogMeans::length_of_log_s).fold(0.0, f64::max);
        ((self.white() / libm::sqrt(2.0 * block_s)).max(LEAST_WHITE * self.scale), length_s)
    }

    pub(super) fn filters(&self, noise: &SlowNoise) -> Vec<Filter> {
        self.logs.iter().map(|log| self.filter(noise, log)).collect()
    }

    pub(super) fn filter(&self, noise: &SlowNoise, log: &LogMeans) -> Filter {
        let least = LEAST_WHITE * self.scale * libm::sqrt(2.0 * log.block_s());
        let noise = Noise {
            white_dps_per_rt_hz: log.white(self.slope_per_c).max(least),
            bias_instability_dps: noise[0],
            rate_random_walk_dps_per_rt_s: noise[1],
            gauss_markov: Vec::new(),
        };
        Filter::new(&noise, log.blocks())
    }

    pub(super) fn columns(&self, index: usize, following: &LagAndPlay) -> Columns {
        let log = &self.logs[index];
        let (low_c, high_c) = self.series.span_c();
        let (followed_c, places) = log.followed(following, self.was_on, self.turns * (high_c - low_c));
        let means = log.blocks().iter().map(|block| block.rate_dps - self.centre).collect();
        let values: Vec<[f64; COEFFICIENTS]> = followed_c.iter().map(|temp_c| self.series.followed(*temp_c)).collect();
        let of_order = |k: usize| values.iter().map(|values| values[k]).collect();
        let mut columns: Vec<Vec<f64>> = (0..COEFFICIENTS).map(of_order).collect();
        columns.insert(0, means);
        if self.two_directions {
            columns.push(places);
        }
        let count = followed_c.len();
        if self.logs.len() > 1 {
            columns.extend((0..self.logs.len()).map(|other| vec![f64::from(u8::from(other == index)); count]));
        }
        // the likely size of the transient, so that its coefficient is about 1
        let size = self.transient(log, following);
        let decay = |block: &Block| size * libm::exp(-block.middle_s() / following.lag_s.max(f64::MIN_POSITIVE));
        let transient: Vec<f64> = log.blocks().iter().map(decay).collect();
        columns.extend(
            (0..self.logs.len()).map(|other| if other == index { transient.clone() } else { vec![0.0; count] }),
        );
        let share = |step: &StepAt, block: &Block| if step.log == index { block.share_after(step.at_s) } else { 0.0 };
        columns.extend(self.steps.iter().map(|step| log.blocks().iter().map(|block| share(step, block)).collect()));
        columns
    }

    pub(super) fn all_columns(&self, following: &LagAndPlay) -> Vec<Columns> {
        (0..self.logs.len()).map(|index| self.columns(index, following)).collect()
    }

    pub(super) fn products(filters: &[Filter], columns: &[Columns]) -> Option<Products> {
        let mut sums: Option<Products> = None;
        for (filter, columns) in filters.iter().zip(columns) {
            let filtered = filter.filtered(&filter.whites(columns), &[])?;
            match &mut sums {
                None => sums = Some(Products { gram: filtered.gram, log_determinant: filtered.log_determinant }),
                Some(sums) => {
                    sums.log_determinant += filtered.log_determinant;
                    for (row, more) in sums.gram.iter_mut().zip(filtered.gram) {
                        row.iter_mut().zip(more).for_each(|(value, more)| *value += more);
                    }
                }
            }
        }
        sums
    }

    /// The prior spreads that are tried.
    pub(super) fn shapes(&self) -> Vec<PriorSpreads> {
        let directions = if self.two_directions { &DIRECTIONS[..] } else { &DIRECTIONS[..1] };
        let starts = if self.logs.len() > 1 { &STARTS[..] } else { &STARTS[..1] };
        let mut shapes = Vec::new();
        for (size, shrink) in SIZES.iter().flat_map(|size| SHRINKS.map(|shrink| (*size, shrink))) {
            for (direction, starts) in directions.iter().flat_map(|of| starts.iter().map(move |starts| (*of, *starts)))
            {
                let [size, direction, starts] = [size, direction, starts].map(|ratio| ratio * self.scale);
                for is_unsettled in [false, true] {
                    shapes.push(PriorSpreads { size, shrink, direction, starts, is_unsettled });
                }
            }
        }
        shapes
    }

    /// Logarithm of the prior probability of these spreads, of the start, and of the lag of `following`. `None` for
    /// unsettled spreads without a lag, which equal the settled ones.
    pub(super) fn log_prior(&self, shape: &PriorSpreads, following: &LagAndPlay) -> Option<f64> {
        let of_shape = match (following.lag_s > 0.0, shape.is_unsettled) {
            (false, false) => 0.0,
            (false, true) => return None,
            (true, false) => libm::log(1.0 - UNSETTLED),
            (true, true) => libm::log(UNSETTLED),
        };
        let lags = following.lag_s / USUAL_LAG_S;
        let of_lag = if self.was_on { -libm::log(1.0 + lags * lags) } else { 0.0 };
        Some(self.log_start + of_shape + of_lag)
    }

    /// Expected size of the part of the bias that still lags behind at the start of a log.
    fn transient(&self, log: &LogMeans, following: &LagAndPlay) -> f64 {
        let (low_c, high_c) = self.series.span_c();
        self.scale / (high_c - low_c) * log.start_c_per_s().abs() * following.lag_s
    }

    /// Prior variances of all coefficients. A variance of 0 fixes a coefficient at 0.
    fn variances(&self, shape: &PriorSpreads) -> Vec<f64> {
        let level = LEVEL * self.scale;
        let order = |k: usize| shape.size * libm::pow(shape.shrink, k as f64);
        let series = [level].into_iter().chain((0..COEFFICIENTS - 1).map(order));
        let direction = self.two_directions.then_some(shape.direction);
        let starts = self.logs.iter().filter(|_| self.logs.len() > 1).map(|_| shape.starts);
        let transient = |log: &LogMeans| match (shape.is_unsettled, log.was_on(self.was_on)) {
            (true, _) => 1.0,
            (false, true) => BEHIND,
            (false, false) => 0.0,
        };
        let transients = self.logs.iter().map(transient);
        let steps = self.steps.iter().map(|_| self.scale);
        series
            .chain(direction)
            .chain(starts)
            .chain(transients)
            .chain(steps)
            .map(|deviation| deviation * deviation)
            .collect()
    }

    /// Computes the coefficients under these prior variances, and the logarithm of the evidence.
    pub(super) fn solve(&self, products: &Products, variances: &[f64]) -> Option<Solved> {
        let used: Vec<usize> = (0..variances.len()).filter(|k| variances[*k] > 0.0).collect();
        let product = |i: usize, j: usize| products.gram[i.max(j)][i.min(j)];
        let row = |(place, i): (usize, &usize)| {
            let mut row: Vec<f64> = used[..=place].iter().map(|j| product(i + 1, j + 1)).collect();
            row[place] += 1.0 / variances[*i];
            row
        };
        let information = Cholesky::new(used.iter().enumerate().map(row).collect(), LEAST_PIVOT)?;
        let with_means: Vec<f64> = used.iter().map(|i| product(i + 1, 0)).collect();
        let solution = information.solve(with_means.iter().copied());
        let left = product(0, 0) - gls::dot(&solution, &with_means);
        let log_prior: f64 = used.iter().map(|k| libm::log(variances[*k])).sum();
        let log_evidence = -0.5 * (left + products.log_determinant + information.ln_determinant() + log_prior);
        let mut coefficients = vec![0.0; variances.len()];
        used.iter().zip(solution).for_each(|(k, value)| coefficients[*k] = value);
        log_evidence.is_finite().then_some(Solved { coefficients, log_evidence, information, used })
    }

    pub(super) fn solve_shape(&self, products: &Products, shape: &PriorSpreads) -> Option<Solved> {
        self.solve(products, &self.variances(shape))
    }

    /// Logarithm of the evidence of a bias that does not depend on the temperature.
    pub(super) fn log_evidence_without(&self, products: &Products, shape: &PriorSpreads) -> Option<f64> {
        let mut variances = self.variances(shape);
        variances[1..COEFFICIENTS].fill(0.0);
        if self.two_directions {
            variances[COEFFICIENTS] = 0.0;
        }
        Some(self.solve(products, &variances)?.log_evidence)
    }

    pub(super) fn model(
        &self,
        solved: &Solved,
        (noise, following, shape): (SlowNoise, LagAndPlay, PriorSpreads),
    ) -> Model {
        let all = solved.coefficients.clone();
        let mut coefficients: [f64; COEFFICIENTS] = core::array::from_fn(|k| all[k]);
        coefficients[0] += self.centre;
        let direction = if self.two_directions { all[COEFFICIENTS] } else { 0.0 };
        Model {
            weight: 0.0,
            log_score: solved.log_evidence,
            log_odds: 0.0,
            noise,
            following,
            was_on: self.was_on,
            shape,
            coefficients,
            covariance: solved.covariance(),
            direction,
            all,
        }
    }

    pub(super) fn steps_of(&self, model: &Model) -> Vec<CurveStep> {
        let sizes = &model.all[model.all.len() - self.steps.len()..];
        let step = |(step, size): (&StepAt, &f64)| CurveStep { log: step.log, at_s: step.at_s, size: *size };
        self.steps.iter().zip(sizes).map(step).collect()
    }

    /// Change of the bias that is still to come at the end of the last log, because of the lag.
    pub(super) fn unsettled(&self, following: &LagAndPlay, bias: impl Fn(f64) -> f64) -> f64 {
        let ends = self.logs.last().and_then(|log| log.at_end(following, self.was_on));
        ends.map_or(0.0, |(last_c, late_c)| bias(last_c) - bias(late_c))
    }
}

const LEAST_PIVOT: f64 = 1e-14;

/// The coefficients of a model, and its information matrix.
pub(super) struct Solved {
    pub(super) coefficients: Vec<f64>,
    pub(super) log_evidence: f64,
    information: Cholesky,
    /// Indices of the coefficients that the information matrix has. The others are 0.
    used: Vec<usize>,
}

impl Solved {
    /// Variance of a sum of the coefficients with these weights.
    pub(super) fn variance(&self, weights: &[f64]) -> f64 {
        let white = self.information.whiten(self.used.iter().map(|k| weights[*k]));
        gls::dot(&white, &white)
    }

    fn covariance(&self) -> [[f64; COEFFICIENTS]; COEFFICIENTS] {
        let column = |k: usize| {
            let unit = self.used.iter().map(|used| f64::from(u8::from(*used == k)));
            let solved = self.information.solve(unit);
            let mut column = [0.0; COEFFICIENTS];
            let of_series = self.used.iter().zip(solved).filter(|(used, _)| **used < COEFFICIENTS);
            of_series.for_each(|(used, value)| column[*used] = value);
            column
        };
        core::array::from_fn(column)
    }
}
