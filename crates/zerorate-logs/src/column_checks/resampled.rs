//! Detects columns that were resampled, filled in, or read from the sensor faster than it converts. Their noise is not
//! that of the sensor.

use super::block::Block;
use crate::middle::median;
use std::ops::RangeInclusive;

/// Number of samples at the start of a column that are examined.
const LOOKED_AT: usize = 1 << 17;

/// Least number of samples for a meaningful share.
const ENOUGH: usize = 500;

/// Least share of repeated or filled-in samples at which a warning is given.
const SAID: f64 = 0.02;

/// Usual difference between samples, in steps, above which equal samples are not due to chance: of Gaussian
/// differences of this size, 1 in 370 is zero.
const FINE: f64 = 100.0;

/// Numbers count as fine if the differences between neighbours have at least this many sizes. Coarse codes that were
/// printed with more digits have fewer sizes, and repeat by chance.
const SIZES: usize = 100;

/// Least median difference between samples, in steps, at which repeats can be told from chance. From this size on,
/// noise repeats a sample about as often as it rises by one step.
const COARSE: f64 = 3.0;

/// One estimate of the share of repeats by chance is the mean share of the differences of 1 step up to this many
/// steps.
const NEAR: u32 = 3;

/// Another estimate is the mean share of equal pairs of samples at these distances. It holds for coarse codes that
/// were printed with further digits, too. The larger estimate counts.
const LAGS: RangeInclusive<usize> = 2..=10;

/// Number of parts of a log that must each show repeats: a sensor that stops for a while repeats samples as well.
const PARTS: usize = 8;

/// The first samples of a column.
#[derive(Default)]
pub struct Resampled(Vec<f64>);

impl Resampled {
    pub fn feed(&mut self, block: &Block<'_>) {
        if self.0.len() < LOOKED_AT {
            self.0.extend_from_slice(block.samples);
        }
    }

    /// The text about samples that repeat the one before, or lie on the line between their neighbours, to the last
    /// digit. `None` if there are few such samples, or if chance may explain them.
    pub fn text(&self) -> Option<String> {
        let samples = &*without_one_value(&self.0);
        let first = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| step.is_finite());
        let first: Vec<f64> = first.collect();
        let step = first.iter().copied().filter(|step| *step > 0.0).fold(f64::INFINITY, f64::min);
        let repeats = share(&first, step, 0.0).or_else(|| coarse_share(samples, step));
        let of_lines = || {
            let second = samples.windows(3).map(|three| (three[2] - 2.0 * three[1] + three[0]).abs());
            // tolerance for the rounding errors of two sums
            let size = samples.iter().fold(0.0_f64, |most, sample| most.max(sample.abs()));
            share(
                &second.filter(|step| step.is_finite()).collect::<Vec<_>>(),
                step,
                2.0 * step + 8.0 * f64::EPSILON * size,
            )
        };
        let (share, how) = match repeats {
            Some(share) => (share, "repeat the one before"),
            None => (of_lines()?, "lie on the line between neighbours"),
        };
        Some(format!("{:.0} % of the samples {how}; use the raw log", 100.0 * share))
    }
}

/// The samples without the value of most repeats, as NaN, if more than half of the repeats are of it: a limit, a mark
/// or a dead band, which is said elsewhere.
fn without_one_value(samples: &[f64]) -> Vec<f64> {
    let mut repeats: Vec<f64> = samples.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
    repeats.sort_unstable_by(f64::total_cmp);
    let most = repeats.chunk_by(|a, b| a == b).max_by_key(|same| same.len()).unwrap_or_default();
    let left_out = most.first().filter(|_| 2 * most.len() > repeats.len());
    samples.iter().map(|sample| if left_out == Some(sample) { f64::NAN } else { *sample }).collect()
}

/// Share of the differences that are at most `none`. Returns `None` if the share is below [`SAID`], or if the other
/// differences are so small that chance may explain the share.
fn share(differences: &[f64], step: f64, none: f64) -> Option<f64> {
    let others = || differences.iter().copied().filter(|difference| *difference > none);
    let count = others().count();
    let share = 1.0 - count as f64 / differences.len() as f64;
    if differences.len() < ENOUGH || count < ENOUGH / 10 || share < SAID {
        return None;
    }
    let (mut others, middle): (Vec<f64>, usize) = (others().collect(), count / 2);
    let usual = *others.select_nth_unstable_by(middle, f64::total_cmp).1;
    others.sort_unstable_by(f64::total_cmp);
    others.dedup_by(|a, b| (*a - *b).abs() < 0.5 * step);
    let is_fine = others.len() >= SIZES.min(count / 2);
    (usual >= FINE * step.max(none) && is_fine).then_some(share)
}

/// Share of the samples that repeat the one before, less the share by chance, for noise of a few steps. `None` unless
/// each part of the log has such repeats.
fn coarse_share(samples: &[f64], step: f64) -> Option<f64> {
    let size = samples.len() / PARTS;
    let shares: Vec<f64> = samples.chunks_exact(size.max(ENOUGH)).map(|part| excess(part, step)).collect();
    let least = shares.iter().copied().fold(f64::INFINITY, f64::min);
    (shares.len() >= PARTS && least >= SAID).then(|| shares.iter().sum::<f64>() / shares.len() as f64)
}

