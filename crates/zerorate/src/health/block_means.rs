//! Means over blocks of 0.1 s, and the Allan variance of averages of such blocks.

use alloc::vec::Vec;

/// Length of a block, s. Long compared with the filter of the part (F-03, F-04), short compared with all drifts.
pub(crate) const BLOCK_S: f64 = 0.1;
pub(crate) const BLOCK_NS: u64 = 100_000_000;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Adjacent {
    /// Number of blocks in an average.
    pub(crate) m: usize,
    /// Number of averages.
    pub(crate) count: usize,
    /// Allan variance: half the mean square of the differences of adjacent averages.
    pub(crate) variance: f64,
}

/// Averages `m` values at a time, without overlap. The variance is zero if there are fewer than two averages.
pub(crate) fn adjacent(values: &[f64], m: usize) -> Adjacent {
    let means: Vec<f64> = values.chunks_exact(m).map(|chunk| chunk.iter().sum::<f64>() / m as f64).collect();
    let squares: f64 = means.windows(2).map(|pair| (pair[1] - pair[0]) * (pair[1] - pair[0])).sum();
    Adjacent { m, count: means.len(), variance: squares / (2.0 * (means.len().max(2) - 1) as f64) }
}
