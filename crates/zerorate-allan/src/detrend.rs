//! Detects and removes the dependence of a rate on temperature.
//!
//! The drift of a warming sensor looks like a rate random walk. Detection and removal use means over at most
//! [`BLOCKS`] equal parts of the record, which keep all slow changes.

use crate::linear::{dot, take_out};
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use libm::{exp2, log, sqrt};

/// Largest number of parts of a record.
const BLOCKS: usize = 128;
/// Highest order of the polynomial.
pub const MOST_ORDER: usize = 3;
/// The rate follows the temperature if twice the gain in log-likelihood is above this. χ² of one degree of freedom
/// exceeds it once in 130 000. A test below shows that at most one of 400 records of random walk, flicker and white
/// noise during a warm-up exceeds it.
const SIGNIFICANT: f64 = 20.0;
/// The least share of the slow variance that a line over temperature must explain.
const LEAST_EXPLAINED: f64 = 0.25;

/// The dependence of a rate on the temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Follows {
    /// Share of the variance of the slow rate that a line over temperature explains.
    pub explained: f64,
    /// Slope of that line, unit of the rate per °C, for the most likely mixture of random walk and white noise.
    pub slope_per_c: f64,
    /// Highest less lowest temperature, °C.
    pub span_c: f64,
}

/// A rate from which a polynomial over temperature was removed.
#[derive(Clone, Debug, PartialEq)]
pub struct DetrendedRate {
    /// The rate less the polynomial. The mean is kept; NaN marks a missing sample.
    pub residual: Vec<f64>,
    /// Coefficients of (T − [`mean_c`](Self::mean_c)), from the first power on: unit of the rate per °C, °C², …
    pub coefficients: Vec<f64>,
    /// Mean temperature, °C.
    pub mean_c: f64,
    /// Share of the variance of the slow rate that the polynomial explains.
    pub explained: f64,
    /// Degrees of freedom that the polynomial takes besides the mean: its order.
    pub lost_dof: usize,
    /// Share of a random walk's Allan variance that remains after the removal, for averages of 1, 2, 4 … parts.
    kept: Vec<f64>,
    /// Share of the variance of a random walk about its mean that remains after the removal.
    walk_kept: f64,
    samples_per_part: f64,
}

/// The reason why the dependence on temperature cannot be fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DetrendError {
    /// The numbers of rates and of temperatures differ.
    Lengths {
        /// Number of rates.
        rates: usize,
        /// Number of temperatures.
        temps: usize,
    },
    /// The order is not one of 1 to [`MOST_ORDER`].
    Order(usize),
    /// Fewer than 128 samples, a part of the record without a rate, or a first part without a temperature.
    Short,
    /// The temperature is the same all the time, or has too few different values for the order.
    Constant,
}

impl fmt::Display for DetrendError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Lengths { rates, temps } => write!(f, "{rates} rates have {temps} temperatures; give one for each"),
            Self::Order(order) => write!(f, "the order {order} must be 1 to {MOST_ORDER}"),
            Self::Short => f.write_str("too few samples have a rate and a temperature"),
            Self::Constant => f.write_str("the temperature is the same all the time"),
        }
    }
}

impl core::error::Error for DetrendError {}

/// Detects whether a rate follows the temperature that was read with it. NaN marks a missing value. A part of the
/// record without any temperature takes the mean of the part before. `None` if the rate does not follow the
/// temperature, if the temperature is constant, for too few data, or if the slices differ in length.
///
/// The likelihoods of two models are compared, with and without a line over temperature, each with its best mixture of
/// white noise and random walk. So a random walk is not mistaken for a dependence on temperature.
#[must_use]
pub fn follows_temperature(rates: &[f64], temps: &[f64]) -> Option<Follows> {
    let parts = Parts::of(rates, temps).ok()?;
    let basis = parts.basis(1).ok()?;
    let explained = explained(&parts.rates, &basis);
    let without = (0..MIXTURES).map(|k| likelihood(&parts, mixture(k), false).0).fold(f64::MIN, f64::max);
    let with = (0..MIXTURES).map(|k| likelihood(&parts, mixture(k), true)).max_by(|a, b| a.0.total_cmp(&b.0))?;
    let follows = 2.0 * (with.0 - without) > SIGNIFICANT && explained > LEAST_EXPLAINED;
    let (low, high) = parts.temps.iter().fold((f64::MAX, f64::MIN), |(low, high), t| (low.min(*t), high.max(*t)));
    follows.then_some(Follows { explained, slope_per_c: with.1, span_c: high - low })
}

