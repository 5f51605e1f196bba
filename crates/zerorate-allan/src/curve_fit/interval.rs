//! Intervals by inversion: every value of a coefficient that the data do not reject.

use super::model::Coefficients;
use super::solve::{Curve, Linear, Model, Problem, iterate};

/// Standard normal quantile at 97.5 %.
const TWO_SIDED_95: f64 = 1.959963984540054;
/// Halvings of an interval's end, and doublings until it is enclosed.
const HALVINGS: usize = 30;
const DOUBLINGS: usize = 60;
/// The confidence distribution is integrated in this many cells, up to this multiple of the interval's upper end.
const CELLS: u32 = 24;
const BEYOND_THE_INTERVAL: f64 = 1.6;
/// Beyond this skewness, Wilson and Hilferty's cube root no longer follows the gamma distribution.
const MOST_SKEWED: f64 = 3.0;
/// Below this, the distribution is normal.
const LEAST_SKEWED: f64 = 1e-6;

/// The ends of the 95 % interval of a coefficient of the Allan variance, none negative.
///
/// A value is tested by the estimate that is unbiased if the value is true. It is inside the interval when that
/// estimate lies within the 2.5 % and 97.5 % quantiles of its distribution. Variance and skewness belong to the tested
/// value, not to the one that was found, because both grow with it.
pub(super) fn interval(curve: &Curve, model: &Model, best: &Coefficients, which: usize) -> (f64, f64) {
    let test = |value: f64| tested(curve, model, best, which, value);
    let step = test(best[which]).map_or(0.0, |at| at.sd);
    let too_high =
        |value: f64| test(value).is_some_and(|at| at.value - value < at.sd * quantile(-TWO_SIDED_95, at.skewness));
    let too_low =
        |value: f64| test(value).is_some_and(|at| at.value - value > at.sd * quantile(TWO_SIDED_95, at.skewness));
    (lower(best[which], step, too_low), upper(best[which], step, too_high))
}

/// Mean of √coefficient over its confidence distribution, ∫ (1 − H(K)) dK. H at a value is the probability of an
/// estimate above the one found if the value were true. Unlike the best fit the mean is never zero, and its error is
/// smaller.
pub(super) fn confidence_mean(curve: &Curve, model: &Model, best: &Coefficients, which: usize, hi: f64) -> f64 {
    let width = BEYOND_THE_INTERVAL * libm::sqrt(hi) / f64::from(CELLS);
    let below = |cell: u32| {
        let value = width * (f64::from(cell) + 0.5);
        let at = tested(curve, model, best, which, value * value);
        at.map_or(0.0, |at| probability((at.value - value * value) / at.sd, at.skewness))
    };
    (0..CELLS).map(below).sum::<f64>() * width
}

/// The estimate of `which` with the weights that hold if its true value is `value`.
pub(super) fn tested(curve: &Curve, model: &Model, best: &Coefficients, which: usize, value: f64) -> Option<Linear> {
    let mut start = *best;
    start[which] = value;
    let null = iterate(curve, model, Some((which, value)), Some(start))?;
    Problem::new(curve, &null)?.linear(model, which)
}

/// Quantile of a standardised gamma distribution of the given skewness, by Wilson and Hilferty. `z` is the normal
/// quantile.
pub(super) fn quantile(z: f64, skewness: f64) -> f64 {
    let g = skewness.clamp(-MOST_SKEWED, MOST_SKEWED);
    if g.abs() < LEAST_SKEWED {
        return z;
    }
    let root = 1.0 + g * z / 6.0 - g * g / 36.0;
    2.0 / g * (root * root * root - 1.0)
}

/// Distribution function of the same distribution: the inverse of [`quantile`].
fn probability(x: f64, skewness: f64) -> f64 {
    let g = skewness.clamp(-MOST_SKEWED, MOST_SKEWED);
    let z = match g.abs() < LEAST_SKEWED {
        true => x,
        false => (libm::cbrt((1.0 + g * x / 2.0).max(0.0)) - 1.0 + g * g / 36.0) * 6.0 / g,
    };
    libm::erfc(-z / core::f64::consts::SQRT_2) / 2.0
}

fn lower(best: f64, step: f64, too_low: impl Fn(f64) -> bool) -> f64 {
    let mut inside = best;
    let mut below = best - step;
    for _ in 0..DOUBLINGS {
        if below <= 0.0 || too_low(below) {
            break;
        }
        inside = below;
        below = best - 2.0 * (best - below);
    }
    if below <= 0.0 && !too_low(0.0) {
        return 0.0;
    }
    halve(inside, below.max(0.0), too_low)
}

fn upper(best: f64, step: f64, too_high: impl Fn(f64) -> bool) -> f64 {
    let mut inside = best;
    let mut above = best + step;
    for _ in 0..DOUBLINGS {
        if too_high(above) {
            return halve(inside, above, too_high);
        }
        inside = above;
        above = best + 2.0 * (above - best);
    }
    above
}

/// The border between a value inside and one outside.
fn halve(mut inside: f64, mut outside: f64, is_out: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = (inside + outside) / 2.0;
        if (inside - outside).abs() <= 1e-4 * middle {
            break;
        }
        if is_out(middle) { outside = middle } else { inside = middle }
    }
    (inside + outside) / 2.0
}
