//! Finds glitches: single samples, or a few in a row, that noise does not explain.

use super::lines::median;
use super::runs::runs;
use super::spectrum::averages::{centred, fill_gaps};
use crate::chi2::{chi2_above, normal_quantile};
use crate::kernels::threads;
use alloc::borrow::Cow;
use alloc::collections::BTreeSet;
use alloc::vec::Vec;

/// Widths of the glitches to find, in samples.
const WIDTHS: [usize; 4] = [1, 2, 4, 8];
/// Expected number of false alarms per record.
const ALARM: f64 = 0.01;
/// Largest number of searches at each width. Only samples beside earlier finds need more than two.
const LOOKS: usize = 8;
/// If more than this share of the samples is flagged, they belong to the noise itself.
pub(super) const MOST: f64 = 0.01;
/// Leaving values beyond `CLIP` standard deviations out of the standard deviation lowers it by the factor `CLIPPED`.
const CLIP: f64 = 4.0;
const CLIPPED: f64 = 0.99946;
const ITERATIONS: usize = 20;
/// Classes of windows: without gaps, with few missing samples, with more. A class with gaps and fewer than
/// `FEWEST_IN_CLASS` windows gets the scale of uncorrelated samples.
const CLASSES: usize = 3;
const FEWEST_IN_CLASS: usize = 100;
/// Variance of the difference in a window of uncorrelated samples at width 1, divided by the variance of a sample. It
/// is less at larger widths.
const NOT_CORRELATED: f64 = 1.5;
/// Number of windows that set the scale. In a longer record, they are spread over it.
const SCALED_BY: usize = 1 << 18;
/// Number of samples in the median that starts the estimate of a scale.
const MEDIAN_OF: usize = 1 << 16;
const SIGMA_PER_MAD: f64 = 1.4826;

/// Windows beyond this share of the limit show whether the noise has a heavy tail.
const TAIL: f64 = 0.65;
/// Share of the records of normal noise whose tail seems heavy by chance. In these, glitches must be larger.
const HEAVY_BY_CHANCE: f64 = 0.05;
/// Share of the heavy-tailed records in which a gap within the tail is mistaken for one that isolates glitches.
const GAP_BY_CHANCE: f64 = 0.05;
/// The number of windows beyond a size falls at least with the power of 2 of the size, or the noise had no variance.
const MOST_SLOPE: f64 = 0.5;
/// Sizes that differ by less are the same.
const ROUNDING: f64 = 1e-9;

/// A sample is damaged, whatever the noise, if it is this many times farther from the median than 90 % of the samples.
const ABSURD: f64 = 1e9;

const PIECE: usize = 1 << 14;

/// Indices of the samples that are glitches, or so near that averages include one. `None` if more than [`MOST`] are.
///
/// The mean of w samples is compared with the means of the w samples before and after. This comparison is linear, so
/// the rate of false alarms holds for correlated noise too. A comparison with the median of a window gave 270 times as
/// many false alarms. The narrowest width comes first, and flagged samples are replaced before the next search.
/// Otherwise one bad sample would remove eight, and hide a bad sample beside it.
///
/// Missing samples are left out, because straight lines in their place would scatter less than noise. If the noise is
/// correlated, the samples beside a gap differ by more, so windows with gaps have scales of their own.
///
/// Noise with a heavy tail has windows of every size up to the limit and beyond. In such noise, only runs of large
/// samples, and windows beyond a gap in the sizes, are glitches. A cut at the limit lowered N of Student's t with 3
/// degrees of freedom by a tenth. Single samples tell whether the tail is heavy, because means of several are nearer
/// to normal.
pub(super) fn glitches(rate: &[f64]) -> Option<Vec<usize>> {
    let has_gaps = rate.iter().any(|value| value.is_nan());
    let there: Vec<usize> = if has_gaps { present(rate) } else { Vec::new() };
    let mut values: Cow<'_, [f64]> =
        if has_gaps { there.iter().map(|&i| rate[i]).collect() } else { Cow::Borrowed(rate) };
    let count = values.len();
    let limit = -normal_quantile(ALARM / (2 * count * WIDTHS.len()) as f64);
    let mut bad: BTreeSet<usize> = absurd(&values).into_iter().collect();
    if !bad.is_empty() {
        replace(values.to_mut(), &bad);
    }
    let mut singles = (count > 3).then(|| Windows { values: &values, there: &there, width: 1 }.peaks(limit));
    let heavy_tail =
        singles.as_ref().filter(|peaks| is_heavy(peaks, (count - 2) as f64, limit)).map(|peaks| slope(peaks));
    if heavy_tail.is_some() {
        bad.extend(runs(&values, TAIL * limit).into_iter().flatten());
        replace(values.to_mut(), &bad);
        singles = None;
    }
    for width in WIDTHS.into_iter().filter(|width| 3 * *width < count) {
        for _ in 0..LOOKS {
            let before = bad.len();
            let windows = Windows { values: &values, there: &there, width };
            let mut peaks = singles.take().unwrap_or_else(|| windows.peaks(limit));
            let least = heavy_tail.map_or(1.0, |slope| gap(&peaks, slope));
            peaks.retain(|(_, size)| *size > least);
            // no window has the first or last samples in its middle, so the first and the last window flag these too
            let begin = |i: usize| if i == 0 { 0 } else { i + width };
            let end = |i: usize| if i + 3 * width == count { count } else { i + 2 * width };
            peaks.into_iter().for_each(|(i, _)| bad.extend(begin(i)..end(i)));
            if bad.len() as f64 > MOST * count as f64 {
                return None;
            }
            if bad.len() == before {
                break;
            }
            replace(values.to_mut(), &bad);
        }
    }
    Some(bad.into_iter().map(|i| if has_gaps { there[i] } else { i }).collect())
}

