//! Generalised non-negative least squares with the covariance of the fitted model itself, iterated.

use super::model::{Coefficients, Covariance, Geometry, N, Q, terms, variance};
use crate::linear::{Cholesky, Square, dot};
use alloc::vec::Vec;

/// Iterations of weights and coefficients.
const ITERATIONS: usize = 40;
/// From this iteration on the coefficients move half way only: two sets of active coefficients can alternate.
const DAMPED_FROM: usize = 12;
/// The weights are settled when no point of the model moves by more than this.
const SETTLED: f64 = 1e-7;
/// Parts of each point's own variance, in the order in which they are tried.
const ADDED_NOISE: [f64; 4] = [1e-9, 1e-4, 1e-2, 1.0];

/// The measured curve and all its properties that do not depend on the coefficients.
#[derive(Clone, Debug)]
pub(super) struct Curve {
    pub(super) geometry: Geometry,
    /// Allan variances.
    pub(super) variance: Vec<f64>,
    pub(super) covariance: Covariance,
}

/// The coefficients that are fitted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Model {
    pub(super) has: [bool; 5],
    /// The term in τ⁻² may be negative: white noise behind a low-pass has N²/τ − c/τ².
    pub(super) rolls_off: bool,
}

/// The least squares problem for one covariance.
pub(super) struct Problem {
    factor: Cholesky,
    design: Vec<Coefficients>,
    model_variance: Vec<f64>,
    /// XᵀΣ⁻¹X and XᵀΣ⁻¹y.
    normal: [[f64; 5]; 5],
    right: Coefficients,
    whitened: [Vec<f64>; 5],
    observed: Vec<f64>,
}

/// The unconstrained estimate of one coefficient: its value, its variance, and the skewness of its distribution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linear {
    pub(super) value: f64,
    pub(super) sd: f64,
    pub(super) skewness: f64,
}

impl Problem {
    /// None where the covariance cannot be inverted.
    pub(super) fn new(curve: &Curve, coefficients: &Coefficients) -> Option<Self> {
        let sigma = curve.covariance.of(coefficients);
        let taus = (0..sigma.n).map(|i| curve.geometry.tau_s(i));
        let model_variance = taus.map(|tau_s| variance(coefficients, tau_s)).collect();
        Self::with(curve, &sigma, model_variance)
    }

    /// The problem before anything is known: independent points with the relative variance of white noise.
    pub(super) fn first(curve: &Curve) -> Option<Self> {
        let relative = |i: usize| 1.5 * curve.geometry.m[i] / curve.geometry.terms[i];
        let cell = |i: usize| curve.variance[i] * curve.variance[i] * relative(i).max(f64::MIN_POSITIVE);
        let sigma = Square::from_fn(curve.variance.len(), |i, j| if i == j { cell(i) } else { 0.0 });
        Self::with(curve, &sigma, curve.variance.clone())
    }

    fn with(curve: &Curve, sigma: &Square, model_variance: Vec<f64>) -> Option<Self> {
        let factor = factor(sigma)?;
        let design: Vec<Coefficients> = (0..sigma.n).map(|i| terms(curve.geometry.tau_s(i))).collect();
        let whitened: [Vec<f64>; 5] = core::array::from_fn(|c| factor.whiten(design.iter().map(|row| row[c])));
        let observed = factor.whiten(curve.variance.iter().copied());
        let normal = core::array::from_fn(|a| core::array::from_fn(|b| dot(&whitened[a], &whitened[b])));
        let right = core::array::from_fn(|c| dot(&whitened[c], &observed));
        Some(Self { factor, design, model_variance, normal, right, whitened, observed })
    }

    /// Least squares over the coefficients of the model. None is negative; one is held if asked for.
    pub(super) fn solve(&self, model: &Model, held: Option<(usize, f64)>) -> Coefficients {
        let fixed =
            held.map_or([0.0; 5], |(which, value)| core::array::from_fn(|c| if c == which { value } else { 0.0 }));
        let right: Coefficients = core::array::from_fn(|c| self.right[c] - dot(&self.normal[c], &fixed));
        let candidates = (0u32..32).map(|bits| core::array::from_fn::<bool, 5, _>(|c| bits >> c & 1 == 1));
        let allowed =
            |set: &[bool; 5]| (0..5).all(|c| !set[c] || (model.has[c] && held.is_none_or(|(which, _)| which != c)));
        let mut best = (0.0, [0.0; 5]);
        for set in candidates.filter(allowed) {
            let Some(found) = solve_subset(&self.normal, &right, &set) else { continue };
            let feasible = (0..5).all(|c| found[c] >= 0.0 || (c == Q && model.rolls_off));
            let gain = dot(&right, &found);
            if feasible && gain > best.0 {
                best = (gain, found);
            }
        }
        core::array::from_fn(|c| best.1[c] + fixed[c])
    }

