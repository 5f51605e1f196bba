//! The power of a level in segments, each under a taper.
//!
//! Segments overlap by half under a sine taper. The squares of two tapers add to 1, so no sample is lost. The leakage
//! falls with the fourth power of the distance instead of the square. If values are missing, mean products of the
//! values present give the autocovariance of noise of any colour. Its transform is the density.

use crate::kernels::threads;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use realfft::num_complex::Complex64;
use realfft::{FftError, RealFftPlanner};

/// Shortest and longest segment, and the least number of segments that the length aims for.
const LENGTHS: (usize, usize) = (64, 16_384);
const FEWEST: usize = 8;
/// Number of segments that one thread takes at a time.
const TOGETHER: usize = 32;
/// Number of lags over which the share of pairs with both values present is averaged.
const NEIGHBOURS: usize = 16;
/// Lags with a smaller share of the pairs do not count.
const FEWEST_PAIRS: f64 = 1e-3;
/// Largest number of values in a mean that is subtracted before gaps become zero. Otherwise slow wander would leak
/// from the gaps into every frequency.
const WANDER: usize = 512;

/// The power of a level at frequencies 0, 1 … of its segments.
pub(super) struct Power {
    /// The mean squares, divided by the share of the power that gaps do not spread to other frequencies.
    pub(super) raw: Vec<f64>,
    /// The mean squares without the power that gaps add: unbiased for noise of any colour.
    pub(super) fair: Vec<f64>,
    pub(super) count: f64,
}

/// The length of the segments of a level: a power of two.
pub(super) fn length(values: usize) -> usize {
    let (shortest, longest) = LENGTHS;
    let most = (values / FEWEST).clamp(shortest, longest);
    1 << most.ilog2()
}

fn taper(length: usize) -> Vec<f64> {
    (0..length).map(|i| libm::sin(PI * (i as f64 + 0.5) / length as f64)).collect()
}

/// The start of each segment. One more segment ends with the level if over a quarter of a segment would be left over.
fn starts(values: usize, length: usize) -> impl Iterator<Item = usize> {
    let half = length / 2;
    let last = (values - length) / half * half;
    let rest = values - length - last;
    (0..=last).step_by(half).chain((rest > half / 2).then_some(values - length))
}

/// The power of a level without gaps.
pub(super) fn complete(values: &[f64], length: usize) -> Result<Power, FftError> {
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let (taper, starts) = (taper(length), starts(values.len(), length).collect::<Vec<usize>>());
    let groups: Vec<&[usize]> = starts.chunks(TOGETHER).collect();
    let sums = threads::map(groups.len(), |group| {
        let (mut segment, mut lines) = (fft.make_input_vec(), fft.make_output_vec());
        let mut sum = vec![0.0; lines.len()];
        for &first in groups[group] {
            let part = &values[first..first + length];
            let mean = part.iter().sum::<f64>() / length as f64;
            for ((cell, value), weight) in segment.iter_mut().zip(part).zip(&taper) {
                *cell = (value - mean) * weight;
            }
            fft.process(&mut segment, &mut lines)?;
            sum.iter_mut().zip(&lines).for_each(|(sum, line)| *sum += line.norm_sqr());
        }
        Ok(sum)
    });
    let mut raw = vec![0.0; length / 2 + 1];
    let weight = starts.len() as f64 * length as f64 / 2.0;
    for sum in sums {
        raw.iter_mut().zip(sum?).for_each(|(raw, sum)| *raw += sum / weight);
    }
    Ok(Power { fair: raw.clone(), raw, count: starts.len() as f64 })
}

