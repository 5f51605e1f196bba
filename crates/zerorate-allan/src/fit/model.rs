//! The Allan variance of a fitted model, and the variance of its overlapping estimate.

use super::bins::interpolated;
use super::density::shape_angle;
use super::drift::Drift;
use super::prediction::{PredictionError, Variances};
use super::scoring::{B2, Explanation, K2, N2, Optimum, Q2, low_pass_memory, shape};
use super::thinning::Thinning;
use super::transform::autocovariance;
use crate::{FLOOR_PER_B, chi2_quantile, interval};
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use realfft::FftError;

/// Number of lags of the autocovariance of the short noise: white noise, quantisation, and the effect of the band
/// shape on slow noise. A model that ends below half the rate, or has a slow low-pass, has up to `MOST_LAGS`.
const LAGS: usize = 256;
const MOST_LAGS: usize = 16_384;
/// Number of time constants after which the response of a low-pass has died away.
const MEMORIES: f64 = 16.0;
/// Up to averages of this many samples, the covariance of two estimates is summed lag by lag from the autocovariance.
const LONGEST_EXACT: u64 = 64;
/// For longer averages: the lags per averaging time, and the number of averaging times that they reach.
const STEPS_PER_TAU: u64 = 8;
const REACH: u64 = 40;

/// The noise model of a record, which gives its Allan variance at any averaging time.
#[derive(Clone, Debug, PartialEq)]
pub struct Model {
    rate_hz: f64,
    record_s: f64,
    short: Vec<f64>,
    b2: f64,
    k2: f64,
    /// Variance and correlation time of each Gauss–Markov term.
    markovs: Vec<(f64, f64)>,
    pub(super) drift: Option<(Drift, f64)>,
    /// Variance and frequency of each sine.
    sines: Vec<(f64, f64)>,
    thinning: Thinning,
    doubt: PredictionError,
}

/// The record behind a model, and the part of its spectrum that is measured instead of modelled.
#[derive(Clone, Debug)]
pub(super) struct MeasuredSpectrum {
    pub(super) rate_hz: f64,
    pub(super) record_s: f64,
    /// The upper end of the model, Hz.
    pub(super) top_hz: f64,
    /// Frequency and density of the bins above `top_hz`.
    pub(super) above: Vec<(f64, f64)>,
    /// Variance and frequency of each sine.
    pub(super) sines: Vec<(f64, f64)>,
}

impl MeasuredSpectrum {
    /// The density above the upper end, linear between the bins; `None` up to the upper end.
    fn density(&self, f_hz: f64) -> Option<f64> {
        let is_known = f_hz > self.top_hz && !self.above.is_empty();
        is_known.then(|| interpolated(&self.above, f_hz))
    }

    /// Number of lags of the shaped noise, after which the response of the shape up to `top_hz`, or of its low-pass,
    /// has died away. `memory` is the time constant of the low-pass in samples.
    fn lags(&self, memory: f64) -> usize {
        let fineness = self.rate_hz / 2.0 / self.top_hz;
        let octaves = libm::ceil(libm::log2(fineness.max(MEMORIES / LAGS as f64 * memory)) - 1e-3);
        ((LAGS as f64 * libm::exp2(octaves)) as usize).clamp(LAGS, MOST_LAGS)
    }
}

