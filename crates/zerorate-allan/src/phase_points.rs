//! The phase of any input, point by point, for noise identification.

use super::{Gap, Input};
use alloc::vec::Vec;

/// Largest number of points in [`Run::Points`].
const BLOCK: usize = 4096;
const LANES: usize = 8;

pub(crate) enum Run<'a> {
    Points(&'a [f64]),
    /// `count` points of the same value: the samples that lead to them are missing.
    Level {
        value: f64,
        count: u64,
    },
}

/// Number of phase points of `input`, missing ones included. A rate has one more phase point than samples.
pub(crate) fn phase_points(input: &Input<'_>) -> u64 {
    let is_rate = !matches!(input, Input::Phase(_));
    input.len().saturating_add(is_rate.into())
}

/// Slope per point of the phase from [`for_each_run`]. It is 0 for a rate, whose mean is removed.
pub(crate) fn ramp(input: &Input<'_>) -> f64 {
    let Input::Phase(phase) = input else { return 0.0 };
    let present = |at: &usize| !phase[*at].is_nan();
    match ((0..phase.len()).find(present), (0..phase.len()).rfind(present)) {
        (Some(first), Some(last)) if last > first => (phase[last] - phase[first]) / (last - first) as f64,
        _ => 0.0,
    }
}

/// Passes the phase to `visit` in order. A missing sample of rate counts as the mean; a missing phase is interpolated.
/// Only noise identification uses this function. The deviations leave gaps out.
pub(crate) fn for_each_run(input: &Input<'_>, mut visit: impl FnMut(Run<'_>)) {
    match input {
        Input::Codes { codes, gaps } => {
            let mean = codes.iter().map(|&code| i64::from(code)).sum::<i64>() as f64 / codes.len().max(1) as f64;
            integrate_with_gaps(codes, gaps, mean, &mut visit);
        }
        Input::Rate(rate) => {
            let mean = mean_of_present(rate);
            let step = |value: &f64| if value.is_nan() { 0.0 } else { value - mean };
            visit(Run::Points(&[0.0]));
            integrate(rate, 0.0, step, &mut visit);
        }
        Input::Phase(phase) => interpolate(phase, &mut visit),
    }
}

/// Mean of the samples present; 0 without samples. The number of partial sums is fixed, so every machine rounds alike.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
fn mean_of_present(rate: &[f64]) -> f64 {
    let (mut sums, mut counts) = ([0.0; LANES], [0.0; LANES]);
    let (chunks, rest) = rate.as_chunks::<LANES>();
    for chunk in chunks {
        for ((sum, count), value) in sums.iter_mut().zip(&mut counts).zip(chunk) {
            *sum += if value.is_nan() { 0.0 } else { *value };
            *count += if value.is_nan() { 0.0 } else { 1.0 };
        }
    }
    for ((sum, count), value) in sums.iter_mut().zip(&mut counts).zip(rest).filter(|(_, value)| !value.is_nan()) {
        *sum += value;
        *count += 1.0;
    }
    sums.iter().sum::<f64>() / counts.iter().sum::<f64>().max(1.0)
}

fn integrate_with_gaps(codes: &[i32], gaps: &[Gap], mean: f64, visit: &mut impl FnMut(Run<'_>)) {
    let step = |code: &i32| f64::from(*code) - mean;
    let (mut from, mut phase) = (0, 0.0);
    visit(Run::Points(&[0.0]));
    for gap in gaps {
        let at = gap.at.clamp(from, codes.len());
        phase = integrate(&codes[from..at], phase, step, visit);
        visit(Run::Level { value: phase, count: gap.missing });
        from = at;
    }
    integrate(&codes[from..], phase, step, visit);
}

fn integrate<T>(values: &[T], start: f64, step: impl Fn(&T) -> f64, visit: &mut impl FnMut(Run<'_>)) -> f64 {
    let mut phase = start;
    let mut block = Vec::with_capacity(BLOCK);
    for part in values.chunks(BLOCK) {
        block.clear();
        block.extend(part.iter().map(|value| {
            phase += step(value);
            phase
        }));
        visit(Run::Points(&block));
    }
    phase
}

/// Interpolates linearly between points present. The phase is 0 up to the first point, and constant after the last.
fn interpolate(phase: &[f64], visit: &mut impl FnMut(Run<'_>)) {
    let mut present = (0..phase.len()).filter(|&at| !phase[at].is_nan()).peekable();
    let Some(&first) = present.peek() else { return };
    let offset = phase[first];
    let mut block = Vec::with_capacity(BLOCK);
    let (mut left, mut right) = (first, present.next());
    for at in 0..phase.len() {
        if right == Some(at) {
            left = at;
            right = present.find(|&next| next > at);
        }
        block.push(value_at(phase, at, left, right) - offset);
        if block.len() == BLOCK {
            visit(Run::Points(&block));
            block.clear();
        }
    }
    visit(Run::Points(&block));
}

fn value_at(phase: &[f64], at: usize, left: usize, right: Option<usize>) -> f64 {
    match right {
        Some(right) if at > left => {
            let share = (at - left) as f64 / (right - left) as f64;
            phase[left] + share * (phase[right] - phase[left])
        }
        _ => phase[left],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(input: &Input<'_>) -> Vec<f64> {
        let mut all = Vec::new();
        for_each_run(input, |run| match run {
            Run::Points(points) => all.extend_from_slice(points),
            Run::Level { value, count } => all.extend((0..count).map(|_| value)),
        });
        assert_eq!(all.len() as u64, phase_points(input));
        all
    }

    #[test]
    fn the_mean_is_taken_off_and_a_missing_sample_is_the_mean() {
        let gaps = [Gap { at: 1, missing: 2 }];
        assert_eq!(points(&Input::Codes { codes: &[1, 3, 2], gaps: &gaps }), [0.0, -1.0, -1.0, -1.0, 0.0, 0.0]);
        assert_eq!(points(&Input::Rate(&[1.0, f64::NAN, f64::NAN, 3.0, 2.0])), [0.0, -1.0, -1.0, -1.0, 0.0, 0.0]);
    }

    #[test]
    fn gaps_of_a_phase_are_bridged() {
        let nan = f64::NAN;
        assert_eq!(points(&Input::Phase(&[nan, 5.0, 6.0, nan, nan, 9.0, nan])), [0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
        assert_eq!(ramp(&Input::Phase(&[nan, 5.0, 6.0, nan, nan, 9.0, nan])), 1.0);
    }

    #[test]
    fn blocks_join() {
        let rate: Vec<f64> = (0..10_000).map(|i| f64::from(i % 7)).collect();
        let whole = points(&Input::Rate(&rate));
        let mean = rate.iter().sum::<f64>() / 10_000.0;
        assert!(whole.windows(2).zip(&rate).all(|(pair, y)| (pair[1] - pair[0] - (y - mean)).abs() < 1e-9));
    }
}