fn replace(values: &mut [f64], bad: &BTreeSet<usize>) {
    bad.iter().for_each(|&i| values[i] = f64::NAN);
    fill_gaps(values);
}

/// Samples so large that a sum with them loses the digits of the others.
fn absurd(values: &[f64]) -> Vec<usize> {
    let every = values.len().div_ceil(MEDIAN_OF).max(1);
    let middle = median(values.iter().step_by(every).copied().collect());
    let mut sizes: Vec<f64> = values.iter().step_by(every).map(|value| libm::fabs(value - middle)).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let usual = sizes.get(sizes.len() * 9 / 10).copied().unwrap_or(0.0);
    let is_absurd = |i: &usize| usual > 0.0 && libm::fabs(values[*i] - middle) > ABSURD * usual;
    (0..values.len()).filter(is_absurd).collect()
}

fn present(rate: &[f64]) -> Vec<usize> {
    (0..rate.len()).filter(|&i| !rate[i].is_nan()).collect()
}

/// Sliding windows of three times `width` over a record.
struct Windows<'a> {
    values: &'a [f64],
    /// Index of each value in a record with gaps; empty for a record without gaps.
    there: &'a [usize],
    width: usize,
}

impl Windows<'_> {
    fn len(&self) -> usize {
        self.values.len() + 1 - 3 * self.width
    }

    /// The mean in the middle less the mean of both sides, for each window from `first` to before `end`.
    fn differences(&self, first: usize, end: usize) -> Vec<f64> {
        let (w, width) = (self.width, self.width as f64);
        let part = &self.values[first..end - 1 + 3 * w];
        let level = part[0];
        let mut sums = Vec::with_capacity(part.len() + 1);
        let mut sum = 0.0;
        sums.push(sum);
        for value in part {
            sum += value - level;
            sums.push(sum);
        }
        let [s0, s1, s2, s3] = [0, 1, 2, 3].map(|side| &sums[side * w..]);
        let sides = s0.iter().zip(s1).zip(s2.iter().zip(s3));
        sides.map(|((s0, s1), (s2, s3))| ((s2 - s1) - ((s1 - s0) + (s3 - s2)) / 2.0) / width).collect()
    }

    /// The class of a window, by the number of missing samples in it.
    fn class(&self, window: usize) -> usize {
        if self.there.is_empty() {
            return 0;
        }
        let last = window + 3 * self.width - 1;
        let missing = self.there[last] - self.there[window] - (last - window);
        missing.div_ceil(self.width).min(CLASSES - 1)
    }

    /// The standard deviation of the differences in the windows of each class.
    fn scales(&self) -> [f64; CLASSES] {
        let pieces = self.len().div_ceil(PIECE);
        let every = self.len().div_ceil(SCALED_BY);
        let mut of_class: [Vec<f64>; CLASSES] = Default::default();
        for piece in (0..pieces).step_by(every) {
            let first = piece * PIECE;
            let found = self.differences(first, (first + PIECE).min(self.len()));
            (first..).zip(found).for_each(|(window, d)| of_class[self.class(window)].push(d));
        }
        core::array::from_fn(|class| match of_class[class].len() {
            0 => 0.0,
            1..FEWEST_IN_CLASS if class > 0 => libm::sqrt(NOT_CORRELATED) * scale(&centred(self.values)),
            _ => scale(&of_class[class]),
        })
    }

    /// The windows whose difference is above `limit` standard deviations of their class times [`TAIL`], and its size
    /// in limits. Only the largest difference within two widths to either side counts.
    fn peaks(&self, limit: f64) -> Vec<(usize, f64)> {
        let scales = self.scales();
        let reach = 2 * self.width;
        let pieces = threads::map(self.len().div_ceil(PIECE), |piece| {
            let inside = piece * PIECE..((piece + 1) * PIECE).min(self.len());
            let (first, end) = (inside.start.saturating_sub(reach), (inside.end + reach).min(self.len()));
            let found = self.differences(first, end);
            let least =
                TAIL * limit * scales.iter().copied().filter(|scale| *scale > 0.0).fold(f64::INFINITY, f64::min);
            let size = |i: usize| libm::fabs(found[i - first]) / (limit * scales[self.class(i)]);
            let stands_out = |i: usize| {
                if libm::fabs(found[i - first]) <= least {
                    return None;
                }
                let own = size(i);
                let stands = own > TAIL
                    && (i.saturating_sub(reach).max(first)..(i + reach + 1).min(end)).all(|j| size(j) <= own);
                stands.then_some((i, own))
            };
            inside.filter_map(stands_out).collect::<Vec<(usize, f64)>>()
        });
        pieces.into_iter().flatten().collect()
    }
}

