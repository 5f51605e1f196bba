//! The most likely parameters of a model: Fisher scoring with bounds.
//!
//! D = Σ ν (ln S/P + P/S − 1) is −2 ln of the likelihood, up to a constant, of powers P that are distributed as
//! χ²_ν·S/ν. Its gradient is −Σ ν (P − S)/S² ∂S, its expected curvature Σ ν ∂S∂Sᵀ/S². S is linear in the squared
//! coefficients, so a noise can be exactly zero and leave zero again.

use super::density::Table;
use super::drift::{Drift, Restriction, Template};
use crate::linear::Square;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;

/// The terms of a model besides N, B and K.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ModelForm {
    pub(super) cosines: usize,
    /// Order of a low-pass in the band shape: 0, 1 (a pole) or 2 (corner and damping). Few cosines cannot follow one.
    pub(super) poles: usize,
    pub(super) reading: Explanation,
    /// Number of Gauss–Markov terms.
    pub(super) markovs: usize,
    pub(super) quantised: bool,
    pub(super) drift: Option<Drift>,
    /// Index of a squared coefficient that may be negative. The unbiased estimate of a square that is zero is negative
    /// half of the time.
    pub(super) signed: Option<usize>,
}

/// The explanation of a spectrum that bends at its upper end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Explanation {
    /// One shape filters all noise.
    Usual,
    /// A shape of the white noise only. The slow noise is added after the filter.
    Joins,
    /// A Gauss–Markov term with a correlation time of few samples.
    Short,
}

/// Indices of the parameters: squared coefficients, then the shape, then variance and ln T of each Gauss–Markov term.
pub(super) const N2: usize = 0;
pub(super) const B2: usize = 1;
pub(super) const K2: usize = 2;
pub(super) const Q2: usize = 3;
pub(super) const SHAPE: usize = 4;

impl ModelForm {
    pub(super) const PLAIN: Self = Self {
        cosines: 0,
        poles: 0,
        reading: Explanation::Usual,
        markovs: 0,
        quantised: false,
        drift: None,
        signed: None,
    };

    /// Number of parameters of the band shape: the cosines, then the low-pass.
    pub(super) fn shape(&self) -> usize {
        self.cosines + self.poles
    }

    /// Shortest correlation time of a Gauss–Markov term, in samples.
    pub(super) fn shortest(&self) -> f64 {
        if self.reading == Explanation::Short { SHORTEST_OF_ALL } else { SHORTEST }
    }

    pub(super) fn len(&self) -> usize {
        self.markov(self.markovs)
    }

    /// Whether the density is proportional to a parameter: a squared coefficient or a variance.
    fn is_square(&self, place: usize) -> bool {
        place < SHAPE || place >= self.markov(0) && (place - self.markov(0)).is_multiple_of(2)
    }

    /// Index of the variance of a Gauss–Markov term. The next parameter is its ln T.
    pub(super) fn markov(&self, index: usize) -> usize {
        SHAPE + self.shape() + 2 * index
    }
}

/// Shortest correlation time of a Gauss–Markov term, in samples, except for [`Explanation::Short`]. The band shape
/// describes shorter correlation times.
pub(super) const SHORTEST: f64 = 20.0;
const SHORTEST_OF_ALL: f64 = 2.0;
/// A Gauss–Markov term longer than this share of the record is a random walk.
pub(super) const LONGEST: f64 = 0.25;
/// The default price of a cosine of the shape, in −2 ln L: the 1.4 % point of χ² with one degree of freedom.
pub(super) const SHAPE_PRICE: f64 = 6.0;
/// Largest coefficient of a cosine of the shape.
const STEEPEST: f64 = 6.0;
/// The range of a pole. A slower low-pass is a Gauss–Markov term.
pub(super) const POLES: (f64, f64) = (-0.95, 0.999);
/// The range of a corner, ln sin²(θ/2), and of its damping. A sharper resonance would follow the first notch of a comb
/// filter. Two poles far apart could make a Gauss–Markov term look like white noise.
const CORNERS: (f64, f64) = (-25.0, 0.0);
const DAMPINGS: (f64, f64) = (-1.0, 3.0);
/// Least white noise, as a share of the median power. It keeps N above zero.
const LEAST_WHITE: f64 = 1e-6;
/// The largest step of a parameter of the shape and of a ln T.
const STRIDE: f64 = 1.0;
/// Number of lengths that are tried for a step, each half of the one before, until the deviance does not rise.
const HALVINGS: usize = 12;

