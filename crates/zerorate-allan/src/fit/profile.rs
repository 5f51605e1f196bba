//! Intervals from the profile likelihood: every value that is less than 1.96 standard deviations from the best, with
//! all other parameters fitted again.

use super::TWO_SIDED_95;
use super::departure::departure;
use super::scoring::{Local, ModelForm, Optimum, Problem};
use super::select::DESCENT;
use crate::linear::Square;
use alloc::vec::Vec;

/// Precision of an end of the interval, in standard deviations, and the largest numbers of steps to find it and of
/// doublings to enclose it.
const NEAR: f64 = 2e-3;
const STEPS: usize = 16;
const DOUBLINGS: usize = 40;
/// The confidence distribution of a square is integrated over its root, in this many cells and up to this multiple of
/// the root of the interval's upper end.
const CELLS: u32 = 30;
const BEYOND_THE_INTERVAL: f64 = 2.0;
/// Largest number of steps of a descent near the best parameters, and the gain in −2 ln L below which it ends.
const BESIDE: (usize, f64) = (30, 1e-5);
/// Smallest |r| that [`Profile::score`] corrects, and the largest correction, both in standard deviations.
const LEAST_ROOT: f64 = 0.05;
const MOST_CORRECTION: f64 = 1.0;

/// The likelihood along one parameter.
pub(super) struct Profile<'a> {
    problem: &'a Problem,
    best: Optimum,
    local: Local,
    nu: Vec<f64>,
    place: usize,
    bounds: (f64, f64),
    /// The best fit with the parameter at zero, if the best value would be below zero.
    at_zero: Option<Optimum>,
}

impl<'a> Profile<'a> {
    /// The profile of a squared coefficient, whose estimate may be below zero. The estimates of the other coefficients
    /// may not: a negative B² or K² could compensate for a Gauss–Markov term.
    pub(super) fn of_square(problem: &'a Problem, found: &Optimum, place: usize) -> Self {
        let best = match found.at[place] > 0.0 {
            true => found.clone(),
            false => problem.descend(ModelForm { signed: Some(place), ..found.form }, &found.at, None, DESCENT),
        };
        let at_zero = (found.at[place] <= 0.0).then(|| found.clone());
        Self {
            nu: problem.freedom(&best),
            problem,
            local: problem.local(&best),
            best,
            place,
            bounds: (0.0, f64::INFINITY),
            at_zero,
        }
    }

    /// The profile of any other parameter, between bounds.
    pub(super) fn between(problem: &'a Problem, found: &Optimum, place: usize, bounds: (f64, f64)) -> Self {
        Self {
            nu: problem.freedom(found),
            problem,
            local: problem.local(found),
            best: found.clone(),
            place,
            bounds,
            at_zero: None,
        }
    }

    fn value(&self) -> f64 {
        self.best.at[self.place]
    }

    /// The distance from `value` up to the best value, in standard deviations of a normal distribution.
    ///
    /// r = ±√(D − D_min) is normal if there are many data. For a parameter that rests on a few coefficients r is not
    /// normal, but r + ln(u/r)/r is (Barndorff-Nielsen, Biometrika 73, 1986). The [`departure`] u allows for the fit
    /// of the other parameters. Without it, K of a one-hour record was 4 % low.
    fn score(&self, value: f64) -> f64 {
        let mut start = self.best.at.clone();
        start[self.place] = value;
        let found = self.problem.descend(self.best.form, &start, Some(self.place), BESIDE);
        let r = libm::sqrt((found.deviance - self.best.deviance).max(0.0));
        let r = if value > self.value() { -r } else { r };
        if libm::fabs(r) < LEAST_ROOT {
            return r;
        }
        let can_move = |i: usize| self.problem.is_free(&found, i) && self.problem.is_free(&self.best, i);
        let free: Vec<usize> = (0..found.at.len()).filter(|&i| i == self.place || can_move(i)).collect();
        let u = departure(&self.nu, &self.local, &self.problem.local(&found), &free, self.place);
        let correction = u.filter(|u| u / r > 0.0).map_or(0.0, |u| libm::log(u / r) / r);
        r + correction.clamp(-MOST_CORRECTION, MOST_CORRECTION)
    }