/// Removes a polynomial over temperature from a rate, by least squares over means of the parts of the record. The
/// temperature is interpolated between these means, so that its noise does not enter the rate.
///
/// # Errors
/// Returns [`DetrendError`] for an order out of range, unequal lengths, too few samples, or a constant temperature.
pub fn detrend(rates: &[f64], temps: &[f64], order: usize) -> Result<DetrendedRate, DetrendError> {
    if !(1..=MOST_ORDER).contains(&order) {
        return Err(DetrendError::Order(order));
    }
    let parts = Parts::of(rates, temps)?;
    let basis = parts.basis(order)?;
    let mean_c = mean(&parts.temps);
    let coefficients = parts.polynomial(order, mean_c).ok_or(DetrendError::Constant)?;
    let slow = |d: f64| coefficients.iter().rev().fold(0.0, |sum, coefficient| (sum + coefficient) * d);
    let level = mean(&parts.temps.iter().map(|t| slow(t - mean_c)).collect::<Vec<_>>());
    let residual = rates.iter().enumerate().map(|(at, rate)| rate - slow(parts.temp(at) - mean_c) + level).collect();
    let (kept, walk_kept) = kept(&basis);
    let explained = explained(&parts.rates, &basis);
    Ok(DetrendedRate {
        residual,
        coefficients,
        mean_c,
        explained,
        lost_dof: order,
        kept,
        walk_kept,
        samples_per_part: parts.samples_per_part,
    })
}

impl DetrendedRate {
    /// The share of a random walk's Allan variance that is left in averages of `m` samples; 1 for short averages. The
    /// polynomial also removes noise at the frequencies of the temperature.
    #[must_use]
    pub fn kept(&self, m: u64) -> f64 {
        let parts = m as f64 / self.samples_per_part;
        let octave = libm::log2(parts.max(1.0));
        let (below, last) = (libm::floor(octave) as usize, self.kept.len() - 1);
        let (a, b) = (self.kept[below.min(last)], self.kept[(below + 1).min(last)]);
        if parts < 1.0 { 1.0 } else { a + (b - a) * (octave - libm::floor(octave)) }
    }

    /// The share of a random walk's variance over the whole record that is left.
    #[must_use]
    pub fn walk_kept(&self) -> f64 {
        self.walk_kept
    }

    /// Corrects the limits of a point of the residual for the noise that the polynomial removed. The degrees of
    /// freedom fall in proportion, and the upper limit includes the removed noise.
    #[must_use]
    pub fn widened(&self, point: &super::Point, confidence: f64) -> super::Point {
        let kept = self.kept(point.m);
        let edf = (point.edf * kept).max(1.0).min(point.edf);
        let (lo, hi) = super::interval(point.dev, edf, confidence);
        super::Point { edf, lo, hi: hi / sqrt(kept), ..*point }
    }

    /// Corrects K for the share of a random walk that the polynomial removes on average. The value and the upper limit
    /// rise. The lower limit stays, because the polynomial may have removed none of the random walk.
    #[must_use]
    pub fn widened_walk(&self, k: &super::Coefficient) -> super::Coefficient {
        let gain = 1.0 / sqrt(self.walk_kept);
        super::Coefficient { value: k.value * gain, hi: k.hi * gain, ..*k }
    }
}

/// Means over the parts of a record.
struct Parts {
    rates: Vec<f64>,
    temps: Vec<f64>,
    samples_per_part: f64,
}

impl Parts {
    fn of(rates: &[f64], temps: &[f64]) -> Result<Self, DetrendError> {
        if rates.len() != temps.len() {
            return Err(DetrendError::Lengths { rates: rates.len(), temps: temps.len() });
        }
        let count = BLOCKS.min(rates.len() / 8);
        if count < 16 {
            return Err(DetrendError::Short);
        }
        let samples_per_part = rates.len() as f64 / count as f64;
        let mut parts = Self { rates: Vec::new(), temps: Vec::new(), samples_per_part };
        for part in 0..count {
            let at = |part: usize| (part as f64 * samples_per_part) as usize;
            let range = at(part)..at(part + 1).min(rates.len());
            parts.rates.push(mean_of_known(&rates[range.clone()]).ok_or(DetrendError::Short)?);
            let temp = mean_of_known(&temps[range]).or(parts.temps.last().copied());
            parts.temps.push(temp.ok_or(DetrendError::Short)?);
        }
        Ok(parts)
    }