impl Model {
    pub(super) fn new(found: &Optimum, measured: &MeasuredSpectrum) -> Result<Self, FftError> {
        let form = &found.form;
        let &MeasuredSpectrum { rate_hz, record_s, top_hz, .. } = measured;
        let markov = |index| {
            let place = form.markov(index);
            (found.at[place], libm::exp(found.at[place + 1]))
        };
        let mut model = Self {
            rate_hz,
            record_s,
            short: Vec::new(),
            b2: found.at[B2],
            k2: found.at[K2],
            markovs: (0..form.markovs).map(markov).collect(),
            drift: form.drift.map(|drift| (drift, found.drift)),
            sines: measured.sines.clone(),
            thinning: Thinning::default(),
            doubt: PredictionError::default(),
        };
        let lags = measured.lags(low_pass_memory(form, &found.at, rate_hz, top_hz));
        let density = |i: usize| {
            // at 0 the density of slow noise is infinite
            let f_hz = rate_hz / 2.0 * (i as f64).max(1e-3) / lags as f64;
            if let Some(power) = measured.density(f_hz) {
                return power - model.slow_density(f_hz);
            }
            let sin = libm::sin(PI * f_hz / rate_hz);
            let shape = shape(form, &found.at, shape_angle(f_hz, rate_hz, top_hz));
            let slow = if form.reading == Explanation::Joins { 0.0 } else { (shape - 1.0) * model.slow_density(f_hz) };
            found.at[N2] * shape + slow + found.at[Q2] * 4.0 * sin * sin * rate_hz * rate_hz
        };
        let densities: Vec<f64> = (0..=lags).map(density).collect();
        model.short = autocovariance(&densities, rate_hz)?;
        model.short.truncate(lags);
        Ok(model)
    }

    /// The density of flicker, random walk and Gauss–Markov terms in samples that are averages over the sample
    /// interval T₀, as [`allan_variance`](Self::allan_variance) takes them: Σ S(|f + k/T₀|) sinc²((f + k/T₀) T₀) over
    /// all k.
    fn slow_density(&self, f_hz: f64) -> f64 {
        let u = f_hz / self.rate_hz;
        let square = libm::pow(libm::sin(PI * u), 2.0);
        let omega2 = 4.0 * self.rate_hz * self.rate_hz * square;
        // Σ sinc⁴, the factor by which densities that fall as 1/f² fold
        let folded = 1.0 - 2.0 / 3.0 * square;
        let flicker = square / (2.0 * PI * PI * PI * self.rate_hz) * (inverse_cubes(u) + inverse_cubes(1.0 - u));
        let markov = |&(variance, t): &(f64, f64)| 2.0 * variance * t / (1.0 + omega2 * t * t) * folded;
        self.b2 * flicker + self.k2 / omega2 * folded + self.markovs.iter().map(markov).sum::<f64>()
    }

    pub(super) fn with(self, doubt: PredictionError) -> Self {
        Self { doubt, ..self }
    }

    pub(super) fn with_gaps_of(self, rate: &[f64]) -> Self {
        Self { thinning: Thinning::of(rate, &self.short), ..self }
    }

    /// The expected Allan variance of the measured curve, unit². Averages with missing samples scatter more.
    pub fn measured_variance(&self, m: u64) -> f64 {
        let more = self.thinning.at(m) - 1.0;
        self.allan_variance(m) + if more > 0.0 { more * self.short_variance(m) } else { 0.0 }
    }

    pub(super) fn samples(&self) -> f64 {
        self.record_s * self.rate_hz
    }

    /// The variances of ln σ² in another record.
    pub(super) fn doubt(&self, m: u64) -> Variances {
        self.doubt.at(m)
    }

    /// The Allan variance of averages of `m` samples, unit².
    #[must_use]
    pub fn allan_variance(&self, m: u64) -> f64 {
        let tau_s = m as f64 / self.rate_hz;
        let drift = self.drift.map_or(0.0, |(drift, size)| size * size * drift.allan_variance(tau_s, self.record_s));
        self.with_slow(self.short_variance(m), m) + drift
    }

    /// The Allan variance without lines, drift and warm-up, which are not noise, unit².
    #[must_use]
    pub fn noise_variance(&self, m: u64) -> f64 {
        self.with_slow(self.white_variance(m), m)
    }

    /// Adds the Allan variance of flicker, random walk and Gauss–Markov terms.
    fn with_slow(&self, short: f64, m: u64) -> f64 {
        let tau_s = m as f64 / self.rate_hz;
        let markov = |&(variance, t): &(f64, f64)| {
            let bend = 3.0 - 4.0 * libm::exp(-tau_s / t) + libm::exp(-2.0 * tau_s / t);
            2.0 * variance * t / tau_s * (1.0 - t / (2.0 * tau_s) * bend)
        };
        short
            + FLOOR_PER_B * FLOOR_PER_B * self.b2
            + self.k2 * tau_s / 3.0
            + self.markovs.iter().map(markov).sum::<f64>()
    }

