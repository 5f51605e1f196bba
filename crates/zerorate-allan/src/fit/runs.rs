//! Finds glitches of several samples in noise with a heavy tail.
//!
//! Large samples of independent noise stand alone, whatever its tail. A knock or a burst is a run of them.

use super::glitches::scale;
use super::lines::median;
use crate::kernels::threads;
use alloc::vec::Vec;
use core::ops::Range;

/// Expected number of false alarms per record.
const ALARM: f64 = 0.02;
/// Number of samples that are compared with one level, and number of samples around their middle that set it.
const BLOCK: usize = 16;
const AROUND: usize = 80;
const PIECE: usize = BLOCK << 10;
/// Large samples at most this far apart are one run.
const REACH: usize = 2;
/// Runs of 2 to this many large samples are looked for. A longer run has all of these in it.
const LONGEST: i32 = 8;
/// Samples beyond this many standard deviations show whether large samples follow each other in the noise itself.
const USUAL_SIGMA: f64 = 2.0;
/// Standard deviations by which pairs must exceed those by chance, or the samples count as independent.
const DEPENDENT_SIGMA: f64 = 3.0;

/// The runs of samples beyond `least_sigma` standard deviations that chance does not explain. They may overlap.
pub(super) fn runs(values: &[f64], least_sigma: f64) -> Vec<Range<usize>> {
    let distances = distances(values);
    let sigma = scale(&distances);
    let beyond = |least: f64| (0..values.len()).filter(|&i| distances[i] > least).collect::<Vec<usize>>();
    let following = following(&beyond(USUAL_SIGMA * sigma), values.len());
    let large = beyond(least_sigma * sigma);
    let mut sizes: Vec<f64> = large.iter().map(|&i| distances[i]).collect();
    sizes.sort_unstable_by(|a, b| b.total_cmp(a));
    let of_length = |length: i32| {
        // Among the `rank` largest samples of the record, runs of this length are not due to chance.
        let by_chance = |rank: usize| {
            let next = (REACH * rank) as f64 / values.len() as f64 + following;
            rank as f64 * libm::pow(next, f64::from(length - 1))
        };
        let rank = (1..=sizes.len()).take_while(|&rank| by_chance(rank) < ALARM / f64::from(LONGEST - 1)).count();
        let least = sizes.get(rank).copied().unwrap_or(0.0);
        let largest: Vec<usize> = large.iter().copied().filter(|&i| distances[i] > least).collect();
        let runs = largest.chunk_by(|a, b| b - a <= REACH).filter(|run| run.len() >= length as usize);
        runs.map(|run| run[0]..run[run.len() - 1] + 1).collect::<Vec<Range<usize>>>()
    };
    (2..=LONGEST).flat_map(of_length).collect()
}

/// The distance of each value from the median of the values around it.
fn distances(values: &[f64]) -> Vec<f64> {
    let count = values.len();
    let of_block = |first: usize| {
        let from = (first + BLOCK / 2).saturating_sub(AROUND / 2).min(count.saturating_sub(AROUND));
        let level = median(values[from..(from + AROUND).min(count)].to_vec());
        values[first..(first + BLOCK).min(count)].iter().map(move |value| libm::fabs(value - level))
    };
    let of_piece = |piece: usize| {
        let blocks = (piece * PIECE..((piece + 1) * PIECE).min(count)).step_by(BLOCK);
        blocks.flat_map(of_block).collect::<Vec<f64>>()
    };
    threads::map(count.div_ceil(PIECE), of_piece).concat()
}

/// The mean number of large samples that follow one within reach, beyond those of independent samples.
fn following(large: &[usize], samples: usize) -> f64 {
    let count = large.len() as f64;
    let by_chance = count * count / samples as f64;
    let beyond = |lag: usize| {
        let pairs = large.iter().filter(|at| large.binary_search(&(*at + lag)).is_ok()).count() as f64;
        (pairs - by_chance - DEPENDENT_SIGMA * libm::sqrt(by_chance)).max(0.0)
    };
    (1..=REACH).map(beyond).sum::<f64>() / count.max(1.0)
}