    /// The temperature at a sample: a straight line between the middles of the parts.
    fn temp(&self, sample: usize) -> f64 {
        let at = (sample as f64 + 0.5) / self.samples_per_part - 0.5;
        let left = (at.max(0.0) as usize).min(self.temps.len() - 2);
        self.temps[left] + (at - left as f64) * (self.temps[left + 1] - self.temps[left])
    }

    /// Orthonormal polynomials over the temperatures, the constant first.
    fn basis(&self, order: usize) -> Result<Vec<Vec<f64>>, DetrendError> {
        let mean_c = mean(&self.temps);
        let span_c = self.temps.iter().map(|t| (t - mean_c).abs()).fold(0.0, f64::max);
        if span_c <= 1e-9 * mean_c.abs().max(1.0) {
            return Err(DetrendError::Constant);
        }
        let mut basis: Vec<Vec<f64>> = Vec::new();
        for power in 0..=order {
            let mut next: Vec<f64> = self.temps.iter().map(|t| powered((t - mean_c) / span_c, power)).collect();
            // orthogonalising twice is enough
            basis.iter().chain(&basis).for_each(|known| take_out(&mut next, known));
            let length = sqrt(dot(&next, &next));
            if length < 1e-9 {
                return Err(DetrendError::Constant);
            }
            next.iter_mut().for_each(|next| *next /= length);
            basis.push(next);
        }
        Ok(basis)
    }

    /// Least-squares coefficients of (T − mean), from the first power on. The powers are scaled to ±1 for the
    /// equations.
    fn polynomial(&self, order: usize, mean_c: f64) -> Option<Vec<f64>> {
        let span_c = self.temps.iter().map(|t| (t - mean_c).abs()).fold(0.0, f64::max);
        let column =
            |power: usize| -> Vec<f64> { self.temps.iter().map(|t| powered((t - mean_c) / span_c, power)).collect() };
        let columns: Vec<Vec<f64>> = (0..=order).map(column).collect();
        let row = |a: &Vec<f64>| columns.iter().map(|b| dot(a, b)).chain([dot(a, &self.rates)]).collect();
        let solved = solved(columns.iter().map(row).collect())?;
        Some((1..=order).map(|power| solved[power] / powered(span_c, power)).collect())
    }
}

/// Solves linear equations by Gaussian elimination with pivots. Each row ends with its right side. `None` if singular.
fn solved(mut rows: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let count = rows.len();
    for step in 0..count {
        let pivot = (step..count).max_by(|&a, &b| rows[a][step].abs().total_cmp(&rows[b][step].abs()))?;
        rows.swap(step, pivot);
        let row = rows[step].clone();
        if row[step].abs() < 1e-12 {
            return None;
        }
        for (_, other) in rows.iter_mut().enumerate().filter(|(at, _)| *at != step) {
            let factor = other[step] / row[step];
            other.iter_mut().zip(&row).for_each(|(other, value)| *other -= factor * value);
        }
    }
    Some(rows.iter().enumerate().map(|(at, row)| row[count] / row[at]).collect())
}

/// Share of the variance about the mean that the basis explains, without its constant.
fn explained(rates: &[f64], basis: &[Vec<f64>]) -> f64 {
    let level = mean(rates);
    let total: f64 = rates.iter().map(|rate| (rate - level) * (rate - level)).sum();
    let by_basis: f64 = basis[1..].iter().map(|known| dot(known, rates) * dot(known, rates)).sum();
    if total > 0.0 { (by_basis / total).min(1.0) } else { 0.0 }
}

/// The shares of a random walk that are left after its projection onto the basis is removed: of its Allan
/// variance at 1, 2, 4 … parts, and of its variance.
fn kept(basis: &[Vec<f64>]) -> (Vec<f64>, f64) {
    let (all, constant) = (walk(basis), walk(&basis[..1]));
    let octaves = (0..).map(|k| 1usize << k).take_while(|m| 2 * m <= basis[0].len());
    let share = |m| (allan(&all, m) / allan(&constant, m)).clamp(0.01, 1.0);
    let trace = |matrix: &[Vec<f64>]| matrix.iter().enumerate().map(|(at, row)| row[at]).sum::<f64>();
    (octaves.map(share).collect(), (trace(&all) / trace(&constant)).clamp(0.01, 1.0))
}

