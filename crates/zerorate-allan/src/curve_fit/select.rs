//! Selection of the points and the terms of the fit.

use super::super::Deviation;
use super::CurveError;
use super::interval::quantile;
use super::model::{Coefficients, Covariance, Geometry, Q, R};
use super::solve::{Curve, Model, Problem, iterate};
use alloc::vec::Vec;

/// Averaging times that the fit needs: three coefficients and one to spare.
pub(super) const FEWEST_POINTS: usize = 4;
/// With fewer averaging times the fit looks for no further term, and leaves out no further point.
const POINTS_FOR_MORE: usize = 6;
/// Quantisation and roll-off are believed at this many standard deviations. The same holds for each point that a
/// low-pass bends.
const SHORT_END_LIMIT: f64 = 4.0;
/// A ramp is believed at this many (normal equivalent) standard deviations.
const RAMP_LIMIT: f64 = 3.3;
/// A point that lies this many (normal equivalent) standard deviations above the others' fit is a hump.
const HUMP_LIMIT: f64 = 5.0;
/// Relative variance beyond which a point says nothing about a low-pass.
const MOST_UNCERTAIN: f64 = 0.05;

/// The terms that the data show, with the points that they hold for.
#[derive(Clone, Debug)]
pub(super) struct Selection {
    pub(super) curve: Curve,
    pub(super) model: Model,
    pub(super) best: Coefficients,
    /// Points left out at the short end.
    pub(super) excluded: usize,
}

/// A point far above what the others explain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hump {
    pub(super) index: usize,
    /// Squared deviation over the fitted one.
    pub(super) ratio: f64,
}

/// Points at least an octave apart, from the shortest averaging time.
pub(super) fn curve(points: &[Deviation], rate_hz: f64, samples: u64) -> Result<Curve, CurveError> {
    let mut usable: Vec<&Deviation> =
        points.iter().filter(|p| p.m > 0 && p.n > 0 && p.dev.is_finite() && p.dev > 0.0).collect();
    usable.sort_by_key(|p| p.m);
    let mut kept: Vec<&Deviation> = Vec::new();
    for point in usable {
        if kept.last().is_none_or(|last| point.m / 2 >= last.m) {
            kept.push(point);
        }
    }
    if kept.len() < FEWEST_POINTS {
        return Err(CurveError::TooFew { points: kept.len(), needed: FEWEST_POINTS });
    }
    let geometry = Geometry {
        rate_hz,
        samples: samples as f64,
        m: kept.iter().map(|p| p.m as f64).collect(),
        terms: kept.iter().map(|p| p.n as f64).collect(),
    };
    let covariance = Covariance::new(&geometry);
    Ok(Curve { geometry, variance: kept.iter().map(|p| p.dev * p.dev).collect(), covariance })
}

/// Fits N, B and K, and the significant terms beside them. None where no covariance can be inverted.
pub(super) fn select(curve: Curve) -> Option<Selection> {
    let (curve, bent) = without_bent_points(curve);
    let plain = Selection { excluded: bent, ..Selection::of(curve, [false, true, true, true, false], false)? };
    let mut chosen = plain.clone();
    if chosen.curve.variance.len() < POINTS_FOR_MORE {
        return Some(chosen);
    }
    let free =
        Selection { excluded: bent, ..Selection::of(chosen.curve.clone(), [true, true, true, true, false], true)? };
    let quantisation = free.score(Q, SHORT_END_LIMIT)?;
    if bent > 0 || quantisation < -SHORT_END_LIMIT {
        chosen = free.without_short_end()?;
    } else if quantisation > SHORT_END_LIMIT {
        chosen = Selection::of(chosen.curve, [true, true, true, true, false], false)?;
    }
    if chosen.score(R, RAMP_LIMIT)? > RAMP_LIMIT {
        let (has, rolls_off, excluded) = (chosen.model.has, chosen.model.rolls_off, chosen.excluded);
        let ramp = Selection::of(chosen.curve, [has[Q], true, true, true, true], rolls_off)?;
        chosen = Selection { excluded, ..ramp };
    }
    // A disturbance looks like any term that lifts the curve beside it. Where a hump remains, the terms do not explain
    // anything.
    let in_vain = !chosen.model.rolls_off && chosen.model != plain.model && chosen.hump().is_some();
    Some(if in_vain { plain } else { chosen })
}

impl Selection {
    fn of(curve: Curve, has: [bool; 5], rolls_off: bool) -> Option<Self> {
        let model = Model { has, rolls_off };
        let best = iterate(&curve, &model, None, None)?;
        Some(Self { curve, model, best, excluded: 0 })
    }

