//! Noise coefficients from an Allan deviation curve: N, B, K, and Q and R where the data show them.
//!
//! The model is `σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2` (IEEE Std 952-1997 C.1). The estimates of σ²
//! at octaves of τ are correlated and, at the longest τ, few. Their covariance is computed from the model, for the
//! record's length. The coefficients are its generalised non-negative least squares, iterated until covariance and
//! coefficients agree. Measured error and coverage stand in `docs/reference/allan.md`.
//!
//! ```
//! use zerorate_allan::{Deviation, fit_curve};
//! // An hour at 100 Hz of white noise alone: σ² = N²/τ
//! let curve: Vec<Deviation> = (0..=17)
//!     .map(|k| (1u64 << k, 0.01 / ((1u64 << k) as f64 / 100.0).sqrt()))
//!     .map(|(m, dev)| Deviation { m, dev, n: 360_000 - 2 * m + 1 })
//!     .collect();
//! let fit = fit_curve(&curve, 100.0, 360_000)?;
//! assert!((fit.n.value / 0.01 - 1.0).abs() < 1e-6 && fit.n.identified);
//! assert!(!fit.b.identified && !fit.k.identified);
//! # Ok::<(), zerorate_allan::CurveError>(())
//! ```

mod interval;
mod model;
mod record_length;
mod select;
mod solve;
#[cfg(test)]
mod tests;

use super::{AllanWarning, Deviation, Noise, Point};
use alloc::vec::Vec;
use core::fmt;
use model::{B, K, N, Q, R};
use select::Selection;

/// A noise coefficient with its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coefficient {
    /// Best value, never NaN. N, B, Q and R have the least squares value, which is zero where the best fit has none of
    /// this noise. K rests on few independent differences and has the mean of its confidence distribution, which has
    /// less error and no zeros.
    pub value: f64,
    /// Lower end of the 95 % interval.
    pub lo: f64,
    /// Upper end of the 95 % interval.
    pub hi: f64,
    /// Zero is outside the interval.
    pub identified: bool,
    /// Length of a record, s, in which a coefficient of `value` or `hi / 2`, whichever is more, would be identified in
    /// four of five cases. None where it is identified.
    pub needed_s: Option<f64>,
}

/// Noise coefficients of a record at rest, in the unit of its rate.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveFit {
    /// Angle random walk N, unit·√s: N²/τ. The one-sided density of the white noise is √2·N unit/√Hz.
    pub n: Coefficient,
    /// Bias instability B, unit: (2 ln 2/π)B². The floor of the curve is 0.664·B.
    pub b: Coefficient,
    /// Rate random walk K, unit/√s: K²τ/3.
    pub k: Coefficient,
    /// Angle quantisation Q, unit·s: 3Q²/τ²; only where significant.
    pub q: Option<Coefficient>,
    /// Rate ramp R, unit/s: R²τ²/2; only where significant.
    pub r: Option<Coefficient>,
    /// Shortest and longest averaging time that entered, s.
    pub span_s: (f64, f64),
    /// Sum of squared residuals, decorrelated by the model's covariance: χ² with `freedom` degrees of freedom.
    pub chi2: f64,
    /// Points less coefficients.
    pub freedom: usize,
    /// The warnings about this curve.
    pub warnings: Vec<AllanWarning>,
}

impl CurveFit {
    /// The fitted Allan variance at τ, unit²: the model with the coefficients' values.
    #[must_use]
    pub fn allan_variance(&self, tau_s: f64) -> f64 {
        let square = |coefficient: &Coefficient| coefficient.value * coefficient.value;
        let optional = |coefficient: &Option<Coefficient>| coefficient.as_ref().map_or(0.0, square);
        let squares = [optional(&self.q), square(&self.n), square(&self.b), square(&self.k), optional(&self.r)];
        model::variance(&squares, tau_s)
    }
}

/// Why there are no coefficients.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum CurveError {
    /// Fewer usable averaging times than the fit needs. A deviation of zero is not usable.
    TooFew {
        /// Usable averaging times that are at least an octave apart.
        points: usize,
        /// How many are needed.
        needed: usize,
    },
    /// No noise model explains the curve: its values are too far apart for f64.
    Degenerate,
}

impl fmt::Display for CurveError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { points, needed } => write!(
                f,
                "{points} averaging times with a deviation, at least an octave apart, are too few for noise \
                 coefficients; {needed} are needed: record longer, and check that the readings change"
            ),
            Self::Degenerate => write!(f, "no noise explains this curve; check the unit and the readings"),
        }
    }
}

impl core::error::Error for CurveError {}