/// The data that all fits of a record share.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    pub(super) table: Table,
    /// Degrees of freedom of each row, reduced by the model error.
    pub(super) nu: Vec<f64>,
    /// Relative error of the model, ε.
    pub(super) error: f64,
    /// The price of a cosine: the least decrease of −2 ln L for which a cosine is kept.
    pub(super) shape_price: f64,
    /// Whether the likelihood counts what the fit of a drift takes.
    pub(super) restricted: bool,
    least_white: f64,
}

impl Problem {
    pub(super) fn new(table: Table, error: f64) -> Self {
        let nu =
            table.rows.iter().map(|row| row.bin.freedom / (1.0 + row.bin.freedom * error * error / 2.0)).collect();
        let mut powers: Vec<f64> = table.rows.iter().map(|row| row.bin.power).collect();
        powers.sort_unstable_by(f64::total_cmp);
        let least_white = LEAST_WHITE * powers.get(powers.len() / 2).copied().unwrap_or(1.0);
        Self { table, nu, error, shape_price: SHAPE_PRICE, restricted: false, least_white }
    }

    pub(super) fn priced_at(self, shape_price: f64) -> Self {
        Self { shape_price, ..self }
    }

    fn bounds(&self, form: &ModelForm, place: usize) -> (f64, f64) {
        match place {
            N2 => (self.least_white, f64::INFINITY),
            Q2 if !form.quantised => (0.0, 0.0),
            _ if form.signed == Some(place) => (f64::NEG_INFINITY, f64::INFINITY),
            _ if form.is_square(place) => (0.0, f64::INFINITY),
            _ if place < SHAPE + form.cosines => (-STEEPEST, STEEPEST),
            _ if place < form.markov(0) && form.poles == 1 => POLES,
            _ if place == SHAPE + form.cosines => CORNERS,
            _ if place < form.markov(0) => DAMPINGS,
            _ => (libm::log(form.shortest() / self.table.rate_hz), libm::log(LONGEST * self.table.span_s)),
        }
    }
}

/// The parameters with the largest likelihood.
#[derive(Clone, Debug)]
pub(super) struct Optimum {
    pub(super) form: ModelForm,
    pub(super) at: Vec<f64>,
    pub(super) deviance: f64,
    /// Expected power of each row.
    pub(super) density: Vec<f64>,
    /// Size of the drift, 0 without one.
    pub(super) drift: f64,
}

/// The expected powers at some parameters, and their slopes by each parameter.
pub(super) struct Local {
    pub(super) density: Vec<f64>,
    pub(super) slopes: Vec<Vec<f64>>,
}

struct State {
    density: Vec<f64>,
    slopes: Vec<Vec<f64>>,
    /// Powers of the first rows without the drift.
    low: Vec<f64>,
    restriction: Restriction,
    drift: f64,
    deviance: f64,
}

impl State {
    fn power(&self, problem: &Problem, row: usize) -> f64 {
        self.low.get(row).copied().unwrap_or(problem.table.rows[row].bin.power)
    }
}

