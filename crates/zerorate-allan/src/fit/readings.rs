//! Other explanations of a spectrum that a filter or a Gauss–Markov term bends.

use super::scoring::{Explanation, ModelForm, N2, Optimum, Problem, SHORTEST};
use super::select::{descents, level_near, start, white, with_cosine};
use alloc::vec::Vec;
use core::f64::consts::PI;

/// The time constants that are tried for low-passes of the first order and for Gauss–Markov terms, in samples.
const LOW_PASSES: [f64; 7] = [2.0, 4.0, 8.0, 16.0, 50.0, 150.0, 450.0];
const SHORT_MARKOVS: [f64; 4] = [3.0, 6.0, 12.0, 24.0];
/// Number of corners to try for second-order low-passes, from `PERIODS` periods in the record to half the upper end.
const CORNERS: u32 = 12;
const PERIODS: f64 = 25.0;
/// Largest number of cosines that are tried beside a low-pass.
const MOST_BESIDE: usize = 2;
/// White noise beside a Gauss–Markov term of few samples must reach this share of the density in some bin.
const LEAST_WHITE: f64 = 0.5;

/// Fits white noise behind a low-pass, with slow noise added after it. Also fits a Gauss–Markov term of few samples.
pub(super) fn others(problem: &Problem) -> Vec<Optimum> {
    let joined = [low_pass(problem), corner(problem)].into_iter().flatten();
    let more =
        |found| core::iter::successors(Some(found), |last| Some(with_cosine(problem, last))).take(1 + MOST_BESIDE);
    joined.flat_map(more).chain(memory(problem)).collect()
}

/// The largest share that the white noise has of the density.
pub(super) fn white_share(problem: &Problem, found: &Optimum) -> f64 {
    let local = problem.local(found);
    (0..local.density.len()).map(|row| white(&local, found, row) / local.density[row]).fold(0.0, f64::max)
}

fn low_pass(problem: &Problem) -> Option<Optimum> {
    let rate_hz = problem.table.rate_hz;
    let start = |samples: f64| joining(problem, rate_hz / (2.0 * PI * samples), &[libm::exp(-1.0 / samples)]);
    best(problem, ModelForm { poles: 1, reading: Explanation::Joins, ..ModelForm::PLAIN }, LOW_PASSES.map(start))
}

fn corner(problem: &Problem) -> Option<Optimum> {
    let table = &problem.table;
    let (low, high) = (PERIODS / table.span_s, table.top_hz / 2.0);
    let start = |step: u32| {
        let hz = low * libm::pow(high / low, f64::from(step) / f64::from(CORNERS - 1));
        joining(problem, hz, &[2.0 * libm::log(libm::sin(PI * hz / table.rate_hz)), 0.0])
    };
    best(problem, ModelForm { poles: 2, reading: Explanation::Joins, ..ModelForm::PLAIN }, (0..CORNERS).map(start))
}

fn memory(problem: &Problem) -> Option<Optimum> {
    let table = &problem.table;
    let start = |samples: f64| {
        let tau_s = samples / table.rate_hz;
        let variance = 0.3 * level_near(table, 1.0 / (2.0 * PI * tau_s)) / tau_s;
        let mut at = start(problem, 0);
        at.extend([variance, libm::log(tau_s)]);
        at
    };
    let found = best(
        problem,
        ModelForm { markovs: 1, reading: Explanation::Short, ..ModelForm::PLAIN },
        SHORT_MARKOVS.map(start),
    );
    let is_short = |found: &Optimum| libm::exp(found.at[found.form.markov(0) + 1]) * table.rate_hz < SHORTEST;
    found.filter(|found| is_short(found) && white_share(problem, found) > LEAST_WHITE)
}

/// Start values of white noise behind a low-pass.
fn joining(problem: &Problem, corner_hz: f64, low_pass: &[f64]) -> Vec<f64> {
    let mut at = start(problem, 0);
    at[N2] = level_near(&problem.table, corner_hz / 2.0);
    at.extend(low_pass);
    at
}

fn best(problem: &Problem, form: ModelForm, starts: impl IntoIterator<Item = Vec<f64>>) -> Option<Optimum> {
    descents(problem, form, starts.into_iter()).into_iter().min_by(|a, b| a.deviance.total_cmp(&b.deviance))
}
