//! The five noises: their shares of an Allan variance, and the covariance of Allan variances at two averaging times.

use crate::linear::Square;
use alloc::vec::Vec;
use core::f64::consts::{LN_2, PI};

/// Q², N², B², K², R²: the coefficients of the Allan variance, in this order.
pub(super) type Coefficients = [f64; 5];

pub(super) const Q: usize = 0;
pub(super) const N: usize = 1;
pub(super) const B: usize = 2;
pub(super) const K: usize = 3;
pub(super) const R: usize = 4;

/// Beyond this ratio of averaging times the covariance is left out: its correlation falls with the 3/2nd power.
const WIDEST_RATIO: f64 = 40.0;
/// Steps of the lag per shorter averaging time.
const STEPS_PER_TAU: f64 = 8.0;
/// How far beyond the overlap of the two differences the flicker's covariance is followed, in averaging times.
const REACH: f64 = 3.0;

/// σ²(τ) = 3Q²/τ² + N²/τ + (2 ln 2/π)B² + K²τ/3 + R²τ²/2 (IEEE Std 952-1997 C.1): the factor of each coefficient.
pub(super) fn terms(tau_s: f64) -> Coefficients {
    [3.0 / (tau_s * tau_s), 1.0 / tau_s, 2.0 * LN_2 / PI, tau_s / 3.0, tau_s * tau_s / 2.0]
}

pub(super) fn variance(coefficients: &Coefficients, tau_s: f64) -> f64 {
    coefficients.iter().zip(terms(tau_s)).map(|(coefficient, term)| coefficient * term).sum()
}

/// The averaging lengths of a record, in samples, and the terms that entered each.
#[derive(Clone, Debug)]
pub(super) struct Geometry {
    pub(super) rate_hz: f64,
    pub(super) samples: f64,
    pub(super) m: Vec<f64>,
    pub(super) terms: Vec<f64>,
}

impl Geometry {
    pub(super) fn tau_s(&self, i: usize) -> f64 {
        self.m[i] / self.rate_hz
    }

    /// Differences that a record without gaps has.
    fn full(&self, i: usize) -> f64 {
        (self.samples - 2.0 * self.m[i] + 1.0).max(1.0)
    }
}

/// The covariance of the Allan variances as a quadratic form in the coefficients.
///
/// The second differences d of the phase are normal, so cov(Σd²ₐ, Σd²_b) = Σᵢⱼ 2C² + 4μₐμ_b·C with C their covariance
/// and μ = Rτ² their mean. C is a fourth difference of the phase's generalised autocovariance: Q²δ, −N²
/// t
/// /2, B²t² ln
/// t
/// /2π, K²
/// t
/// ³/12.
#[derive(Clone, Debug)]
pub(super) struct Covariance {
    n: usize,
    pairs: Vec<Pair>,
}

/// The factors of coefficient c times coefficient d, for one pair of averaging times.
type Pair = [[f64; 5]; 5];

impl Covariance {
    pub(super) fn new(at: &Geometry) -> Self {
        let n = at.m.len();
        let mut pairs = alloc::vec![[[0.0; 5]; 5]; n * n];
        for a in 0..n {
            for b in a..n {
                if at.m[b] <= WIDEST_RATIO * at.m[a] {
                    pairs[a * n + b] = pair(at, a, b);
                    pairs[b * n + a] = pairs[a * n + b];
                }
            }
        }
        Self { n, pairs }
    }

    pub(super) fn of(&self, coefficients: &Coefficients) -> Square {
        let positive = coefficients.map(|c| c.max(0.0));
        Square::from_fn(self.n, |a, b| {
            let pair = &self.pairs[a * self.n + b];
            let rows = pair.iter().zip(positive);
            rows.map(|(row, c)| c * row.iter().zip(positive).map(|(cell, d)| cell * d).sum::<f64>()).sum()
        })
    }
}

fn pair(at: &Geometry, a: usize, b: usize) -> Pair {
    let (m, n) = ((at.m[a], at.m[b]), (at.full(a), at.full(b)));
    let mut sums = [[0.0; 5]; 5];
    smooth_lags(m, n, at.rate_hz, &mut sums);
    quantised_lags(m, n, at.rate_hz, &mut sums);
    let (ta, tb) = (at.tau_s(a), at.tau_s(b));
    let terms = libm::sqrt(n.0 * n.1 * at.terms[a] * at.terms[b]);
    let scale = 1.0 / (4.0 * ta * ta * tb * tb * terms);
    let ramp = 4.0 * ta * ta * tb * tb;
    Pair::map(sums, |row| row.map(|cell| cell * scale)).map(|mut row| {
        row[R] *= ramp;
        row
    })
}