impl Problem {
    /// Descends from `start` in at most `steps` steps, until a step gains less than `least_gain`. Keeps `held` fixed.
    pub(super) fn descend(
        &self,
        form: ModelForm,
        start: &[f64],
        held: Option<usize>,
        (steps, least_gain): (usize, f64),
    ) -> Optimum {
        let bound = |(place, &value): (usize, &f64)| match held {
            Some(held) if held == place => value,
            _ => {
                let (lower, upper) = self.bounds(&form, place);
                value.clamp(lower, upper)
            }
        };
        let mut at: Vec<f64> = start.iter().enumerate().map(bound).collect();
        let template = form.drift.map(|drift| Template::new(drift, &self.table));
        let mut state = self.state(&form, &at, template.as_ref());
        for _ in 0..steps {
            let step = self.step(&form, &at, &state, held);
            let Some((next, reached)) = self.downhill(&form, &at, &step, template.as_ref(), state.deviance) else {
                break;
            };
            let gain = state.deviance - reached.deviance;
            (at, state) = (next, reached);
            if gain < least_gain {
                break;
            }
        }
        Optimum { form, at, deviance: state.deviance, density: state.density, drift: state.drift }
    }

    fn downhill(
        &self,
        form: &ModelForm,
        at: &[f64],
        step: &[f64],
        template: Option<&Template>,
        deviance: f64,
    ) -> Option<(Vec<f64>, State)> {
        let mut part = 1.0;
        for _ in 0..HALVINGS {
            let next: Vec<f64> = at.iter().zip(step).map(|(at, step)| at + part * step).collect();
            let state = self.state(form, &next, template);
            if state.deviance <= deviance {
                return Some((next, state));
            }
            part /= 2.0;
        }
        None
    }

    fn state(&self, form: &ModelForm, at: &[f64], template: Option<&Template>) -> State {
        let rows = &self.table.rows;
        let mut slopes = vec![vec![0.0; rows.len()]; form.len()];
        let mut density = vec![0.0; rows.len()];
        for (i, row) in rows.iter().enumerate() {
            let response = row.bin.response;
            let mut exponent = 0.0;
            (0..form.cosines).for_each(|j| exponent += at[SHAPE + j] * row.cosines[j]);
            let (low_pass, low_pass_slopes) = low_pass(form, at, row.cosines[0]);
            let shape = libm::exp(exponent) * low_pass * response.gain;
            let q = row.quantisation * response.gain;
            let slow = if form.reading == Explanation::Joins { response.gain } else { shape };
            let (b, k) = (row.flicker * slow, row.walk * slow);
            let mut sum = at[N2] * shape + at[B2] * b + at[K2] * k;
            (slopes[N2][i], slopes[B2][i], slopes[K2][i], slopes[Q2][i]) = (shape, b, k, q);
            for index in 0..form.markovs {
                let place = form.markov(index);
                let (g, rise) = row.gauss_markov(libm::exp(at[place + 1]));
                (slopes[place][i], slopes[place + 1][i]) = (g * slow, at[place] * rise * slow);
                sum += at[place] * g * slow;
            }
            let shaped = if form.reading == Explanation::Joins { at[N2] * shape } else { sum };
            (0..form.cosines).for_each(|j| slopes[SHAPE + j][i] = shaped * row.cosines[j]);
            (0..form.poles).for_each(|j| slopes[SHAPE + form.cosines + j][i] = shaped * low_pass_slopes[j]);
            density[i] = response.offset + sum + at[Q2] * q;
        }
        let fitted = template.map(|template| template.fitted(&self.table, &self.nu, &density));
        let (low, drift) = fitted.map_or((Vec::new(), 0.0), |fitted| (fitted.powers, fitted.size));
        let restriction =
            template.filter(|_| self.restricted).map(|template| template.restriction(&self.nu, &density));
        let restriction = restriction.unwrap_or_default();
        let mut state = State { density, slopes, low, restriction, drift, deviance: 0.0 };
        let term = |i: usize| {
            let (p, s) = (rows[i].bin.power, state.density[i]);
            // measured against the original powers, so that models with and without a drift can be compared
            self.nu[i] * (libm::log(s / p) + state.power(self, i) / s - 1.0)
        };
        let positive = state.density.iter().all(|s| *s > 0.0);
        let sum = || (0..rows.len()).map(term).sum::<f64>() + state.restriction.log_det;
        state.deviance = if positive { sum() } else { f64::INFINITY };
        state
    }