    /// The ends of the 95 % interval. If the best value is below zero, the upper end is measured from zero:
    /// measured from the best value it could be zero itself.
    pub(super) fn interval(&self) -> (f64, f64) {
        if let Some(found) = &self.at_zero {
            let counted = Self::between(self.problem, found, self.place, self.bounds);
            return (self.bounds.0, counted.end(counted.step()));
        }
        let step = self.step();
        (self.end(-step), self.end(step))
    }

    /// The standard deviation of the parameter, from the curvature of D.
    fn step(&self) -> f64 {
        let curvature = self.problem.information(&self.best);
        let own = curvature.at(self.place, self.place).max(f64::MIN_POSITIVE);
        let conditional = libm::sqrt(2.0 / own);
        let variance = marginal_variance(self.problem, &self.best, self.place, &curvature);
        variance.map_or(conditional, libm::sqrt).clamp(conditional, 10.0 * conditional)
    }

    fn end(&self, step: f64) -> f64 {
        let bound = if step < 0.0 { self.bounds.0 } else { self.bounds.1 };
        let within = |value: f64| value.clamp(self.bounds.0, self.bounds.1);
        // distance of `value` from the best value in the direction of `step`, in standard deviations
        let beyond = |value: f64| if step < 0.0 { self.score(value) } else { -self.score(value) };
        let (mut inside, mut inside_score) = (self.value(), 0.0);
        let mut reach = TWO_SIDED_95 * step;
        let mut outside = within(inside + reach);
        let mut outside_score = beyond(outside);
        for _ in 0..DOUBLINGS {
            if outside_score >= TWO_SIDED_95 {
                break;
            }
            if outside == bound {
                return bound;
            }
            reach *= 2.0;
            (inside, inside_score) = (outside, outside_score);
            outside = within(self.value() + reach);
            outside_score = beyond(outside);
        }
        for _ in 0..STEPS {
            let part = (TWO_SIDED_95 - inside_score) / (outside_score - inside_score).max(f64::MIN_POSITIVE);
            let middle = inside + (outside - inside) * part.clamp(0.05, 0.95);
            let score = beyond(middle);
            if libm::fabs(score - TWO_SIDED_95) < NEAR {
                return within(middle);
            }
            if score < TWO_SIDED_95 {
                (inside, inside_score) = (middle, score);
            } else {
                (outside, outside_score) = (middle, score);
            }
        }
        within(f64::midpoint(inside, outside))
    }

    /// Mean of the parameter over its confidence distribution, ∫ (1 − H) dv. The distribution function H at a value is
    /// the probability of a larger estimate than the one found, if the value were true. Unlike the best value, the
    /// mean is never zero and has a smaller error. For K of a one-hour record the rms error is 35 %; the mean of the
    /// root has 38 % and the best value 42 %.
    pub(super) fn mean(&self, hi: f64) -> f64 {
        let width = BEYOND_THE_INTERVAL * libm::sqrt(hi) / f64::from(CELLS);
        let slice = |cell: u32| {
            let root = width * (f64::from(cell) + 0.5);
            root * libm::erfc(-self.score(root * root) / core::f64::consts::SQRT_2)
        };
        (0..CELLS).map(slice).sum::<f64>() * width
    }
}

/// The variance of a parameter from the curvature of D, if the other free parameters can move too. `None` if the
/// curvature does not determine it.
pub(super) fn marginal_variance(problem: &Problem, found: &Optimum, place: usize, curvature: &Square) -> Option<f64> {
    let free = |i: &usize| curvature.at(*i, *i) > 0.0 && (*i == place || problem.is_free(found, *i));
    let free: Vec<usize> = (0..curvature.n).filter(free).collect();
    let scale = |i: usize| 1.0 / libm::sqrt(curvature.at(i, i));
    let cell = |a: usize, b: usize| {
        let (i, j) = (free[a], free[b]);
        curvature.at(i, j) * scale(i) * scale(j) + if a == b { 1e-9 } else { 0.0 }
    };
    let at = free.iter().position(|&i| i == place)?;
    let factor = Square::from_fn(free.len(), cell).cholesky()?;
    let unit = (0..free.len()).map(|i| if i == at { 1.0 } else { 0.0 });
    Some(2.0 * factor.solve(unit)[at] * scale(place) * scale(place))
}
