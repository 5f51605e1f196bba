//! Base motions as models: the frequencies that are tried, and their prior probabilities.

use alloc::vec::Vec;

/// Prior odds of a base motion, which is assumed to be as rare as a step. Less than one cycle looks like a level,
/// so larger odds would make PBC of a still base more uncertain than it is.
const ODDS: f64 = 0.02;
/// Difference of the log evidence of two neighbouring frequencies above which one between them is tried.
const COARSE: f64 = 1.0;
/// Frequencies whose log evidence is this far below the best one need no finer steps.
const FAR: f64 = 6.0;
/// Number of frequencies from which on no more are added.
const MOST: usize = 96;
/// Relative difference below which neighbours count as the same frequency.
const FINEST: f64 = 1e-4;

/// A frequency, and the logarithm of the prior probability of a base motion about it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    pub(super) hz: f64,
    pub(super) log_prior: f64,
}

/// Returns the frequencies in rising order with their prior probabilities. The prior is uniform in the logarithm
/// of the frequency, and each frequency stands for its neighbourhood.
pub(super) fn of(all_hz: &[f64]) -> Vec<Candidate> {
    let (Some(first), Some(last)) = (all_hz.first(), all_hz.last()) else { return Vec::new() };
    let range = libm::log(last / first).max(f64::MIN_POSITIVE);
    let border = |k: usize| libm::log(all_hz[k.min(all_hz.len() - 1)] / all_hz[k.saturating_sub(1)]) / 2.0;
    let share = |k: usize| (border(k) + border(k + 1)) / range;
    let weighted = |(k, hz): (usize, &f64)| Candidate { hz: *hz, log_prior: libm::log(ODDS * share(k)) };
    all_hz.iter().enumerate().map(weighted).collect()
}

/// Adds frequencies where the evidence changes fast. `score` returns the log evidence of frequencies.
pub(super) fn refined(all_hz: &[f64], score: impl Fn(&[f64]) -> Vec<f64>) -> Vec<f64> {
    let mut known: Vec<(f64, f64)> = all_hz.iter().copied().zip(score(all_hz)).collect();
    while known.len() < MOST {
        let best = known.iter().map(|(_, score)| *score).fold(f64::NEG_INFINITY, f64::max);
        let is_coarse = |k: usize| {
            let near = known[k.saturating_sub(1)..(k + 2).min(known.len())].iter();
            known[k].1 > best - FAR && near.clone().any(|(_, score)| (score - known[k].1).abs() > COARSE)
        };
        let pairs = (1..known.len()).filter(|k| is_coarse(k - 1) || is_coarse(*k));
        let middles = pairs.filter(|k| known[*k].0 / known[k - 1].0 > 1.0 + FINEST);
        let new: Vec<f64> = middles.map(|k| libm::sqrt(known[k].0 * known[k - 1].0)).collect();
        if new.is_empty() {
            break;
        }
        known.extend(new.iter().copied().zip(score(&new)));
        known.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    known.into_iter().map(|(hz, _)| hz).collect()
}
