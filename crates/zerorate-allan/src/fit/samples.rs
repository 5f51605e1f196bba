//! The record in the form that is fitted.

use super::{FEWEST_SAMPLES, FitError, glitches, spectrum};
use crate::{AllanWarning, Input, kernels};
use alloc::borrow::Cow;
use alloc::vec::Vec;

/// Least share of samples that must be present.
const FEWEST_PRESENT: f64 = 0.25;

impl Input<'_> {
    /// The rate of a record sampled `rate_hz` times per second, times `scale`. Missing samples, also in gaps, are NaN.
    #[must_use]
    pub fn rates(&self, rate_hz: f64, scale: f64) -> Vec<f64> {
        match self {
            Self::Rate(rate) => rate.iter().map(|value| value * scale).collect(),
            Self::Phase(phase) => phase.windows(2).map(|pair| (pair[1] - pair[0]) * rate_hz * scale).collect(),
            Self::Codes { codes, gaps } => {
                kernels::expanded(codes, gaps).into_iter().map(|code| code * scale).collect()
            }
        }
    }
}

/// As [`Input::rates`], but without a copy if the rate is in the unit of the result.
pub(super) fn rates<'a>(input: &Input<'a>, rate_hz: f64, scale: f64) -> Cow<'a, [f64]> {
    match *input {
        Input::Rate(rate) if scale == 1.0 => Cow::Borrowed(rate),
        _ => Cow::Owned(input.rates(rate_hz, scale)),
    }
}

/// Checks that enough samples are present, before gaps are written out as samples. This bounds the memory.
pub(super) fn enough(present: u64, samples: u64) -> Result<(), FitError> {
    if present < FEWEST_SAMPLES {
        return Err(FitError::TooShort { samples: present });
    }
    if (present as f64) < FEWEST_PRESENT * samples as f64 {
        return Err(FitError::Gaps { present, samples });
    }
    Ok(())
}

pub(super) fn check(rate: &[f64]) -> Result<(), FitError> {
    let values = || rate.iter().filter(|value| !value.is_nan());
    let (low, high) = values().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), v| (a.min(*v), b.max(*v)));
    if low == high {
        return Err(FitError::Constant);
    }
    // squares of sums over the record must stay finite
    let largest = libm::fabs(low).max(libm::fabs(high)) * rate.len() as f64;
    let (square, least) = (largest * largest, (high - low) * (high - low));
    if square.is_finite() && least.is_normal() { Ok(()) } else { Err(FitError::NotFinite) }
}

/// Replaces the glitches by straight lines, and returns the index of the first sample of each. If there are too many,
/// replaces none and returns an empty list. Adds a warning unless there are no glitches.
pub(super) fn cut_glitches(rate: &mut Cow<'_, [f64]>, warnings: &mut Vec<AllanWarning>) -> Vec<usize> {
    let power = |rate: &[f64]| {
        let pairs = rate.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| !step.is_nan());
        let (sum, count) = pairs.fold((0.0, 0u64), |(sum, count), step| (sum + step * step, count + 1));
        sum / count.max(1) as f64
    };
    let Some(found) = glitches::glitches(rate) else {
        warnings.push(AllanWarning::ManyGlitches { most: glitches::MOST });
        return Vec::new();
    };
    if found.is_empty() {
        return found;
    }
    let before = power(rate);
    let rate = rate.to_mut();
    let missing: Vec<usize> = (0..rate.len()).filter(|&i| rate[i].is_nan()).collect();
    found.iter().for_each(|&i| rate[i] = f64::NAN);
    spectrum::averages::fill_gaps(rate);
    missing.into_iter().for_each(|i| rate[i] = f64::NAN);
    let ratio = libm::sqrt(before / power(rate).max(f64::MIN_POSITIVE));
    let firsts: Vec<usize> = found.chunk_by(|a, b| *b == a + 1).map(|glitch| glitch[0]).collect();
    warnings.push(AllanWarning::Glitches { glitches: firsts.len() as u64, samples: found.len() as u64, ratio });
    firsts
}