    /// The estimate of a coefficient in a model that has it, in standard deviations. It is scaled so that `limit`
    /// means the same as for a normal estimate.
    fn score(&self, which: usize, limit: f64) -> Option<f64> {
        let at = Problem::new(&self.curve, &self.best)?.linear(&self.model, which)?;
        let raw = at.value / at.sd;
        Some(raw * limit / quantile(limit * raw.signum(), at.skewness).abs())
    }

    /// Handles white noise behind a low-pass: its Allan variance is N²/τ − c/τ² for τ well above the filter's memory,
    /// so a free term in τ⁻² follows it. Shorter averages leave until the first one agrees with the others.
    fn without_short_end(mut self) -> Option<Self> {
        loop {
            let (pulls, _) = Problem::new(&self.curve, &self.best)?.misfit(&self.model, &self.best);
            if pulls[0].abs() < SHORT_END_LIMIT || self.curve.variance.len() <= POINTS_FOR_MORE {
                return Some(self);
            }
            let shorter = Self::of(self.curve.without_first(), self.model.has, true)?;
            self = Self { excluded: self.excluded + 1, ..shorter };
        }
    }

    /// The point that lies farthest above the others' fit, where that is far.
    pub(super) fn hump(&self) -> Option<Hump> {
        let (pulls, _) = Problem::new(&self.curve, &self.best)?.misfit(&self.model, &self.best);
        let sigma = self.curve.covariance.of(&self.best);
        let fitted = |i: usize| super::model::variance(&self.best, self.curve.geometry.tau_s(i));
        let skewness = |i: usize| 2.0 * libm::sqrt(sigma.at(i, i)) / fitted(i);
        let beyond = |i: usize| pulls[i] / quantile(HUMP_LIMIT, skewness(i));
        let index = (0..pulls.len()).max_by(|&a, &b| beyond(a).total_cmp(&beyond(b)))?;
        let hump = Hump { index, ratio: self.curve.variance[index] / fitted(index) };
        (beyond(index) > 1.0).then_some(hump)
    }

    /// χ² of the fit and its degrees of freedom.
    pub(super) fn chi2(&self) -> (f64, usize) {
        let problem = Problem::new(&self.curve, &self.best);
        let chi2 = problem.map_or(0.0, |problem| problem.misfit(&self.model, &self.best).1);
        (chi2, self.curve.variance.len() - self.model.has.iter().filter(|&&has| has).count())
    }
}

impl Curve {
    fn without_first(&self) -> Self {
        let mut geometry = self.geometry.clone();
        geometry.m.remove(0);
        geometry.terms.remove(0);
        let covariance = Covariance::new(&geometry);
        Self { geometry, variance: self.variance[1..].to_vec(), covariance }
    }
}

/// Leaves out averages that a low-pass bends, and returns their number beside the rest. ln σ²τ is convex in ln τ for
/// every sum of the five noises. Behind a low-pass it rises from the first octave on and then bends level: the
/// averages up to there leave. (At a hump it bends down.)
fn without_bent_points(mut curve: Curve) -> (Curve, usize) {
    let spare = curve.variance.len().saturating_sub(POINTS_FOR_MORE);
    let bent =
        if rises(&curve, 0) { (0..spare).rev().find(|&i| bends_level(&curve, i)).map_or(0, |i| i + 1) } else { 0 };
    (0..bent).for_each(|_| curve = curve.without_first());
    (curve, bent)
}

/// The rise of ln σ²τ from one point to the next, per octave, and its variance.
fn rise(curve: &Curve, i: usize) -> (f64, f64) {
    let at = &curve.geometry;
    let level = |i: usize| libm::log(curve.variance[i] * at.tau_s(i));
    let octaves = libm::log2(at.m[i + 1] / at.m[i]);
    (
        (level(i + 1) - level(i)) / octaves,
        (relative_variance(at, i) + relative_variance(at, i + 1)) / (octaves * octaves),
    )
}

/// Relative variance of an Allan variance: 2/edf, to within a third.
fn relative_variance(at: &Geometry, i: usize) -> f64 {
    (2.0 * at.m[i] + 1.0) / at.terms[i]
}

fn rises(curve: &Curve, i: usize) -> bool {
    let (rise, variance) = rise(curve, i);
    rise > SHORT_END_LIMIT * libm::sqrt(variance)
}

fn bends_level(curve: &Curve, i: usize) -> bool {
    let ((first, before), (second, after)) = (rise(curve, i), rise(curve, i + 1));
    let is_level = second > -libm::sqrt(after);
    let bends = first - second > SHORT_END_LIMIT * libm::sqrt(before + after);
    bends && is_level && rises(curve, i) && relative_variance(&curve.geometry, i + 2) < MOST_UNCERTAIN
}