    /// The step to the bounded minimum of the quadratic that has the gradient and the expected curvature of D.
    fn step(&self, form: &ModelForm, at: &[f64], state: &State, held: Option<usize>) -> Vec<f64> {
        let (curvature, gradient) = self.normal(form, state);
        let room: Vec<(f64, f64)> = (0..form.len())
            .map(|place| {
                if held == Some(place) {
                    return (0.0, 0.0);
                }
                let (lower, upper) = self.bounds(form, place);
                let (lower, upper) = (lower - at[place], upper - at[place]);
                match form.is_square(place) {
                    true => (lower, upper),
                    false => (lower.max(-STRIDE), upper.min(STRIDE)),
                }
            })
            .collect();
        bounded(&curvature, &gradient, &room)
    }

    /// Expected curvature and negative gradient of D.
    fn normal(&self, form: &ModelForm, state: &State) -> (Square, Vec<f64>) {
        let n = form.len();
        let rows = self.table.rows.len();
        let (mut weight, mut pull) = (vec![0.0; rows], vec![0.0; rows]);
        for i in 0..rows {
            let s = state.density[i];
            let taken = state.restriction.taken.get(i).copied().unwrap_or(0.0);
            weight[i] = (self.nu[i] - taken).max(0.0) / (s * s);
            pull[i] = self.nu[i] / (s * s) * (state.power(self, i) - s) + taken / s;
        }
        let mut curvature = Square { n, cells: vec![0.0; n * n] };
        let mut gradient = vec![0.0; n];
        let mut weighted = vec![0.0; rows];
        for (a, slope) in state.slopes.iter().enumerate() {
            (0..rows).for_each(|i| weighted[i] = weight[i] * slope[i]);
            gradient[a] = sum_of_products(&pull, slope);
            for b in a..n {
                let cell = sum_of_products(&weighted, &state.slopes[b]);
                (curvature.cells[a * n + b], curvature.cells[b * n + a]) = (cell, cell);
            }
        }
        (curvature, gradient)
    }

    /// The expected powers of a model.
    pub(super) fn density(&self, form: &ModelForm, at: &[f64]) -> Vec<f64> {
        self.state(form, at, None).density
    }

    pub(super) fn set_powers(&mut self, powers: &[f64]) {
        self.table.rows.iter_mut().zip(powers).for_each(|(row, power)| row.bin.power = *power);
    }

    /// Expected curvature of D at the parameters found.
    pub(super) fn information(&self, found: &Optimum) -> Square {
        self.normal(&found.form, &self.state_of(found)).0
    }

    /// The degrees of freedom of each row that the fit of a drift leaves.
    pub(super) fn freedom(&self, found: &Optimum) -> Vec<f64> {
        let taken = self.state_of(found).restriction.taken.into_iter().chain(core::iter::repeat(0.0));
        self.nu.iter().zip(taken).map(|(nu, taken)| (nu - taken).max(0.0)).collect()
    }

    pub(super) fn local(&self, found: &Optimum) -> Local {
        let State { density, slopes, .. } = self.state_of(found);
        Local { density, slopes }
    }

    fn state_of(&self, found: &Optimum) -> State {
        let template = found.form.drift.map(|drift| Template::new(drift, &self.table));
        self.state(&found.form, &found.at, template.as_ref())
    }

    /// Whether a parameter is inside its bounds.
    pub(super) fn is_free(&self, found: &Optimum, place: usize) -> bool {
        let (lower, upper) = self.bounds(&found.form, place);
        found.at[place] > lower && found.at[place] < upper
    }
}

