//! The measured curves of the record and of its parts, against which a model is checked.

use super::spectrum::averages::averages;
use crate::{Deviation, Input, Stat, deviations, octaves};
use alloc::vec::Vec;
use core::ops::Range;

/// Number of parts of a record that are compared.
pub(super) const BLOCKS: usize = 8;
/// Length of a part divided by the length of its longest average.
const LONGEST_IN_BLOCK: usize = 16;
/// A record of more than `LONG` samples without gaps is thinned for averages of at least `THINNED` samples. These
/// averages then begin only at every `STEP`-th sample, which costs no degrees of freedom.
const LONG: usize = 1 << 20;
const THINNED: u64 = 256;
const STEP: usize = 16;

/// The overlapping Allan deviations of the parts of a record.
pub(super) struct Curves<'a> {
    pub(super) rate: &'a [f64],
    pub(super) rate_hz: f64,
    /// Number of samples in a part.
    block: usize,
    /// Averaging lengths in octaves up to a sixteenth of a part, in samples.
    pub(super) lengths: Vec<u64>,
    pub(super) blocks: Vec<Vec<Deviation>>,
}

impl<'a> Curves<'a> {
    pub(super) fn of(rate: &'a [f64], rate_hz: f64) -> Self {
        let block = rate.len() / BLOCKS;
        let lengths = octaves(2 * (block / LONGEST_IN_BLOCK));
        let blocks = rate.chunks_exact(block.max(1)).map(|block| curve(block, rate_hz, &lengths)).collect();
        Self { rate, rate_hz, block, lengths, blocks }
    }

    /// The deviations of consecutive parts together. Up to the longest of `lengths`, no difference spans two parts.
    pub(super) fn of_parts(&self, parts: Range<usize>) -> Vec<Deviation> {
        let part = &self.rate[parts.start * self.block..(parts.end * self.block).min(self.rate.len())];
        let longer: Vec<u64> =
            octaves(part.len()).into_iter().filter(|m| self.lengths.last().is_none_or(|last| m > last)).collect();
        let blocks = self.blocks.get(parts).unwrap_or_default();
        let joined = |&m: &u64| {
            let of_blocks = blocks.iter().flatten().filter(|found| found.m == m);
            let sum =
                |(sum, n): (f64, u64), found: &Deviation| (sum + found.dev * found.dev * found.n as f64, n + found.n);
            let (sum, n) = of_blocks.fold((0.0, 0), sum);
            (n > 0).then(|| Deviation { m, n, dev: libm::sqrt(sum / n as f64) })
        };
        let long = curve(part, self.rate_hz, &longer);
        self.lengths.iter().filter_map(joined).chain(long).collect()
    }

    pub(super) fn whole(&self) -> Vec<Deviation> {
        self.of_parts(0..BLOCKS)
    }

    pub(super) fn samples(&self) -> usize {
        self.rate.len()
    }
}

/// The overlapping Allan deviations above zero at these lengths, which are powers of two.
fn curve(rate: &[f64], rate_hz: f64, lengths: &[u64]) -> Vec<Deviation> {
    let of = |rate: &[f64], rate_hz: f64, lengths: &[u64]| -> Vec<Deviation> {
        let found = deviations(&Input::Rate(rate), rate_hz, Stat::Oadev, lengths);
        found.into_iter().flatten().filter(|found| found.dev > 0.0).collect()
    };
    if rate.len() <= LONG || rate.iter().any(|value| value.is_nan()) {
        return of(rate, rate_hz, lengths);
    }
    let (long, short): (Vec<u64>, Vec<u64>) = lengths.iter().partition(|m| **m >= THINNED);
    let step = STEP as u64;
    let long: Vec<u64> = long.iter().map(|m| m / step).collect();
    let thinned = of(&averages(rate, STEP).0, rate_hz / STEP as f64, &long);
    let in_samples = |found: Deviation| Deviation { m: found.m * step, n: found.n * step, ..found };
    of(rate, rate_hz, &short).into_iter().chain(thinned.into_iter().map(in_samples)).collect()
}