    /// The Allan variance of the short noise (see [`LAGS`]) and of lines.
    fn short_variance(&self, m: u64) -> f64 {
        let samples = m as f64;
        let sine = |&(variance, hz): &(f64, f64)| {
            let sin = libm::sin(PI * hz / self.rate_hz);
            let square = libm::pow(libm::sin(PI * samples * hz / self.rate_hz), 2.0);
            2.0 * variance * square * square / (samples * samples * sin * sin)
        };
        self.white_variance(m) + self.sines.iter().map(sine).sum::<f64>()
    }

    /// The Allan variance of the short noise (see [`LAGS`]): 2 (V(m) − V(2m)), where V is the variance of a mean.
    fn white_variance(&self, m: u64) -> f64 {
        let of_mean = |m: f64| {
            let lags = self.short.iter().enumerate().skip(1).take_while(|(k, _)| (*k as f64) < m);
            let sum: f64 = lags.map(|(k, covariance)| (m - k as f64) * covariance).sum();
            (m * self.short[0] + 2.0 * sum) / (m * m)
        };
        let m = m as f64;
        2.0 * (of_mean(m) - of_mean(2.0 * m))
    }

    /// Degrees of freedom of an overlapping deviation of `n` terms. Gaps reduce them by the missing terms, and by the
    /// noise of averages over fewer samples: the expected deviation includes the power of that noise, but not its
    /// scatter.
    pub(super) fn measured_freedom(&self, m: u64, n: u64, samples: u64) -> f64 {
        let terms = (samples + 1).saturating_sub(2 * m).max(1);
        let whole = self.measured_variance(m);
        let share = whole / (whole + self.thinning.added(m) * self.short_variance(m));
        (self.freedom(m, samples) * n as f64 / terms as f64 * share * share).max(1.0)
    }

    /// The limits of 95 % of the overlapping Allan deviations of `n` terms of `samples` samples under the model.
    pub(super) fn band(&self, m: u64, n: u64, samples: u64) -> (f64, f64) {
        let variance = self.measured_variance(m);
        let edf = self.measured_freedom(m, n, samples);
        let limit = |p: f64| libm::sqrt(variance * chi2_quantile(p, edf) / edf);
        (limit(0.025), limit(0.975))
    }

    /// Degrees of freedom of the overlapping Allan variance: 2σ⁴/var(σ̂²), at least 1.
    pub(super) fn freedom(&self, m: u64, samples: u64) -> f64 {
        let variance = self.allan_variance(m);
        let terms = (samples + 1).saturating_sub(2 * m).max(1);
        let step = (m / STEPS_PER_TAU).max(1);
        let last = (if m > LONGEST_EXACT { REACH * m } else { LONGEST_EXACT * m + 200 }).min(terms - 1);
        let white = if m > LONGEST_EXACT { self.short_variance(m) } else { 0.0 };
        let exact =
            if m > LONGEST_EXACT { Vec::new() } else { self.short_covariances(m as usize, last as usize, step) };
        let sum: f64 = (0..=last / step)
            .map(|index| {
                let lag = index * step;
                let c = self.slow_covariance(lag, m, white) + exact.get(index as usize).unwrap_or(&0.0);
                let twice = if lag == 0 { 1.0 } else { 2.0 };
                twice * step as f64 * (1.0 - lag as f64 / terms as f64) * c * c
            })
            .sum();
        (4.0 * variance * variance * terms as f64 / sum).max(1.0)
    }

    /// Covariance of two differences of averages `lag` samples apart: the fourth difference of the phase's generalised
    /// autocovariance. The short noise enters as white noise of the Allan variance `white`; with 0 it is left out.
    fn slow_covariance(&self, lag: u64, m: u64, white: f64) -> f64 {
        let tau_s = m as f64 / self.rate_hz;
        let phase = |t: f64| {
            let t = libm::fabs(t);
            let log = if t > 0.0 { libm::log(t) } else { 0.0 };
            let markov = |&(variance, c): &(f64, f64)| variance * c * (t - c * (1.0 - libm::exp(-t / c)));
            self.b2 * t * t * log / (2.0 * PI) + self.k2 * t * t * t / 12.0
                - white * tau_s * t / 2.0
                - self.markovs.iter().map(markov).sum::<f64>()
        };
        let lag_s = lag as f64 / self.rate_hz;
        let fourth = [(1.0, -2.0), (-4.0, -1.0), (6.0, 0.0), (-4.0, 1.0), (1.0, 2.0)];
        fourth.iter().map(|(weight, k)| weight * phase(lag_s + k * tau_s)).sum::<f64>() / (tau_s * tau_s)
    }

