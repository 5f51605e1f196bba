//! The lag of a sensor, estimated from all its axes together.
//!
//! The axes of one sensor lie on one chip beside one thermometer, so most likely they have one lag. The likelihoods of
//! the other axes are a prior for each axis, mixed with a prior that ignores them, because an axis may differ.

use alloc::vec::Vec;

/// Probability that an axis has the lag of the other axes.
const COMMON: f64 = 0.9;
/// Exponent that flattens the likelihoods of other axes. They are too sharp, because each is computed under the noise
/// of the best model alone.
const TRUST: f64 = 0.5;
/// Lower limit of the log likelihoods, relative to that of the best lag.
const FLOOR: f64 = -30.0;
/// Number of lags, evenly spaced in logarithm, at which priors are computed.
const PLACES: usize = 200;

/// The logarithm of the likelihood of one axis over the lag, less that of the best lag.
#[derive(Clone, Debug, PartialEq)]
pub struct LagLikelihood {
    /// Lags, s, in rising order from 0, each with the logarithm of the likelihood.
    points: Vec<(f64, f64)>,
}

impl LagLikelihood {
    /// Makes the likelihood from its logarithms at some lags.
    pub(super) fn new(mut points: Vec<(f64, f64)>) -> Self {
        let best = points.iter().map(|(_, score)| *score).fold(f64::NEG_INFINITY, f64::max);
        points.iter_mut().for_each(|(_, score)| *score = (*score - best).max(FLOOR));
        Self { points }
    }

    /// Log likelihood at a lag, by linear interpolation over the logarithm of the lag.
    fn at(&self, lag_s: f64) -> f64 {
        let above = self.points.iter().position(|(lag, _)| *lag >= lag_s).unwrap_or(self.points.len() - 1);
        let (high_s, high) = self.points[above];
        let (low_s, low) = self.points[above.saturating_sub(1)];
        if low_s <= 0.0 || high_s <= low_s {
            return high;
        }
        low + (high - low) * (libm::log(lag_s / low_s) / libm::log(high_s / low_s)).clamp(0.0, 1.0)
    }
}

/// The prior of a lag: half of the probability is on 0, and half is spread evenly over the logarithm of the lag. The
/// other axes contribute a factor.
#[derive(Clone, Debug)]
pub(super) struct LagPrior<'a> {
    others: &'a [&'a LagLikelihood],
    /// Logarithm of the likelihood of the other axes, averaged over the prior without them.
    log_mean: f64,
}

impl<'a> LagPrior<'a> {
    pub(super) fn new(others: &'a [&'a LagLikelihood], (least_s, most_s): (f64, f64)) -> Self {
        let prior = Self { others, log_mean: 0.0 };
        let ratio = libm::pow(most_s / least_s, 1.0 / (PLACES - 1) as f64);
        let late = (0..PLACES).map(|k| libm::exp(prior.of_others(least_s * libm::pow(ratio, k as f64))));
        let mean = 0.5 * libm::exp(prior.of_others(0.0)) + 0.5 * late.sum::<f64>() / PLACES as f64;
        Self { log_mean: libm::log(mean.max(f64::MIN_POSITIVE)), ..prior }
    }

    fn of_others(&self, lag_s: f64) -> f64 {
        TRUST * self.others.iter().map(|other| other.at(lag_s)).sum::<f64>()
    }

    /// The logarithm of the factor by which the other axes change the prior of a lag.
    pub(super) fn log_factor(&self, lag_s: f64) -> f64 {
        if self.others.is_empty() {
            return 0.0;
        }
        libm::log(1.0 - COMMON + COMMON * libm::exp(self.of_others(lag_s) - self.log_mean))
    }
}