/// Covariance of what the basis Q leaves of a random walk of unit steps: (1 − QQᵀ) C (1 − QQᵀ) with C = min(i, j).
fn walk(basis: &[Vec<f64>]) -> Vec<Vec<f64>> {
    let count = basis[0].len();
    let mut matrix: Vec<Vec<f64>> = (0..count).map(|i| (0..count).map(|j| i.min(j) as f64 + 1.0).collect()).collect();
    for known in basis {
        // projects from the left and from the right
        let columns: Vec<f64> = (0..count).map(|j| (0..count).map(|i| known[i] * matrix[i][j]).sum()).collect();
        for (row, share) in matrix.iter_mut().zip(known) {
            row.iter_mut().zip(&columns).for_each(|(value, column)| *value -= share * column);
        }
        matrix.iter_mut().for_each(|row| take_out(row, known));
    }
    matrix
}

/// Allan variance of averages of `m` parts with this covariance, up to a factor.
fn allan(covariance: &[Vec<f64>], m: usize) -> f64 {
    let count = covariance.len();
    let mut sums = vec![vec![0.0; count + 1]; count + 1];
    for i in 0..count {
        for j in 0..count {
            sums[i + 1][j + 1] = covariance[i][j] + sums[i][j + 1] + sums[i + 1][j] - sums[i][j];
        }
    }
    let block = |i: usize, j: usize| sums[i + m][j + m] - sums[i][j + m] - sums[i + m][j] + sums[i][j];
    let starts = count - 2 * m + 1;
    let terms = starts as f64;
    (0..starts).map(|s| block(s, s) + block(s + m, s + m) - 2.0 * block(s, s + m)).sum::<f64>() / terms
}

const MIXTURES: usize = 25;

/// Variance of a step of the random walk divided by the variance of the white noise: 0, and 2⁻¹² … 2¹¹.
fn mixture(k: usize) -> f64 {
    if k == 0 { 0.0 } else { exp2(k as f64 - 13.0) }
}

/// Log-likelihood of the parts under a local-level model, with or without a line over temperature, and the slope of
/// the line. The same Kalman filter runs over rate and temperature, and the rate innovations are regressed on the
/// temperature innovations. The initial level is unknown, and the noise variance is the most likely one.
fn likelihood(parts: &Parts, ratio: f64, line: bool) -> (f64, f64) {
    let (mut rate, mut temp, mut variance) = (parts.rates[0], parts.temps[0], 1.0);
    let (mut yy, mut yt, mut tt, mut logs) = (0.0, 0.0, 0.0, 0.0);
    for (y, t) in parts.rates.iter().zip(&parts.temps).skip(1) {
        let ahead = variance + ratio;
        let total = ahead + 1.0;
        let (dy, dt) = (y - rate, t - temp);
        (yy, yt, tt) = (yy + dy * dy / total, yt + dy * dt / total, tt + dt * dt / total);
        logs += log(total);
        let gain = ahead / total;
        (rate, temp, variance) = (rate + gain * dy, temp + gain * dt, gain);
    }
    let slope = if line && tt > 0.0 { yt / tt } else { 0.0 };
    let count = parts.rates.len() as f64 - 1.0;
    let left = (yy - slope * yt).max(yy * 1e-12).max(f64::MIN_POSITIVE);
    (-0.5 * (count * log(left / count) + logs), slope)
}

fn powered(value: f64, power: usize) -> f64 {
    (0..power).fold(1.0, |product, _| product * value)
}

