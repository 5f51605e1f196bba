//! N and K for estimators that model only white noise and a random walk.
//!
//! Such an estimator assumes an Allan variance of N²/τ + K²τ/3. If the noise of the sensor is larger (flicker,
//! correlated noise), the estimator is overconfident. So N and K are raised until they cover the noise from 1 s to a
//! horizon. For a filter they cover all of its variance. For a batch estimator K alone is raised and covers nine
//! tenths. Lines, a drift and a warm-up are not noise, and are left out.

use super::Fit;
use crate::Deviation;
use alloc::vec::Vec;

/// The shortest averaging time that is covered, s.
const FROM_S: f64 = 1.0;
/// The default horizon is at most this share of the record.
const HORIZON: f64 = 1.0 / 3.0;
const STEPS: u32 = 60;

/// The way in which an estimator uses N and K.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Usage {
    /// A filter that runs for long: N may grow to twice the fitted N, and the default horizon is at most 1000 s.
    Filter,
    /// A batch estimator over a minute or two: N is the fitted N, K is raised from the fitted K (from 0 if that is not
    /// identified) until nine tenths of the variance are covered, and the default horizon is at most 100 s.
    Batch,
}

impl Usage {
    /// The longest default horizon, s, the largest factor on N, and the share of the variance that is covered. With a
    /// fixed N, K alone would have to cover the last percent at the shortest averages, and would be many times too
    /// large for the longest.
    const fn limits(self) -> (f64, f64, f64) {
        match self {
            Self::Filter => (1000.0, 2.0, 1.0),
            Self::Batch => (100.0, 1.0, 0.9),
        }
    }
}

/// N and K that overbound the noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covering {
    /// White noise N, unit·√s.
    pub n: f64,
    /// Random walk K, unit/√s.
    pub k: f64,
    /// The longest averaging time that is covered, s. The shortest is 1 s.
    pub horizon_s: f64,
    /// Geometric mean of the ratio of N²/τ + K²τ/3 to the variance of the noise.
    pub excess: f64,
}

impl Fit {
    /// The N and K with which N²/τ + K²τ/3 covers the Allan variance of the noise (for [`Usage::Batch`] nine tenths of
    /// the variance) from 1 s to `horizon_s`, with the least mean excess in logarithm. The variance is the model's
    /// without lines, drift and warm-up, or the measured one if that is outside the 95 % band of the model. The
    /// default horizon is a third of the record, and at most the horizon of the usage. A given horizon is covered
    /// itself, by the model, and should be at most half of the record: the model does not cover longer times. `None`
    /// if no averaging time of the curve lies in the range.
    ///
    /// docs/imu.md compares the errors of estimators with the errors that these estimators expect, once with the
    /// raised N and K and once with the fitted ones.
    #[must_use]
    pub fn covering(&self, usage: Usage, horizon_s: Option<f64>) -> Option<Covering> {
        let (dt_s, half_s) = self.span_s;
        let (most_horizon_s, most_growth, covered) = usage.limits();
        let until_s = horizon_s.unwrap_or((2.0 * half_s * HORIZON).min(most_horizon_s));
        let of_record = self.curve.iter().map(|found| (found.m as f64 * dt_s, self.noise_variance(found)));
        let is_inside = |(tau_s, _): &(f64, f64)| (FROM_S..=until_s).contains(tau_s);
        let mut inside: Vec<(f64, f64)> = of_record.filter(is_inside).collect();
        if !inside.is_empty() {
            let modelled = |tau_s: f64| (tau_s, self.model.noise_variance(libm::round(tau_s / dt_s) as u64));
            inside.extend(horizon_s.map(modelled));
        }
        let is_lifted = usage == Usage::Batch && self.k.identified;
        let least = if is_lifted { self.k.value * self.k.value } else { 0.0 };
        let growth = most_growth * most_growth - 1.0;
        let of = |step: u32| {
            let n2 = self.n.value * self.n.value * (1.0 + growth * f64::from(step) / f64::from(STEPS));
            let lacks = |&(tau_s, variance): &(f64, f64)| (covered * variance - n2 / tau_s) * 3.0 / tau_s;
            let k2 = inside.iter().map(lacks).fold(least, f64::max);
            let log = |&(tau_s, variance): &(f64, f64)| libm::log((n2 / tau_s + k2 * tau_s / 3.0) / variance);
            let excess = libm::exp(inside.iter().map(log).sum::<f64>() / inside.len() as f64);
            Covering { n: libm::sqrt(n2), k: libm::sqrt(k2), horizon_s: until_s, excess }
        };
        let best = (0..=STEPS).map(of).min_by(|a, b| a.excess.total_cmp(&b.excess));
        best.filter(|_| !inside.is_empty())
    }

    /// The Allan variance of the sensor's noise at the averaging time of a measured point. This is the model's
    /// variance if the point is in its 95 % band, or if lines and drift make up most of the point. Otherwise it is the
    /// measured variance without the share of lines and drift.
    fn noise_variance(&self, found: &Deviation) -> f64 {
        let (whole, noise) = (self.model.allan_variance(found.m), self.model.noise_variance(found.m));
        let (lo, hi) = self.model.band(found.m, found.n, self.model.samples() as u64);
        let by_chance = (lo..=hi).contains(&found.dev);
        if by_chance || whole > 2.0 * noise { noise } else { found.dev * found.dev * noise / whole }
    }
}
