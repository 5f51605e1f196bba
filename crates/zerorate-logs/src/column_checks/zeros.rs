//! Detects zeros that stand for missing samples, or for small readings (a dead band), where 0 is neither the largest
//! nor the least value.

use super::block::{BLOCK, Block};

/// Number of blocks that are examined, spread over the column.
const BLOCKS: usize = 256;

/// Least number of zeros for a warning, and their least share of the samples.
const ENOUGH: usize = 10;
const LEAST_SHARE: f64 = 1e-3;
/// More zeros than this share are rather of a dead band.
const FEW: f64 = 0.3;

/// No other value may be more frequent than this among the values that are not 0. In coarse codes 0 may be frequent by
/// itself.
const MOST_OF_ONE: f64 = 0.1;

/// Zeros are marks if they are at least this many times as frequent as any other value. Rounding towards 0 doubles
/// them.
const MORE: usize = 3;

/// Zeros are of a dead band if, on both sides, the next values are so far from 0 that as many would lie between,
/// within this factor, and if the two sides differ by this share at most.
const BAND: std::ops::Range<f64> = 0.5..2.0;
const UNEQUAL: f64 = 0.2;

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
        // zeros that stand together are of a sensor that was off
        if count < ENOUGH || share < LEAST_SHARE || 2.0 * (alone as f64) < (1.0 - share) * count as f64 {
            return None;
        }
        self.samples.retain(|sample| *sample != 0.0 && sample.is_finite());
        self.samples.sort_unstable_by(f64::total_cmp);
        let most = self.samples.chunk_by(|a, b| a == b).map(<[f64]>::len).max().unwrap_or_default();
        let are_marks = most > 0 && count >= MORE * most && most as f64 <= MOST_OF_ONE * self.samples.len() as f64;
        let what = match dead_band(&self.samples, count) {
            Some(width) => format!(" and none lies within {width:.2e} of it; a dead band?"),
            None if share > FEW => "; a dead band, or a mark of missing ones?".to_owned(),
            None => "; a mark of missing ones?".to_owned(),
        };
        are_marks.then(|| format!("{:.2} % of the samples are exactly 0{what}", 100.0 * share))
    }
}

/// The half width of the dead band that explains this number of zeros; `None` if none does. `others` are the sorted
/// values that are not 0.
fn dead_band(others: &[f64], zeros: usize) -> Option<f64> {
    let (below, above) = others.split_at(others.partition_point(|value| *value < 0.0));
    let (low, high) = (-below.last()?, *above.first()?);
    let width = low.min(high);
    let beside = others.iter().filter(|value| value.abs() < 2.0 * width).count() as f64;
    let is_band = BAND.contains(&(zeros as f64 / beside)) && (high - low).abs() <= UNEQUAL * width;
    is_band.then_some(width)
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
        let few = noise(3000).into_iter().enumerate().map(|(at, s)| if at % 100 == 7 { 0.0 } else { 1.0 + s });
        assert!(doubt(few).is_some_and(|text| text.starts_with("1.00 %")));
    }

    #[test]
    fn a_dead_band_is_named() {
        for band in [0.02, 0.1, 0.3] {
            let text = doubt(noise(20_000).into_iter().map(|sample| if sample.abs() < band { 0.0 } else { sample }));
            assert!(text.as_ref().is_some_and(|text| text.ends_with(" of it; a dead band?")), "{band}: {text:?}");
        }
        for band in [1.0, 1.7, 2.0] {
            let soft = |sample: f64| if sample.abs() < band { 0.0 } else { sample - band * sample.signum() };
            let text = doubt(noise(20_000).into_iter().map(soft)).unwrap_or_default();
            assert!(text.ends_with(" are exactly 0; a dead band, or a mark of missing ones?"), "{band}: {text}");
            let codes =
                doubt(noise(20_000).into_iter().map(|sample| (20.0 * soft(sample)).round())).unwrap_or_default();
            assert!(codes.contains("; a dead band"), "{band}: {codes}");
        }
    }

    #[test]
    fn measured_zeros_are_no_marks() {
        for steps in [0.1, 0.3, 1.0, 3.0, 30.0, 1e6] {
            assert_eq!(doubt(noise(20_000).iter().map(|sample| (sample * steps).round())), None, "{steps}");
            assert_eq!(doubt(noise(20_000).iter().map(|sample| (sample * steps).trunc())), None, "{steps}");
            // a heavy tail, whose codes have many values
            assert_eq!(doubt(noise(20_000).iter().map(|sample| (sample.sinh() * steps).round())), None, "{steps}");
        }
        let rests = noise(20_000).into_iter().enumerate().map(|(at, s)| if at / 1000 % 5 == 0 { 0.0 } else { s });
        assert_eq!(doubt(rests), None);
    }
}