fn mean_of_known(values: &[f64]) -> Option<f64> {
    let known = values.iter().filter(|value| value.is_finite());
    let (sum, count) = known.fold((0.0, 0u64), |(sum, count), value| (sum + value, count + 1));
    (count > 0).then(|| sum / count as f64)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130_twin::{Means, Spec};

    /// Rates, °/s, and temperatures, °C, of the 40 minutes after power-on: one mean per second.
    fn record(spec: &Spec) -> (Vec<f64>, Vec<f64>) {
        let mut means = Means::new(spec, 10);
        (0..2400).map(|_| means.next_mean()).map(|mean| (mean.rate_dps, mean.temp_c)).unzip()
    }

    #[test]
    fn a_warming_part_is_found_and_a_walk_is_not_taken_for_it() {
        let mut taken = 0;
        for seed in 1..=400 {
            let unit = Spec::from_seed(seed);
            let walking = Spec { rrw_dps_per_rt_s: 1e-4 * f64::from(1 << (seed % 6)), ..unit.clone() };
            let still = Spec { tempco_dps_per_c: 0.0, curvature_dps_per_c2: 0.0, hysteresis_dps: 0.0, ..walking };
            let (rates, temps) = record(&still);
            taken += u32::from(follows_temperature(&rates, &temps).is_some());
            if seed <= 40 {
                let (rates, temps) = record(&unit);
                let follows = follows_temperature(&rates, &temps).expect("a part that warms by 8 °C");
                assert!(follows.explained > 0.5 && follows.span_c > 4.0, "seed {seed}: {follows:?}");
                let slope = unit.tempco_dps_per_c * (1.0 + unit.sensitivity_error);
                assert!((follows.slope_per_c - slope).abs() < 0.02, "seed {seed}: {follows:?}, {slope}");
            }
        }
        assert!(taken <= 1, "{taken} of 400 walks");
    }

    #[test]
    fn a_polynomial_is_taken_out_and_what_that_costs_is_known() {
        let temps: Vec<f64> = (0..4000).map(|i| 25.0 + 8.0 * (1.0 - (-f64::from(i) / 1000.0).exp())).collect();
        let rates: Vec<f64> = temps.iter().map(|t| 0.3 + 0.04 * (t - 30.0) + 0.001 * (t - 30.0).powi(2)).collect();
        let DetrendedRate { residual, coefficients, explained, mean_c, lost_dof, .. } =
            detrend(&rates, &temps, 2).unwrap();
        let level = mean(&residual);
        assert!(residual.iter().all(|left| (left - level).abs() < 3e-4), "as far as a part is a straight line");
        assert!((level - mean(&rates)).abs() < 1e-4 && explained > 0.999_999 && lost_dof == 2);
        assert!((coefficients[1] - 0.001).abs() < 1e-5);
        assert!((coefficients[0] - (0.04 + 0.002 * (mean_c - 30.0))).abs() < 1e-4, "{coefficients:?}");
    }

    /// After a line over time is removed, 6/15 of the variance of a random walk about its mean is left.
    #[test]
    fn a_line_leaves_six_fifteenths_of_a_walk() {
        let temps: Vec<f64> = (0..4000).map(f64::from).collect();
        let line = detrend(&temps, &temps, 1).unwrap();
        assert!((line.walk_kept() - 6.0 / 15.0).abs() < 0.01, "{}", line.walk_kept());
        assert_eq!(line.kept(1), 1.0);
        assert!(line.kept(32) > 0.97 && line.kept(2000) < 0.2, "{} {}", line.kept(32), line.kept(2000));
        let point = crate::Point { tau_s: 1.0, m: 1000, dev: 1.0, lo: 0.8, hi: 1.3, edf: 8.0, alpha: -2, n: 2001 };
        let wider = line.widened(&point, 0.683);
        assert!(wider.edf < 4.0 && wider.hi > 1.6 && wider.dev == 1.0, "{wider:?}");
        assert_eq!(line.widened(&crate::Point { m: 1, ..point }, 0.683).edf, 8.0);
        let cubic = detrend(&temps, &temps, 3).unwrap();
        assert!(cubic.walk_kept() < line.walk_kept());
    }

    /// A line or a parabola over temperature is removed from the rate of a warming sensor with K = 1e-4 °/s/√s (M-04).
    /// The widened interval of K includes this value in at least 13 of 15 records.
    #[cfg(feature = "std")]
    #[test]
    fn the_interval_of_k_holds_what_the_polynomial_took() {
        use crate::{FitOptions, Input, fit};
        for order in [1, 2] {
            let mut held = 0;
            for seed in 1..=15 {
                let (rates, temps) = record(&Spec { curvature_dps_per_c2: 0.0, ..Spec::from_seed(seed) });
                let detrended = detrend(&rates, &temps, order).unwrap();
                let fit = fit(&Input::Rate(&detrended.residual), 1.0, &FitOptions::default()).unwrap();
                let k = detrended.widened_walk(&fit.k);
                held += u32::from(k.lo <= 1e-4 && k.hi >= 1e-4);
            }
            assert!(held >= 13, "order {order}: {held} of 15");
        }
    }

    #[test]
    fn impossible_inputs_are_refused() {
        let (rates, same) = (vec![0.0; 1000], vec![25.0; 1000]);
        assert_eq!(detrend(&rates, &same, 1), Err(DetrendError::Constant));
        assert_eq!(detrend(&rates, &same[1..], 1), Err(DetrendError::Lengths { rates: 1000, temps: 999 }));
        assert_eq!(detrend(&rates, &same, 4), Err(DetrendError::Order(4)));
        assert_eq!(detrend(&rates[..50], &same[..50], 1), Err(DetrendError::Short));
        assert_eq!(detrend(&[f64::NAN; 1000], &same, 1), Err(DetrendError::Short));
        assert_eq!(follows_temperature(&rates, &same), None);
    }
}