/// Sums products in four parts, which the compiler adds in parallel.
fn sum_of_products(a: &[f64], b: &[f64]) -> f64 {
    let mut parts = [0.0; 4];
    let (a4, b4) = (a.chunks_exact(4), b.chunks_exact(4));
    let rest: f64 = a4.remainder().iter().zip(b4.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in a4.zip(b4) {
        (0..4).for_each(|i| parts[i] += a[i] * b[i]);
    }
    parts[0] + parts[1] + (parts[2] + parts[3]) + rest
}

/// Minimum of ½xᵀHx − gᵀx between bounds, by active sets. A parameter that would leave its bounds is fixed there, and
/// freed again if the minimum lies inside.
fn bounded(h: &Square, g: &[f64], room: &[(f64, f64)]) -> Vec<f64> {
    let n = h.n;
    let fixed_from_the_start = |i: usize| match room[i] {
        (lower, upper) if lower >= upper || h.at(i, i) <= 0.0 => Some(lower.max(0.0).min(upper)),
        (lower, _) if lower >= 0.0 && g[i] <= 0.0 => Some(0.0),
        _ => None,
    };
    let mut fixed: Vec<Option<f64>> = (0..n).map(fixed_from_the_start).collect();
    let mut x = vec![0.0; n];
    for _ in 0..3 * n {
        x = solve_free(h, g, &fixed);
        let beyond = |i: usize| (room[i].0 - x[i]).max(x[i] - room[i].1) * libm::sqrt(h.at(i, i));
        let outside = (0..n).filter(|&i| fixed[i].is_none() && beyond(i) > 0.0);
        if let Some(worst) = outside.max_by(|&a, &b| beyond(a).total_cmp(&beyond(b))) {
            fixed[worst] = Some(x[worst].clamp(room[worst].0, room[worst].1));
            continue;
        }
        let pull = |i: usize| g[i] - (0..n).map(|j| h.at(i, j) * x[j]).sum::<f64>();
        let inward = |i: usize| {
            let (lower, upper) = room[i];
            let force = pull(i) / libm::sqrt(h.at(i, i));
            if lower < upper && x[i] <= lower {
                force
            } else if lower < upper && x[i] >= upper {
                -force
            } else {
                0.0
            }
        };
        let freed = (0..n).filter(|&i| fixed[i].is_some() && h.at(i, i) > 0.0 && inward(i) > 1e-9);
        match freed.max_by(|&a, &b| inward(a).total_cmp(&inward(b))) {
            Some(freed) => fixed[freed] = None,
            None => break,
        }
    }
    x.iter().zip(room).map(|(x, &(lower, upper))| x.clamp(lower.min(upper), upper)).collect()
}

/// Solves for the free parameters with the others fixed. Raises the diagonal until the matrix is positive definite.
fn solve_free(h: &Square, g: &[f64], fixed: &[Option<f64>]) -> Vec<f64> {
    let free: Vec<usize> = (0..h.n).filter(|&i| fixed[i].is_none()).collect();
    let mut x: Vec<f64> = fixed.iter().map(|fixed| fixed.unwrap_or(0.0)).collect();
    let scale: Vec<f64> = free.iter().map(|&i| 1.0 / libm::sqrt(h.at(i, i))).collect();
    let moved = |i: usize| (0..h.n).filter(|&j| fixed[j].is_some()).map(|j| h.at(i, j) * x[j]).sum::<f64>();
    let right: Vec<f64> = free.iter().zip(&scale).map(|(&i, scale)| (g[i] - moved(i)) * scale).collect();
    for added in [1e-10, 1e-6, 1e-3, 1.0] {
        let cell =
            |a: usize, b: usize| h.at(free[a], free[b]) * scale[a] * scale[b] + if a == b { added } else { 0.0 };
        if let Some(factor) = Square::from_fn(free.len(), cell).cholesky() {
            let found = factor.solve(right);
            free.iter().zip(found.iter().zip(&scale)).for_each(|(&i, (value, scale))| x[i] = value * scale);
            return x;
        }
    }
    x
}

/// Density of the low-pass of a shape at cos θ − 1, relative to frequency 0, and the slopes of its logarithm.
fn low_pass(form: &ModelForm, at: &[f64], cosine: f64) -> (f64, [f64; 2]) {
    let first = SHAPE + form.cosines;
    match form.poles {
        0 => (1.0, [0.0; 2]),
        1 => {
            let (level, slope) = one_pole(at[first], cosine);
            (level, [slope, 0.0])
        }
        _ => two_poles(at[first], at[first + 1], cosine),
    }
}

/// Density of a second-order low-pass relative to frequency 0, 1/(1 + cx + x²) with x = sin²(θ/2)/e^u, and the slopes
/// of its logarithm. Damping c: 0 for a Butterworth filter, 2 for two equal poles.
fn two_poles(u: f64, c: f64, cosine: f64) -> (f64, [f64; 2]) {
    let x = -cosine / 2.0 / libm::exp(u);
    let under = 1.0 + c * x + x * x;
    (1.0 / under, [(c * x + 2.0 * x * x) / under, -x / under])
}

/// Density of a low-pass with the pole `a` relative to frequency 0, (1 − a)²/(1 + a² − 2a cos θ), and the slope of its
/// logarithm by `a`. `cosine` is cos θ − 1.
fn one_pole(a: f64, cosine: f64) -> (f64, f64) {
    let (square, under) = ((1.0 - a) * (1.0 - a), (1.0 - a) * (1.0 - a) - 2.0 * a * cosine);
    (square / under, 2.0 * (cosine + 1.0 - a) / under - 2.0 / (1.0 - a))
}

/// The longest time constant of the low-pass of a shape, in samples; 0 without a low-pass.
pub(super) fn low_pass_memory(form: &ModelForm, at: &[f64], rate_hz: f64, top_hz: f64) -> f64 {
    match at[SHAPE + form.cosines..][..form.poles] {
        [pole] => 1.0 / (1.0 - pole),
        [u, c] => {
            let inverse_of_q = libm::sqrt(2.0 + c);
            let period = rate_hz / (2.0 * PI * corner_hz(u, rate_hz, top_hz));
            period * inverse_of_q.max(2.0 / inverse_of_q)
        }
        _ => 0.0,
    }
}

/// Converts the corner of a second-order low-pass from u = ln sin²(θ/2) to Hz.
pub(super) fn corner_hz(u: f64, rate_hz: f64, top_hz: f64) -> f64 {
    libm::asin(libm::exp(u / 2.0) * libm::sin(PI * top_hz / rate_hz)) * rate_hz / PI
}

/// The shape relative to frequency 0, at the angle of its cosines.
pub(super) fn shape(form: &ModelForm, at: &[f64], angle: f64) -> f64 {
    let term = |j: usize| at[SHAPE + j] * (libm::cos((j + 1) as f64 * angle) - 1.0);
    libm::exp((0..form.cosines).map(term).sum()) * low_pass(form, at, libm::cos(angle) - 1.0).0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slopes_of_a_low_pass_are_its_derivatives() {
        for (poles, low_pass) in [(1, [0.7, 0.0]), (2, [-3.0, -0.4]), (2, [-1.0, 1.5])] {
            let form = ModelForm { poles, ..ModelForm::PLAIN };
            let log_at = |offset: [f64; 2]| {
                let at = [1.0, 0.0, 0.0, 0.0, low_pass[0] + offset[0], low_pass[1] + offset[1]];
                let (level, slopes) = super::low_pass(&form, &at, -0.3);
                (libm::log(level), slopes)
            };
            let (_, slopes) = log_at([0.0, 0.0]);
            for (place, [u, c]) in [[1e-5, 0.0], [0.0, 1e-5]].into_iter().enumerate().take(poles) {
                let slope = (log_at([u, c]).0 - log_at([-u, -c]).0) / 2e-5;
                assert!((slope - slopes[place]).abs() < 1e-6, "{poles} {place}: {slope} {slopes:?}");
            }
        }
    }
}