    /// Covariances of two differences of averages for the short noise and lines, at every `step`-th lag.
    fn short_covariances(&self, m: usize, last: usize, step: u64) -> Vec<f64> {
        let len = last + 4 * m + 2;
        let mut covariance = vec![0.0; len];
        covariance.iter_mut().zip(&self.short).for_each(|(cell, short)| *cell = *short);
        for &(variance, hz) in &self.sines {
            add_cosine(&mut covariance, variance, 2.0 * PI * hz / self.rate_hz);
        }
        // The weights of a difference of averages are ±1/m. The correlation of the weights is piecewise linear.
        let weight = |shift: usize| {
            let (shift, m) = (shift as f64, m as f64);
            if shift < m { (2.0 * m - 3.0 * shift) / (m * m) } else { (shift - 2.0 * m) / (m * m) }
        };
        let at = |lag: usize| {
            let shifted = |shift: usize| covariance[lag + shift] + covariance[lag.abs_diff(shift)];
            weight(0) * covariance[lag] + (1..2 * m).map(|shift| weight(shift) * shifted(shift)).sum::<f64>()
        };
        (0..=last).step_by(step as usize).map(at).collect()
    }

    /// The 95 % band of a deviation that is not the overlapping one, from its degrees of freedom.
    pub(super) fn band_of(&self, m: u64, edf: f64) -> (f64, f64) {
        let dev = libm::sqrt(self.measured_variance(m));
        let (lo, hi) = interval(dev, edf, 0.95);
        (dev * dev / hi, dev * dev / lo)
    }
}

/// Σ (x + k)⁻³ over all k from 0 on. An integral stands for the terms from k = 8 on.
fn inverse_cubes(x: f64) -> f64 {
    const TERMS: u32 = 8;
    let rest = x + f64::from(TERMS) - 0.5;
    (0..TERMS).map(|k| libm::pow(x + f64::from(k), -3.0)).sum::<f64>() + 0.5 / (rest * rest)
}

/// Adds variance·cos(i·angle) to the i-th cell, by recurrence.
fn add_cosine(cells: &mut [f64], variance: f64, angle: f64) {
    let twice = 2.0 * libm::cos(angle);
    let (mut now, mut before) = (variance, variance * libm::cos(angle));
    for cell in cells {
        *cell += now;
        (now, before) = (twice * now - before, now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The Allan variance of single samples is 4/T₀ ∫ S sin²(πu) du from u = 0 to ½, with u = f·T₀.
    #[test]
    fn the_density_of_slow_noise_has_its_allan_variance() {
        let silent = Model {
            rate_hz: 1.0,
            record_s: 1e4,
            short: vec![0.0],
            b2: 0.0,
            k2: 0.0,
            markovs: Vec::new(),
            drift: None,
            sines: Vec::new(),
            thinning: Thinning::default(),
            doubt: PredictionError::default(),
        };
        let flicker = Model { b2: 2.0, ..silent.clone() };
        let walk = Model { k2: 3.0, ..silent.clone() };
        let markov = Model { markovs: vec![(5.0, 40.0)], ..silent };
        for model in [flicker, walk, markov] {
            let steps = 20_000;
            let part = |i: u32| {
                let u = (f64::from(i) + 0.5) / f64::from(2 * steps);
                4.0 * model.slow_density(u) * libm::pow(libm::sin(PI * u), 2.0) / f64::from(2 * steps)
            };
            let (sum, expected) = ((0..steps).map(part).sum::<f64>(), model.allan_variance(1));
            assert!((sum / expected - 1.0).abs() < 2e-3, "{sum} {expected}");
        }
    }
}