    /// The estimate of `which` that is unbiased for any values of the model's other coefficients.
    pub(super) fn linear(&self, model: &Model, which: usize) -> Option<Linear> {
        let mut set = model.has;
        set[which] = true;
        let unit: Coefficients = core::array::from_fn(|c| if c == which { 1.0 } else { 0.0 });
        let direction = solve_subset(&self.normal, &unit, &set)?;
        let sd = libm::sqrt(direction[which]);
        let weights = self.factor.unwhiten(self.combine(&direction));
        // third cumulant, as for a sum of gamma distributed points that keep the covariance
        let third: f64 = (0..weights.len())
            .map(|i| (weights[i], dot(&self.design[i], &direction), self.model_variance[i]))
            .map(|(weight, covariance, variance)| 2.0 * weight * covariance * covariance / variance)
            .sum();
        Some(Linear { value: dot(&direction, &self.right), sd, skewness: third / (sd * sd * sd) })
    }

    /// The distance of each point from the fit of the others, in standard deviations, and the total χ².
    pub(super) fn misfit(&self, model: &Model, coefficients: &Coefficients) -> (Vec<f64>, f64) {
        let n = self.observed.len();
        let fitted = self.combine(coefficients);
        let residual: Vec<f64> = self.observed.iter().zip(&fitted).map(|(o, f)| o - f).collect();
        let chi2 = dot(&residual, &residual);
        let pull = self.factor.unwhiten(residual);
        let point = |i: usize| {
            let column = self.factor.whiten((0..n).map(|k| if k == i { 1.0 } else { 0.0 }));
            let along: Coefficients = core::array::from_fn(|c| dot(&self.whitened[c], &column));
            let explained = solve_subset(&self.normal, &along, &model.has).map_or(0.0, |x| dot(&x, &along));
            pull[i] / libm::sqrt((dot(&column, &column) - explained).max(f64::MIN_POSITIVE))
        };
        ((0..n).map(point).collect(), chi2)
    }

    fn combine(&self, coefficients: &Coefficients) -> Vec<f64> {
        (0..self.observed.len()).map(|i| (0..5).map(|c| self.whitened[c][i] * coefficients[c]).sum()).collect()
    }
}

/// Factors the covariance. It leaves out points that are far apart, so it may miss being positive definite by a
/// little. Independent noise is added until it is.
fn factor(sigma: &Square) -> Option<Cholesky> {
    ADDED_NOISE.iter().find_map(|added| {
        let mut widened = sigma.clone();
        (0..sigma.n).for_each(|i| widened.cells[i * sigma.n + i] *= 1.0 + added);
        widened.cholesky()
    })
}

/// Coefficients and weights that agree with each other, iterated from a start.
pub(super) fn iterate(
    curve: &Curve,
    model: &Model,
    held: Option<(usize, f64)>,
    start: Option<Coefficients>,
) -> Option<Coefficients> {
    let mut now = match start {
        Some(start) => start,
        None => usable(curve, Problem::first(curve)?.solve(model, held)),
    };
    for step in 0..ITERATIONS {
        let mut next = usable(curve, Problem::new(curve, &now)?.solve(model, held));
        if step >= DAMPED_FROM {
            next = core::array::from_fn(|c| (next[c] + now[c]) / 2.0);
        }
        let settled = settled(curve, &now, &next);
        now = next;
        if settled {
            break;
        }
    }
    Some(now)
}

/// Replaces a model without any noise, which has no covariance, by white noise of the shortest point.
fn usable(curve: &Curve, mut coefficients: Coefficients) -> Coefficients {
    if coefficients.iter().all(|&c| c <= 0.0) {
        coefficients[N] = curve.variance[0] * curve.geometry.tau_s(0) * 1e-6;
    }
    coefficients
}

fn settled(curve: &Curve, a: &Coefficients, b: &Coefficients) -> bool {
    let at = &curve.geometry;
    (0..at.m.len()).map(|i| at.tau_s(i)).all(|tau_s| {
        let (a, b) = (variance(a, tau_s), variance(b, tau_s));
        (a - b).abs() <= SETTLED * b.abs()
    })
}

/// Solves the rows and columns of `set`; the rest is zero. Columns are scaled to a unit diagonal first.
fn solve_subset(normal: &[[f64; 5]; 5], right: &Coefficients, set: &[bool; 5]) -> Option<Coefficients> {
    let rows: Vec<usize> = (0..5).filter(|&c| set[c]).collect();
    let scale: Vec<f64> = rows.iter().map(|&c| 1.0 / libm::sqrt(normal[c][c])).collect();
    let matrix = Square::from_fn(rows.len(), |a, b| normal[rows[a]][rows[b]] * scale[a] * scale[b]);
    let found = matrix.cholesky()?.solve(rows.iter().zip(&scale).map(|(&c, s)| right[c] * s));
    let mut solution = [0.0; 5];
    rows.iter().zip(found.iter().zip(&scale)).for_each(|(&c, (value, scale))| solution[c] = value * scale);
    Some(solution)
}