/// Pairs of differences that are `lag` samples apart.
fn count(lag: f64, n: (f64, f64)) -> f64 {
    (n.0.min(n.1 - lag) - (-lag).max(0.0)).max(0.0)
}

fn smooth_lags(m: (f64, f64), n: (f64, f64), rate_hz: f64, sums: &mut Pair) {
    let per_tau = m.0.min(STEPS_PER_TAU);
    let step = m.0 / per_tau;
    let shift = per_tau as usize;
    let reach = libm::ceil(REACH * (m.0 + m.1) / step) * step;
    let first = (m.0 - m.1 - reach).max(-libm::floor(n.0 / step) * step);
    let last = (m.0 - m.1 + reach).min(n.1);
    let steps = ((last - first) / step) as usize;
    let halves: Vec<[f64; 3]> = (0..=steps + 2 * shift)
        .map(|k| second_difference(first + (k as f64 - 2.0 * per_tau) * step, m.1, rate_hz))
        .collect();
    for k in 0..=steps {
        let c = |noise: usize| halves[k + 2 * shift][noise] - 2.0 * halves[k + shift][noise] + halves[k][noise];
        let weight = step * count(first + k as f64 * step, n);
        add(sums, &[0.0, c(0), c(1), c(2)], weight);
    }
}

/// Adds the products of the covariances of N, B and K, and their ramp terms, to the sums.
fn add(sums: &mut Pair, c: &[f64; 4], weight: f64) {
    for first in Q..=K {
        for second in Q..=K {
            sums[first][second] += 2.0 * weight * c[first] * c[second];
        }
        sums[first][R] += weight * c[first];
    }
}

/// Σ c_q G(lag + q·m) with c = 1, −2, 1, for white rate, flicker and random walk.
fn second_difference(lag: f64, m: f64, rate_hz: f64) -> [f64; 3] {
    let (a, b, c) = (kernels(lag / rate_hz), kernels((lag + m) / rate_hz), kernels((lag + 2.0 * m) / rate_hz));
    core::array::from_fn(|i| a[i] - 2.0 * b[i] + c[i])
}

/// Generalised autocovariance of the phase per N², B² and K².
fn kernels(lag_s: f64) -> [f64; 3] {
    let t = lag_s.abs();
    let log = if t > 0.0 { libm::log(t) } else { 0.0 };
    [-t / 2.0, t * t * log / (2.0 * PI), t * t * t / 12.0]
}

/// White phase has covariance only where two of its points coincide, so its sums run over single lags, not over steps.
fn quantised_lags(m: (f64, f64), n: (f64, f64), rate_hz: f64, sums: &mut Pair) {
    const DIFFERENCE: [f64; 3] = [1.0, -2.0, 1.0];
    let mut lags: Vec<(f64, f64)> = Vec::new();
    for (p, cp) in DIFFERENCE.iter().enumerate() {
        for (q, cq) in DIFFERENCE.iter().enumerate() {
            let lag = p as f64 * m.0 - q as f64 * m.1;
            match lags.iter_mut().find(|known| known.0 == lag) {
                Some(known) => known.1 += cp * cq,
                None => lags.push((lag, cp * cq)),
            }
        }
    }
    for (lag, quantised) in lags {
        let weight = count(lag, n);
        let halves = [0.0, 1.0, 2.0].map(|p| second_difference(lag - p * m.0, m.1, rate_hz));
        let c: [f64; 3] = core::array::from_fn(|i| halves[0][i] - 2.0 * halves[1][i] + halves[2][i]);
        for (i, smooth) in c.iter().enumerate() {
            sums[Q][i + 1] += 2.0 * weight * quantised * smooth;
            sums[i + 1][Q] += 2.0 * weight * quantised * smooth;
        }
        sums[Q][Q] += 2.0 * weight * quantised * quantised;
        sums[Q][R] += weight * quantised;
    }
}
