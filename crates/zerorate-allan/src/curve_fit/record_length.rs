//! The length of a record in which a coefficient is identified.

use super::interval::quantile;
use super::model::{Coefficients, Covariance, Geometry};
use super::solve::{Curve, Model, Problem};

/// Doublings of the record that are computed. Beyond, the error is taken to fall with the root of the length.
const DOUBLINGS: i32 = 8;
/// Standard normal quantiles at 97.5 % and 80 %.
const TWO_SIDED_95: f64 = 1.959963984540054;
const POWER_80: f64 = 0.8416212335729143;

/// The length of a record in which zero would be outside the 95 % interval in four of five cases, s.
///
/// `truth` holds the assumed size of the coefficient. The length is interpolated between two doublings, linear in
/// logarithms.
pub(super) fn needed_s(curve: &Curve, model: &Model, truth: &Coefficients, which: usize) -> f64 {
    let length_s = curve.geometry.samples / curve.geometry.rate_hz;
    let mut before = strength(curve, model, truth, which).unwrap_or(0.0);
    for doublings in 1..=DOUBLINGS {
        let now = strength(&longer(curve, doublings), model, truth, which).unwrap_or(0.0).max(before);
        if now >= 1.0 {
            let part = if before > 0.0 && before < 1.0 { -libm::log(before) / libm::log(now / before) } else { 1.0 };
            return length_s * libm::exp2(f64::from(doublings - 1) + part);
        }
        before = now;
    }
    let short_of = 1.0 / before.max(1e-3);
    length_s * libm::exp2(f64::from(DOUBLINGS)) * short_of * short_of
}

/// The coefficient over the size that would be identified in four of five cases.
fn strength(curve: &Curve, model: &Model, truth: &Coefficients, which: usize) -> Option<f64> {
    let mut null = *truth;
    null[which] = 0.0;
    let absent = Problem::new(curve, &null)?.linear(model, which)?;
    let present = Problem::new(curve, truth)?.linear(model, which)?;
    Some(truth[which] / (absent.sd * quantile(TWO_SIDED_95, absent.skewness) + POWER_80 * present.sd))
}

/// The same recording, 2ⁿ times as long, with the further octaves that it would have.
fn longer(curve: &Curve, doublings: i32) -> Curve {
    let now = &curve.geometry;
    let samples = now.samples * libm::exp2(f64::from(doublings));
    let present = now.terms[0] / (now.samples - 2.0 * now.m[0] + 1.0).max(1.0);
    let last = now.m.last().copied().unwrap_or(1.0);
    let further = core::iter::successors(Some(2.0 * last), |m| Some(2.0 * m)).take_while(|m| 2.0 * m <= samples);
    let m: alloc::vec::Vec<f64> = now.m.iter().copied().chain(further).collect();
    let terms = m.iter().map(|m| present * (samples - 2.0 * m + 1.0)).collect();
    let geometry = Geometry { rate_hz: now.rate_hz, samples, m, terms };
    let covariance = Covariance::new(&geometry);
    let variance = alloc::vec![0.0; geometry.m.len()];
    Curve { geometry, variance, covariance }
}
