//! Steadiness: whether the record is the same from one part to the next.

use super::model::Model;
use crate::{Deviation, Input, Stat, deviations};
use alloc::vec::Vec;

/// Parts that are compared.
const BLOCKS: usize = 8;
/// The longest average is this share of a block.
const LONGEST_IN_BLOCK: usize = 16;
/// Standard deviations by which the halves of a record must differ at one averaging time.
const DIFFERENT: f64 = 5.0;

/// The variance of ln σ²(τ) between an eighth of the record and the next, over the share that chance explains. The
/// likelihood takes the noise for steady and does not cover it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scatter {
    /// By averaging time, in samples: octaves up to a sixteenth of an eighth.
    by_length: Vec<(u64, f64)>,
}

impl Scatter {
    pub(super) fn of(rate: &[f64], rate_hz: f64, model: &Model) -> Self {
        let len = rate.len() / BLOCKS;
        let lengths: Vec<u64> = core::iter::successors(Some(1u64), |m| Some(2 * m))
            .take_while(|m| *m as usize <= len / LONGEST_IN_BLOCK)
            .collect();
        let blocks: Vec<Vec<f64>> =
            rate.chunks_exact(len.max(1)).map(|block| logs(block, rate_hz, &lengths)).collect();
        let extra = |(i, &m): (usize, &u64)| {
            let values: Vec<f64> = blocks.iter().filter_map(|block| block.get(i).copied()).collect();
            if values.len() < 2 {
                return (m, 0.0);
            }
            let mean = values.iter().sum::<f64>() / values.len() as f64;
            let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (values.len() - 1) as f64;
            (m, (variance - 2.0 / model.freedom(m, len as u64)).max(0.0))
        };
        Self { by_length: lengths.iter().enumerate().map(extra).collect() }
    }

    /// Mean of three octaves around an averaging time. The last of them hold beyond.
    pub(super) fn near(&self, m: u64) -> f64 {
        let at = self.by_length.partition_point(|(length, _)| *length < m).min(self.by_length.len().max(1) - 1);
        let near = &self.by_length[at.saturating_sub(1)..(at + 2).min(self.by_length.len())];
        near.iter().map(|(_, extra)| extra).sum::<f64>() / near.len().max(1) as f64
    }

    /// The variance of ln N in the mean of the record, around the averaging time at which white noise is most of the
    /// curve.
    pub(super) fn variance_of_ln_n(&self, rate_hz: f64, n2: f64, model: &Model) -> f64 {
        let white = |m: u64| n2 * rate_hz / m as f64 / model.allan_variance(m);
        let lengths = self.by_length.iter().map(|(m, _)| *m);
        let middle = lengths.max_by(|&a, &b| white(a).total_cmp(&white(b)));
        // ln σ² is 2 ln N
        middle.map_or(0.0, |m| self.near(m)) / 4.0 / BLOCKS as f64
    }
}

/// An averaging time at which the halves differ by more than chance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference {
    pub(super) tau_s: f64,
    /// Deviation of the first half divided by the second half's.
    pub(super) ratio: f64,
}

/// The averaging time at which the halves of a record differ most, if they do.
pub(super) fn halves(rate: &[f64], rate_hz: f64, model: &Model) -> Option<Difference> {
    let (first, second) = rate.split_at(rate.len() / 2);
    let lengths = super::super::octaves(first.len());
    let of = |half| deviations(&Input::Rate(half), rate_hz, Stat::Oadev, &lengths);
    let pairs = of(first).into_iter().zip(of(second)).filter_map(|(a, b)| Some((a.ok()?, b.ok()?)));
    let pairs = pairs.filter(|(a, b)| a.dev > 0.0 && b.dev > 0.0);
    let score = |(a, b): &(Deviation, Deviation)| {
        let spread = libm::sqrt(4.0 / model.freedom(a.m, first.len() as u64));
        libm::fabs(2.0 * libm::log(a.dev / b.dev)) / spread
    };
    let worst = pairs.max_by(|a, b| score(a).total_cmp(&score(b))).filter(|pair| score(pair) > DIFFERENT)?;
    let (a, b) = worst;
    Some(Difference { tau_s: a.m as f64 / rate_hz, ratio: a.dev / b.dev })
}

/// ln σ² at each length that can be computed.
fn logs(rate: &[f64], rate_hz: f64, lengths: &[u64]) -> Vec<f64> {
    let found = deviations(&Input::Rate(rate), rate_hz, Stat::Oadev, lengths);
    found.into_iter().flatten().filter(|found| found.dev > 0.0).map(|found| 2.0 * libm::log(found.dev)).collect()
}