/// The power of a level with gaps, where NaN is a missing value.
pub(super) fn masked(values: &[f64], length: usize) -> Result<Power, FftError> {
    let rest = without_wander(values, length.min(WANDER));
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(2 * length);
    let (taper, mut lines) = (taper(length), fft.make_output_vec());
    let mut power_of = |of: &dyn Fn(usize) -> f64, sum: &mut [f64]| -> Result<(), FftError> {
        let mut segment = fft.make_input_vec();
        segment.iter_mut().zip(&taper).enumerate().for_each(|(i, (cell, weight))| *cell = of(i) * weight);
        fft.process(&mut segment, &mut lines)?;
        sum.iter_mut().zip(&lines).for_each(|(sum, line)| *sum += line.norm_sqr());
        Ok(())
    };
    let [mut products, mut pairs, mut whole] = [(); 3].map(|()| vec![0.0; length + 1]);
    let mut count = 0.0;
    for first in starts(values.len(), length) {
        power_of(&|i| rest[first + i], &mut products)?;
        power_of(&|i| f64::from(u8::from(!values[first + i].is_nan())), &mut pairs)?;
        count += 1.0;
    }
    power_of(&|_| 1.0, &mut whole)?;
    let raw: Vec<f64> = products.iter().step_by(2).copied().collect();
    let [products, pairs, whole] = [products, pairs, whole].map(|power| correlation(&power));
    let [products, pairs, whole] = [products?, pairs?, whole?];
    let there = pairs[0];
    let fair: Vec<f64> = (0..=length)
        .map(|lag| match pairs[lag] > FEWEST_PAIRS * there {
            true => products[lag] / pairs[lag] * whole[lag] / whole[0],
            false => 0.0,
        })
        .collect();
    let both: f64 = (1..=NEIGHBOURS).map(|lag| pairs[lag] / whole[lag]).sum::<f64>() / NEIGHBOURS as f64;
    let kept = both * whole[0] / there;
    Ok(Power {
        raw: raw.into_iter().map(|power| power / (there * kept)).collect(),
        fair: spectrum_of(&fair)?.into_iter().step_by(2).collect(),
        count,
    })
}

/// The values less straight lines that join the means of every `block` values. A missing value becomes 0.
fn without_wander(values: &[f64], block: usize) -> Vec<f64> {
    let mut means: Vec<f64> = values
        .chunks(block)
        .map(|block| {
            let there = || block.iter().filter(|value| !value.is_nan());
            there().sum::<f64>() / there().count() as f64
        })
        .collect();
    super::averages::fill_gaps(&mut means);
    let level = |i: usize| {
        let at = ((i as f64 + 0.5) / block as f64 - 0.5).clamp(0.0, (means.len() - 1) as f64);
        let before = (at as usize).min(means.len().saturating_sub(2));
        let next = means.get(before + 1).unwrap_or(&means[before]);
        means[before] + (next - means[before]) * (at - before as f64)
    };
    let rest = |(i, value): (usize, &f64)| if value.is_nan() { 0.0 } else { value - level(i) };
    values.iter().enumerate().map(rest).collect()
}

/// Σ x_i x_{i + lag} at lags 0 … N/2 from the power |X|² at 0 … N/2.
fn correlation(power: &[f64]) -> Result<Vec<f64>, FftError> {
    let len = 2 * (power.len() - 1);
    let fft = RealFftPlanner::<f64>::new().plan_fft_inverse(len);
    let mut lines: Vec<Complex64> = power.iter().map(|&power| Complex64::new(power / len as f64, 0.0)).collect();
    let mut sums = fft.make_output_vec();
    fft.process(&mut lines, &mut sums)?;
    sums.truncate(power.len());
    Ok(sums)
}

/// The inverse of [`correlation`]: Σ over all lags of an even correlation times the cosine, at 0 … N/2.
fn spectrum_of(correlation: &[f64]) -> Result<Vec<f64>, FftError> {
    let half = correlation.len() - 1;
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(2 * half);
    let mut even: Vec<f64> = correlation.iter().chain(correlation[1..half].iter().rev()).copied().collect();
    let mut lines = fft.make_output_vec();
    fft.process(&mut even, &mut lines)?;
    Ok(lines.into_iter().map(|line| line.re).collect())
}
