//! N and K for a filter that knows white noise and a random walk only.
//!
//! Such a filter believes a variance of N²/τ + K²τ/3. Where the curve of the sensor is above that (flicker, a memory),
//! the filter is too sure of itself. So N and K are chosen together: they cover the curve, with the least excess.

use super::Fit;
use crate::Deviation;
use alloc::vec::Vec;

/// The shortest averaging time that is covered, s.
const FROM_S: f64 = 1.0;
/// The longest one, unless it is given: this share of the record, and at most this time, s.
const HORIZON: f64 = 1.0 / 3.0;
const MOST_HORIZON_S: f64 = 1000.0;
/// N may grow up to this many times, in steps of N².
const MOST_GROWTH: f64 = 2.0;
const STEPS: u32 = 60;

/// N and K that cover the curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covering {
    /// White noise, unit·√s.
    pub n: f64,
    /// Random walk, unit/√s.
    pub k: f64,
    /// The longest averaging time that is covered, s. The shortest is 1 s.
    pub horizon_s: f64,
    /// The geometric mean of the variance that they claim over that of the curve.
    pub excess: f64,
}

impl Fit {
    /// The N, from the fitted one to twice as much, and the K with which N²/τ + K²τ/3 is at least the Allan variance
    /// from 1 s to `horizon_s`, with the least mean excess of its logarithm. The Allan variance is the model's, or the
    /// measured one where that lies outside the 95 % band of the model. Unless it is given, the horizon is a third of
    /// the record and at most 1000 s. None where there is no point between.
    ///
    /// docs/imu.md shows how sure a filter with these numbers is, and with those that are fitted.
    #[must_use]
    pub fn covering(&self, horizon_s: Option<f64>) -> Option<Covering> {
        let (dt_s, half_s) = self.span_s;
        let horizon_s = horizon_s.unwrap_or((2.0 * half_s * HORIZON).min(MOST_HORIZON_S));
        let of_record = self.curve.iter().map(|found| (found.m as f64 * dt_s, self.variance(found)));
        let inside: Vec<(f64, f64)> = of_record.filter(|(tau_s, _)| (FROM_S..=horizon_s).contains(tau_s)).collect();
        let of = |step: u32| {
            let n2 = self.n.value
                * self.n.value
                * (1.0 + (MOST_GROWTH * MOST_GROWTH - 1.0) * f64::from(step) / f64::from(STEPS));
            let lacks = |&(tau_s, variance): &(f64, f64)| (variance - n2 / tau_s) * 3.0 / tau_s;
            let k2 = inside.iter().map(lacks).fold(0.0, f64::max);
            let log = |&(tau_s, variance): &(f64, f64)| libm::log((n2 / tau_s + k2 * tau_s / 3.0) / variance);
            let excess = libm::exp(inside.iter().map(log).sum::<f64>() / inside.len() as f64);
            Covering { n: libm::sqrt(n2), k: libm::sqrt(k2), horizon_s, excess }
        };
        let best = (0..=STEPS).map(of).min_by(|a, b| a.excess.total_cmp(&b.excess));
        best.filter(|_| !inside.is_empty())
    }

    /// The Allan variance of the sensor at the averaging time of a measured point.
    fn variance(&self, found: &Deviation) -> f64 {
        let (lo, hi) = self.model.band(found.m, found.n, self.model.samples() as u64);
        let by_chance = (lo..=hi).contains(&found.dev);
        if by_chance { self.model.allan_variance(found.m) } else { found.dev * found.dev }
    }
}