/// True if the noise has a heavy tail: more windows than normal noise between [`TAIL`] and the limit, and more than
/// beyond it. Even Student's t with 2 degrees of freedom has more there, and glitches of any sizes have fewer.
fn is_heavy(peaks: &[(usize, f64)], windows: f64, limit: f64) -> bool {
    let below = peaks.iter().filter(|(_, size)| *size <= 1.0).count();
    if 2 * below <= peaks.len() {
        return false;
    }
    // Normal noise has this many windows beyond `TAIL` on average. The probability of `below` or more is the tail of
    // a Poisson distribution, which is that of χ².
    let expected = windows * chi2_above(libm::pow(TAIL * limit, 2.0), 1.0);
    let by_chance = 1.0 - chi2_above(2.0 * expected, 2.0 * below as f64);
    by_chance < HEAVY_BY_CHANCE
}

/// The mean of ln(size) above the least size, which is 1 divided by the power of the tail (Hill's estimator), with two
/// standard errors. Means of several samples have tails of the same power.
fn slope(peaks: &[(usize, f64)]) -> f64 {
    let least = peaks.iter().map(|(_, size)| *size).fold(f64::INFINITY, f64::min);
    let mean = peaks.iter().map(|(_, size)| libm::log(size / least)).sum::<f64>() / peaks.len() as f64;
    (mean * (1.0 + 2.0 / libm::sqrt(peaks.len() as f64))).min(MOST_SLOPE)
}

/// The size below the lowest gap beyond the limit that is not due to chance in a tail of this slope; infinity without
/// one.
fn gap(peaks: &[(usize, f64)], slope: f64) -> f64 {
    let mut sizes: Vec<f64> = peaks.iter().map(|(_, size)| *size).collect();
    sizes.sort_unstable_by(f64::total_cmp);
    let below = sizes.partition_point(|size| *size <= 1.0);
    // sizes of codes differ by a step at least
    let steps = sizes[..below].windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > ROUNDING);
    let step = steps.min_by(f64::total_cmp).unwrap_or_default();
    let ratio = |at: usize| ((sizes[at] - step) / sizes[at - 1]).max(1.0);
    // ln of the sizes above a threshold is exponentially distributed
    let chance = |at: usize| libm::exp(-libm::log(ratio(at)) * (sizes.len() - at) as f64 / slope);
    let by_chance = GAP_BY_CHANCE / WIDTHS.len() as f64;
    let first = (below.max(1)..sizes.len()).find(|at| chance(*at) < by_chance / (sizes.len() - below) as f64);
    first.map_or(f64::INFINITY, |at| sizes[at - 1])
}

/// The standard deviation of the values, without those beyond [`CLIP`] standard deviations. The median of their sizes
/// alone would be off by up to half a step for coarse codes.
pub(super) fn scale(d: &[f64]) -> f64 {
    let every = d.len().div_ceil(MEDIAN_OF).max(1);
    let sizes = d.iter().step_by(every).map(|d| libm::fabs(*d)).collect();
    let mut sigma = SIGMA_PER_MAD * median(sizes);
    if sigma <= 0.0 {
        sigma = libm::sqrt(d.iter().map(|d| d * d).sum::<f64>() / d.len().max(1) as f64);
    }
    for _ in 0..ITERATIONS {
        let clip = CLIP * sigma;
        let (mut sum, mut count) = (0.0, 0u64);
        for d in d.iter().filter(|d| libm::fabs(**d) < clip) {
            (sum, count) = (sum + d * d, count + 1);
        }
        let next = libm::sqrt(sum / count.max(1) as f64) / CLIPPED;
        let stands = libm::fabs(next - sigma) <= 1e-9 * sigma;
        sigma = next;
        if stands {
            break;
        }
    }
    sigma
}