/// Share of repeats in a part less their share by chance; 0 where chance explains them.
fn excess(part: &[f64], step: f64) -> f64 {
    let share = |lag: usize, steps: u32| {
        let pairs = part.iter().zip(&part[lag..]);
        let is_of = |(a, b): &(&f64, &f64)| ((*b - *a).abs() / step - f64::from(steps)).abs() < 0.5;
        pairs.filter(is_of).count() as f64 / (part.len() - lag) as f64
    };
    let repeats = share(1, 0);
    if repeats < SAID {
        return 0.0;
    }
    // a share counts both signs of a difference
    let near = (1..=NEAR).map(|steps| share(1, steps)).sum::<f64>() / f64::from(2 * NEAR);
    let far = LAGS.map(|lag| share(lag, 0)).sum::<f64>() / LAGS.count() as f64;
    let chance = near.max(far);
    let differences = part.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let mut others: Vec<f64> = differences.filter(|difference| *difference > 0.0).collect();
    let usual = median(&mut others);
    if usual >= COARSE * step && repeats > 2.0 * chance { repeats - chance } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use crate::column_checks::ColumnChecks;
    use crate::series::Series;

    fn doubt(series: &Series) -> Option<String> {
        ColumnChecks::of(&series.input(&[])).resampled.text()
    }

    /// Noise of a triangular distribution that spans twice `steps` steps.
    fn noise(count: usize, steps: f64) -> Vec<f64> {
        let mut random = 7u64;
        let mut next = move || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (random >> 40) as f64 / (1u64 << 24) as f64
        };
        (0..count).map(|_| ((next() + next()) * steps).round()).collect()
    }

    fn said(samples: Vec<f64>) -> String {
        doubt(&Series::Numbers(samples)).unwrap_or_default()
    }

    #[test]
    fn plain_noise_gives_no_warning() {
        for steps in [1.0, 3.0, 20.0, 300.0, 1e6] {
            assert_eq!(said(noise(5000, steps)), "", "{steps}");
        }
        // codes of 131 steps in a unit, printed with four decimals
        let printed = noise(5000, 3.0).into_iter().map(|code| (code / 131.0 * 1e4).round() / 1e4);
        assert_eq!(said(printed.collect()), "");
        // codes with a random last digit, as printing may add
        let mut last = noise(5000, 1.0).into_iter();
        let drawn = noise(5000, 3.0).into_iter().map(|code| code * 0.0075 + 1e-4 * last.next().unwrap_or_default());
        assert_eq!(said(drawn.collect()), "");
        // band-limited noise, and plain noise as codes
        let slow: Vec<f64> =
            noise(5000, 1e4).windows(50).map(|part| (part.iter().sum::<f64>() / 50.0).round()).collect();
        assert_eq!(said(slow), "");
        assert_eq!(doubt(&Series::Codes(noise(5000, 1e5).iter().map(|code| *code as i32).collect())), None);
        assert_eq!(said(vec![1.0; 5000]), "", "a constant is said elsewhere");
    }

    #[test]
    fn repeats_of_one_value_are_not_of_resampling() {
        let middle = |sample: f64| sample - 1e5;
        let dead = noise(5000, 1e5).into_iter().map(|sample| if middle(sample).abs() < 2e4 { 1e5 } else { sample });
        assert_eq!(said(dead.collect()), "");
        assert_eq!(said(noise(5000, 1e5).into_iter().map(|sample| sample.min(1.2e5)).collect()), "");
    }

    #[test]
    fn codes_that_were_read_twice_are_found() {
        for steps in [8.0, 20.0, 90.0] {
            let codes = noise(5000, steps).into_iter().flat_map(|code| [code as i32; 2]).collect();
            let text = doubt(&Series::Codes(codes)).unwrap();
            assert!(text.contains(" % of the samples repeat"), "{text}");
            let mut filled: Vec<i32> = noise(20_000, steps).into_iter().map(|code| code as i32).collect();
            assert_eq!(doubt(&Series::Codes(filled.clone())), None);
            filled[4000..6000].fill(3);
            assert_eq!(doubt(&Series::Codes(filled)), None, "it stood still, which is said elsewhere");
        }
    }

    #[test]
    fn held_and_filled_in_samples_are_found() {
        let held: Vec<f64> = noise(3000, 1e5).into_iter().flat_map(|sample| [sample, sample]).collect();
        assert!(said(held).starts_with("50 % of the samples repeat the one before"));
        let mut filled = noise(6000, 1e5);
        (3..6000).step_by(10).for_each(|at| filled[at] = filled[at - 1]);
        assert!(said(filled).starts_with("10 % of the samples repeat"));
        let mut drawn = noise(6000, 1e5);
        (3..5999).step_by(10).for_each(|at| drawn[at] = 0.5 * (drawn[at - 1] + drawn[at + 1]));
        assert!(
            said(drawn.iter().map(|sample| sample.round()).collect()).contains("lie on the line between neighbours")
        );
        assert!(
            said(drawn.iter().map(|sample| sample * 1e-7 + 9.81).collect()).starts_with("10 % of the samples lie")
        );
    }
}
