//! Glitches: single samples, and a few in a row, that noise does not explain.

use super::lines::median;
use super::spectrum::fill_gaps;
use crate::chi2::normal_quantile;
use alloc::vec;
use alloc::vec::Vec;

/// Widths of the glitches that are looked for, in samples.
const WIDTHS: [usize; 4] = [1, 2, 4, 8];
/// False alarms per record.
const ALARM: f64 = 0.01;
/// Looks at each width. Only neighbours of earlier finds need more than two.
const LOOKS: usize = 8;
/// Where more than this share of the samples is flagged, they belong to the noise itself.
pub(super) const MOST: f64 = 0.01;
/// Values beyond this many standard deviations do not enter them, and the share of them that this takes away.
const CLIP: f64 = 4.0;
const CLIPPED: f64 = 0.99946;
const ITERATIONS: usize = 20;
/// The start of the scale is a median over this many samples.
const MEDIAN_OF: usize = 1 << 16;
const SIGMA_PER_MAD: f64 = 1.4826;

/// Samples that are glitches, or so near to one that their averages hold it, ascending. None where they would be too
/// many.
///
/// The mean of w samples is compared with the means of the w before and the w after. That is linear, so the rate of
/// false alarms holds for noise with a memory as well: a median against its window gave 270 times as many. The
/// narrowest width comes first, and finds are replaced before the next look. Otherwise one sample would take eight
/// with it, and hide the one beside it.
///
/// Missing samples are closed up for this: lines in their place would scatter less than noise does.
pub(super) fn glitches(rate: &[f64]) -> Option<Vec<usize>> {
    let there: Vec<usize> = (0..rate.len()).filter(|&i| !rate[i].is_nan()).collect();
    let mut values: Vec<f64> = there.iter().map(|&i| rate[i]).collect();
    let limit = -normal_quantile(ALARM / (2 * there.len() * WIDTHS.len()) as f64);
    let mut bad = vec![false; there.len()];
    let is_bad = |bad: &[bool]| bad.iter().filter(|bad| **bad).count();
    for width in WIDTHS.into_iter().filter(|width| 3 * *width < there.len()) {
        for _ in 0..LOOKS {
            let before = is_bad(&bad);
            flag(&sums(&values), width, limit, &mut bad);
            let now = is_bad(&bad);
            if now as f64 > MOST * there.len() as f64 {
                return None;
            }
            if now == before {
                break;
            }
            values.iter_mut().zip(&bad).filter(|(_, bad)| **bad).for_each(|(value, _)| *value = f64::NAN);
            fill_gaps(&mut values);
        }
    }
    Some(there.iter().zip(&bad).filter(|(_, bad)| **bad).map(|(i, _)| *i).collect())
}

/// Running sums about the mean.
fn sums(values: &[f64]) -> Vec<f64> {
    let mean = values.iter().sum::<f64>() / values.len().max(1) as f64;
    let mut sum = 0.0;
    let next = values.iter().map(|value| {
        sum += value - mean;
        sum
    });
    core::iter::once(0.0).chain(next).collect()
}

/// Marks the samples that stand out at one width.
fn flag(sums: &[f64], width: usize, limit: f64, bad: &mut [bool]) {
    let w = width as f64;
    let d: Vec<f64> = sums
        .windows(3 * width + 1)
        .map(|s| ((s[2 * width] - s[width]) - ((s[width] - s[0]) + (s[3 * width] - s[2 * width])) / 2.0) / w)
        .collect();
    let alarm = limit * scale(&d);
    for i in (0..d.len()).filter(|&i| libm::fabs(d[i]) > alarm) {
        let near = &d[i.saturating_sub(2 * width)..(i + 2 * width + 1).min(d.len())];
        if near.iter().all(|other| libm::fabs(*other) <= libm::fabs(d[i])) {
            bad[i + width..i + 2 * width].fill(true);
        }
    }
}

/// The standard deviation of the samples that are not flagged. (A median alone is off by up to half a step for coarse
/// codes.)
fn scale(d: &[f64]) -> f64 {
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
