//! Detects zeros that stand for missing samples, where 0 is neither the largest nor the least value.

use super::block::{BLOCK, Block};

/// Number of blocks that are examined, spread over the column.
const BLOCKS: usize = 256;

/// Least number of zeros for a warning, and their share of the samples.
const ENOUGH: usize = 50;
const SHARE: std::ops::RangeInclusive<f64> = 1e-3..=0.3;

/// Least number of different values. In coarse codes 0 may be frequent by itself.
const VALUES: usize = 100;

/// Zeros are marks if they are at least this many times as frequent as any other value. Rounding towards 0 doubles
/// them.
const MORE: usize = 3;

#[derive(Default)]
pub struct Zeros {
    /// Every N-th block is examined, and this is N.
    every: usize,
    blocks: usize,
    examined: usize,
    /// The examined samples of the blocks that may contain a zero.
    samples: Vec<f64>,
}

impl Zeros {
    pub fn among(samples: u64) -> Self {
        Self { every: (samples as usize / BLOCK / BLOCKS).max(1), ..Self::default() }
    }

    pub fn feed(&mut self, block: &Block<'_>) {
        if self.blocks.is_multiple_of(self.every) {
            self.examined += block.len();
            if block.facts.as_ref().is_none_or(|facts| facts.least <= 0.0 && facts.largest >= 0.0) {
                self.samples.extend_from_slice(block.samples);
            }
        }
        self.blocks += 1;
    }

    /// The text of the warning about zeros; `None` if they may be measured.
    pub fn text(mut self) -> Option<String> {
        let count = self.samples.iter().filter(|sample| **sample == 0.0).count();
        let share = count as f64 / self.examined as f64;
        let alone = self.samples.windows(2).filter(|pair| pair[1] == 0.0 && pair[0] != 0.0).count();
        if count < ENOUGH || !SHARE.contains(&share) || 2 * alone < count {
            return None;
        }
        self.samples.retain(|sample| *sample != 0.0 && sample.is_finite());
        self.samples.sort_unstable_by(f64::total_cmp);
        let counts: Vec<usize> = self.samples.chunk_by(|a, b| a == b).map(<[f64]>::len).collect();
        let are_marks = counts.len() >= VALUES && counts.iter().all(|other| count >= MORE * other);
        are_marks.then(|| format!("{:.2} % of the samples are exactly 0; a mark of missing ones?", 100.0 * share))
    }
}

#[cfg(test)]
mod tests {
    use crate::column_checks::ColumnChecks;
    use crate::column_checks::clipped::tests::noise;
    use crate::series::Series;

    fn doubt(samples: impl Iterator<Item = f64>) -> Option<String> {
        ColumnChecks::of(&Series::Numbers(samples.collect()).input(&[])).zeros.text()
    }

    #[test]
    fn zeros_for_missing_samples_are_found() {
        let lost = |at: usize, sample: f64| if at % 20 == 7 { 0.0 } else { sample };
        for count in [3000, 400_000] {
            let marked = noise(count).into_iter().enumerate().map(|(at, sample)| lost(at, 3.0 + sample));
            let text = doubt(marked).unwrap_or_default();
            assert_eq!(text, "5.00 % of the samples are exactly 0; a mark of missing ones?", "{count}");
        }
    }

    #[test]
    fn measured_zeros_are_no_marks() {
        for steps in [0.1, 0.3, 1.0, 3.0, 30.0, 1e6] {
            assert_eq!(doubt(noise(20_000).iter().map(|sample| (sample * steps).round())), None, "{steps}");
            assert_eq!(doubt(noise(20_000).iter().map(|sample| (sample * steps).trunc())), None, "{steps}");
        }
        let rests = noise(20_000).into_iter().enumerate().map(|(at, s)| if at / 1000 % 5 == 0 { 0.0 } else { s });
        assert_eq!(doubt(rests), None);
    }
}
