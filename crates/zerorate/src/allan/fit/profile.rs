//! Intervals from the profile of the likelihood: every value that costs less than the 5 % point of χ² with one degree of
//! freedom, all other parameters fitted again.

use super::scoring::{Found, Problem};
use crate::allan::linear::{Cholesky, Square};

/// √3.84: the normal quantile at 97.5 %.
const TWO_SIDED_95: f64 = 1.959963984540054;
/// How near to it an end is found, steps until it is, and doublings until it is enclosed.
const NEAR: f64 = 2e-3;
const STEPS: usize = 16;
const DOUBLINGS: usize = 40;
/// The confidence distribution is integrated in so many cells, up to this multiple of the interval's upper end.
const CELLS: u32 = 24;
const BEYOND_THE_INTERVAL: f64 = 1.6;
/// A descent beside the best parameters.
const BESIDE: (usize, f64) = (30, 1e-4);

/// The likelihood along one parameter.
pub(super) struct Profile<'a> {
    pub(super) problem: &'a Problem,
    pub(super) best: &'a Found,
    pub(super) place: usize,
    /// What the parameter cannot leave.
    pub(super) bounds: (f64, f64),
}

impl Profile<'_> {
    fn value(&self) -> f64 {
        self.best.at[self.place]
    }

    /// √(D − D_min) with the parameter held.
    fn root(&self, value: f64) -> f64 {
        let mut start = self.best.at.clone();
        start[self.place] = value;
        let found = self.problem.descend(self.best.form, &start, Some(self.place), BESIDE);
        libm::sqrt((found.deviance - self.best.deviance).max(0.0))
    }

    /// The ends of the 95 % interval.
    pub(super) fn interval(&self) -> (f64, f64) {
        let step = self.step();
        (self.end(-step), self.end(step))
    }

    /// The standard deviation that the curvature suggests.
    fn step(&self) -> f64 {
        let curvature = self.problem.curvature(self.best);
        let own = curvature.at(self.place, self.place).max(f64::MIN_POSITIVE);
        let conditional = 1.0 / libm::sqrt(own / 2.0);
        let variance = marginal_variance(&curvature, self.place);
        variance.map_or(conditional, libm::sqrt).clamp(conditional, 10.0 * conditional)
    }

    fn end(&self, step: f64) -> f64 {
        let bound = if step < 0.0 { self.bounds.0 } else { self.bounds.1 };
        let within = |value: f64| value.clamp(self.bounds.0, self.bounds.1);
        let (mut inside, mut inside_root) = (self.value(), 0.0);
        let (mut outside, mut reach) = (within(inside + TWO_SIDED_95 * step), TWO_SIDED_95 * step);
        let mut outside_root = self.root(outside);
        for _ in 0..DOUBLINGS {
            if outside_root >= TWO_SIDED_95 {
                break;
            }
            if outside == bound {
                return bound;
            }
            reach *= 2.0;
            (inside, inside_root) = (outside, outside_root);
            outside = within(self.value() + reach);
            outside_root = self.root(outside);
        }
        for _ in 0..STEPS {
            let part = (TWO_SIDED_95 - inside_root) / (outside_root - inside_root).max(f64::MIN_POSITIVE);
            let middle = inside + (outside - inside) * part.clamp(0.05, 0.95);
            let root = self.root(middle);
            if libm::fabs(root - TWO_SIDED_95) < NEAR {
                return middle;
            }
            if root < TWO_SIDED_95 {
                (inside, inside_root) = (middle, root);
            } else {
                (outside, outside_root) = (middle, root);
            }
        }
        f64::midpoint(inside, outside)
    }

    /// Mean of the root of the parameter over its confidence distribution, whose distribution function at a value is
    /// Φ(±√(D − D_min)): ∫ (1 − H) d√v. Unlike the best value it is never zero, and its error is smaller.
    pub(super) fn mean_of_root(&self, hi: f64) -> f64 {
        let width = BEYOND_THE_INTERVAL * libm::sqrt(hi) / f64::from(CELLS);
        let best = self.value();
        let above = |cell: u32| {
            let root = width * (f64::from(cell) + 0.5);
            let value = root * root;
            let score = if value < best { -self.root(value) } else { self.root(value) };
            libm::erfc(score / core::f64::consts::SQRT_2) / 2.0
        };
        (0..CELLS).map(above).sum::<f64>() * width
    }
}

/// Of one parameter where the curvature of D is this, the others free; none where that cannot be told.
fn marginal_variance(curvature: &Square, place: usize) -> Option<f64> {
    let free: alloc::vec::Vec<usize> = (0..curvature.n).filter(|&i| curvature.at(i, i) > 0.0).collect();
    let scale = |i: usize| 1.0 / libm::sqrt(curvature.at(i, i));
    let cell = |a: usize, b: usize| {
        let (i, j) = (free[a], free[b]);
        curvature.at(i, j) * scale(i) * scale(j) + if a == b { 1e-9 } else { 0.0 }
    };
    let at = free.iter().position(|&i| i == place)?;
    let factor = Cholesky::new(&Square::from_fn(free.len(), cell))?;
    let unit = (0..free.len()).map(|i| if i == at { 1.0 } else { 0.0 }).collect();
    Some(2.0 * factor.solve(unit)[at] * scale(place) * scale(place))
}