/// Fits the coefficients to an overlapping Allan deviation of `samples` rate samples (lost ones included) at
/// `rate_hz`. It takes points of [`Stat::Oadev`](super::Stat) only.
///
/// `n` of a point is the terms that entered. Where gaps left fewer than the record's length has, the point counts for
/// less. From points closer than an octave it takes every one that is an octave above the last taken. The intervals
/// hold for noise that the model describes. A warning says where the curve does not follow it.
///
/// # Errors
///
/// [`CurveError`] for fewer than four usable points, or numbers beyond the range of f64.
pub fn fit_curve(points: &[Deviation], rate_hz: f64, samples: u64) -> Result<CurveFit, CurveError> {
    let curve = select::curve(points, rate_hz, samples)?;
    let full_start_s = curve.geometry.tau_s(0);
    let chosen = select::select(curve).ok_or(CurveError::Degenerate)?;
    let optional = |which| {
        (chosen.model.has[which] && !(which == Q && chosen.model.rolls_off)).then(|| coefficient(&chosen, which))
    };
    let at = &chosen.curve.geometry;
    let (chi2, freedom) = chosen.chi2();
    let mut fit = CurveFit {
        n: coefficient(&chosen, N),
        b: coefficient(&chosen, B),
        k: coefficient(&chosen, K),
        q: optional(Q),
        r: optional(R),
        span_s: (at.tau_s(0), at.tau_s(at.m.len() - 1)),
        chi2,
        freedom,
        warnings: Vec::new(),
    };
    fit.warnings = warnings(&fit, &chosen, full_start_s);
    Ok(fit)
}

impl From<&Point> for Deviation {
    fn from(point: &Point) -> Self {
        Self { m: point.m, dev: point.dev, n: point.n }
    }
}

fn coefficient(chosen: &Selection, which: usize) -> Coefficient {
    let Selection { curve, model, best, .. } = chosen;
    let (lo, hi) = interval::interval(curve, model, best, which);
    let (lo, hi, best_value) = (libm::sqrt(lo), libm::sqrt(hi), libm::sqrt(best[which].max(0.0)));
    let value = if which == K { interval::confidence_mean(curve, model, best, which, hi * hi) } else { best_value };
    let identified = lo > 0.0;
    let needed_s = (!identified).then(|| {
        let mut truth = *best;
        let taken = value.max(hi / 2.0);
        truth[which] = taken * taken;
        record_length::needed_s(curve, model, &truth, which)
    });
    Coefficient { value, lo: lo.min(value), hi: hi.max(value), identified, needed_s }
}

/// χ² beyond this many standard deviations above its mean means that the model does not describe the curve.
const MISFIT_LIMIT: f64 = 6.0;

fn warnings(fit: &CurveFit, chosen: &Selection, full_start_s: f64) -> Vec<AllanWarning> {
    let at = &chosen.curve.geometry;
    let record_s = at.samples / at.rate_hz;
    let mut warnings = Vec::new();
    if chosen.model.rolls_off {
        warnings.push(AllanWarning::ShortEndExcluded {
            points: chosen.excluded,
            from_s: full_start_s,
            used_from_s: fit.span_s.0,
        });
    }
    if let Some(q) = fit.q {
        let below_s = 3.0 * q.value * q.value / (fit.n.value * fit.n.value).max(f64::MIN_POSITIVE);
        warnings.push(AllanWarning::QuantisationLimited { q: q.value, below_s: below_s.min(fit.span_s.1) });
    }
    if let Some(r) = fit.r {
        warnings.push(AllanWarning::Drift { r: r.value, over_record: r.value * record_s });
    }
    let excess = (fit.chi2 - fit.freedom as f64) / libm::sqrt(2.0 * fit.freedom as f64);
    match chosen.hump() {
        Some(hump) => warnings.push(AllanWarning::Periodic {
            tau_s: at.tau_s(hump.index),
            ratio: libm::sqrt(hump.ratio),
            frequency_hz: SINE_HUMP / at.tau_s(hump.index),
        }),
        None if excess > MISFIT_LIMIT => warnings.push(AllanWarning::Misfit { chi2: fit.chi2, freedom: fit.freedom }),
        None => {}
    }
    let coefficients =
        [(Noise::AngleRandomWalk, fit.n), (Noise::BiasInstability, fit.b), (Noise::RateRandomWalk, fit.k)];
    let missing = coefficients.into_iter().filter_map(|(noise, c)| Some((noise, c.needed_s?)));
    warnings.extend(missing.map(|(noise, needed_s)| AllanWarning::NotIdentified { noise, record_s, needed_s }));
    warnings
}

/// A sine of frequency f lifts the Allan variance by A² sin⁴(πfτ)/(πfτ)², most at fτ = 0.371 (IEEE Std 952-1997
/// C.1.7).
const SINE_HUMP: f64 = 0.371;
