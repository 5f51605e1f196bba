//! Detects interleaved rows of several sensors, where no column tells the sensors apart.

use crate::codes;
use zerorate_logs::Column;

/// Largest number of samples of an axis that are compared.
const SAMPLES: usize = 1 << 16;
/// Standard deviation of normal noise, divided by the mean of its absolute values without the largest 1 %.
pub(super) const PER_MEAN: f64 = 1.29;

const FEWEST_GROUPS: f64 = 200.0;

/// Least significance of a difference between the places in a group, in standard deviations. Of normal, filtered,
/// coarse and heavy-tailed noise, none of 3000 simulated records of 400 to 65,536 samples reaches it.
const SURE: f64 = 7.0;

/// The noises at two places in a group have a ratio whose standard deviation is this factor times the relative
/// standard deviation of a step, divided by the root of the number of groups.
const OF_NOISES: f64 = 2.6;

/// Least ratio of the noise of two sensors that counts as different.
const NOISES: f64 = 1.25;

/// The mean absolute step from sample to sample, and the relative standard deviation of the absolute steps. The
/// largest 1 % of the steps are left out.
pub(super) fn steps(samples: &[f64]) -> (f64, f64) {
    let samples = &samples[..samples.len().min(SAMPLES)];
    let mut steps: Vec<f64> = samples.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    steps.sort_unstable_by(f64::total_cmp);
    let most = &steps[..steps.len() * 99 / 100];
    let mean = |numbers: &mut dyn Iterator<Item = f64>| numbers.sum::<f64>() / most.len().max(1) as f64;
    let usual = mean(&mut most.iter().copied());
    (usual, mean(&mut most.iter().map(|step| (step - usual).powi(2))).sqrt() / usual)
}

/// Describes interleaved rows of two to four sensors, if the levels or the noise of the samples show them.
pub(super) fn doubt(axes: &[Column]) -> Option<String> {
    let of_axis = |axis: &Column| {
        let numbers = codes::numbers(axis);
        let numbers = &numbers[..numbers.len().min(SAMPLES)];
        let several = (2..=4).find(|several| differ_in_turn(numbers, *several))?;
        Some(format!("samples of {} differ in turns of {several}, as of {several} sensors", axis.name))
    };
    axes.iter().find_map(of_axis)
}

/// True if samples differ by their place in each group of `several`: in the mean deviation from the mean of the
/// group, or in the steps between samples at the same place of adjacent groups.
fn differ_in_turn(samples: &[f64], several: usize) -> bool {
    let groups = || samples.chunks_exact(several);
    let count = groups().len() as f64;
    if count < FEWEST_GROUPS {
        return false;
    }
    let level = |place: usize| {
        let off = groups().map(|group| group[place] - group.iter().sum::<f64>() / several as f64);
        let (sum, squares) = off.fold((0.0, 0.0), |(sum, squares), off| (sum + off, squares + off * off));
        (sum / count).abs() > SURE * (squares / count).sqrt() / count.sqrt()
    };
    let noise = |place: usize| steps(&groups().map(|group| group[place]).collect::<Vec<f64>>());
    let noises: Vec<(f64, f64)> = (0..several).map(noise).collect();
    let [least, most] =
        [f64::min, f64::max].map(|of| noises.iter().map(|noise| noise.0).reduce(of).unwrap_or_default());
    let spread = noises.iter().map(|noise| noise.1).fold(0.0, f64::max);
    (0..several).any(level) || most > least * (1.0 + OF_NOISES * SURE * spread / count.sqrt()).max(NOISES)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Nearly normal numbers, each a sum of twelve uniform ones.
    fn normal(count: usize) -> Vec<f64> {
        let mut state = 1u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(|_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0).collect()
    }

    #[test]
    fn interleaved_rows_differ_in_level_or_noise() {
        let noise = normal(6000);
        let walk: Vec<f64> = noise
            .iter()
            .scan(0.0, |sum, one| {
                *sum += one;
                Some(*sum)
            })
            .collect();
        for several in 2..=4 {
            assert!(!differ_in_turn(&noise, several) && !differ_in_turn(&walk, several), "{several}");
            let turned = |change: fn(f64) -> f64| -> Vec<f64> {
                noise.iter().enumerate().map(|(at, one)| if at % several == 1 { change(*one) } else { *one }).collect()
            };
            assert!(differ_in_turn(&turned(|one| one + 0.5), several), "level {several}");
            assert!(differ_in_turn(&turned(|one| one * 1.6), several), "noise {several}");
        }
    }
}
