//! The effect of gaps on a measured curve: if bursts are missing, averages over the rest scatter more.
//!
//! The deviations allow for samples that are missing one by one, for any noise: the samples present represent the
//! missing ones. That does not hold for bursts. If adjacent samples are correlated, an average over a few bursts of
//! them scatters more than the deviations assume.

use alloc::vec;
use alloc::vec::Vec;

/// An average counts if at least this share of its samples is present.
const COUNTS: f64 = 0.5;
/// Number of lags at which the short noise may be correlated, and the longest average with a factor of its own, in
/// samples. Longer averages have the factor of that average.
const LAGS: usize = 128;
const LONGEST: usize = 4096;
/// For averages of m samples, at most `LOOKED_AT`/m pairs are examined. This number is limited to the range `LOOKS`.
const LOOKED_AT: usize = 1 << 16;
const LOOKS: (usize, usize) = (8, 512);

/// The effect of gaps on the Allan variance of the short noise: white noise and quantisation behind the filter.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Thinning {
    /// Factors on the Allan variance of the short noise, for averages of 1, 2, 4 … samples; empty without gaps.
    factors: Vec<f64>,
    /// The share of the samples that is missing.
    missing: f64,
}

impl Thinning {
    /// The factors of a record, from the autocovariance of its short noise.
    pub(super) fn of(rate: &[f64], covariance: &[f64]) -> Self {
        let is_there: Vec<bool> = rate.iter().map(|value| !value.is_nan()).collect();
        if is_there.iter().all(|is_there| *is_there) {
            return Self::default();
        }
        let lengths = (0..).map(|octave| 1 << octave).take_while(|m| 2 * m <= rate.len().min(2 * LONGEST));
        let missing = is_there.iter().filter(|is_there| !**is_there).count() as f64 / is_there.len() as f64;
        Self { factors: lengths.map(|m| factor(&is_there, m, covariance)).collect(), missing }
    }

    /// The variance that gaps add to averages of `m` samples, as a share of the variance of the short noise. The
    /// computation of deviations subtracts this variance.
    pub(super) fn added(&self, m: u64) -> f64 {
        let present = (1.0 - self.missing).max(COUNTS);
        if m > 1 { 1.0 / present - 1.0 } else { 0.0 }
    }

    pub(super) fn at(&self, m: u64) -> f64 {
        let octave = libm::log2(m as f64);
        let before = (octave as usize).min(self.factors.len().saturating_sub(1));
        let Some(a) = self.factors.get(before) else { return 1.0 };
        let b = self.factors.get(before + 1).unwrap_or(a);
        a + (b - a) * (octave - before as f64).clamp(0.0, 1.0)
    }
}

fn factor(is_there: &[bool], m: usize, covariance: &[f64]) -> f64 {
    let starts = is_there.len() - 2 * m + 1;
    let looks = (LOOKED_AT / m).clamp(LOOKS.0, LOOKS.1);
    let squares = (0..starts).step_by(starts.div_ceil(looks));
    let squares = squares.filter_map(|start| square(&is_there[start..start + 2 * m], covariance));
    let (sum, count) = squares.fold((0.0, 0.0), |(sum, count), square| (sum + square, count + 1.0));
    let whole = square(&vec![true; 2 * m], covariance).unwrap_or(0.0);
    if count > 0.0 && whole > 0.0 { (sum / count / whole).max(1.0) } else { 1.0 }
}

/// The expected square of a difference of two averages, corrected as in the deviations. `None` if an average lacks
/// more than half of its values, or has only one of several.
fn square(is_there: &[bool], covariance: &[f64]) -> Option<f64> {
    let m = is_there.len() / 2;
    let halves = [&is_there[..m], &is_there[m..]];
    let weights = halves.map(|half| {
        let count = half.iter().filter(|is_there| **is_there).count() as f64;
        half.iter().map(|is_there| f64::from(u8::from(*is_there)) / count).collect::<Vec<f64>>()
    });
    let mut added = 0.0;
    for (half, weights) in halves.iter().zip(&weights) {
        let count = half.iter().filter(|is_there| **is_there).count();
        if (count as f64) < COUNTS * m as f64 || count < m.min(2) {
            return None;
        }
        if count > 1 {
            let count = count as f64;
            let within = count / (count - 1.0) * (covariance[0] - variance(weights, covariance));
            added += within * (1.0 / count - 1.0 / m as f64);
        }
    }
    let difference: Vec<f64> = weights[0].iter().map(|weight| -weight).chain(weights[1].iter().copied()).collect();
    Some(variance(&difference, covariance) - added)
}

fn variance(weights: &[f64], covariance: &[f64]) -> f64 {
    let lags = covariance.iter().take(LAGS.min(weights.len())).enumerate();
    let term = |(lag, c): (usize, &f64)| {
        let twice = if lag == 0 { 1.0 } else { 2.0 };
        twice * c * weights.iter().zip(&weights[lag..]).map(|(a, b)| a * b).sum::<f64>()
    };
    lags.map(term).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: neighbours have the correlation ½. So averages of 8 samples with one run of 4 present have the
    /// variance (4 + 2·3/2)/16 = 7/16. The corrections are exact for white noise.
    #[test]
    fn bursts_of_correlated_samples_scatter_more() {
        let every_second: Vec<f64> = (0..10_000).map(|i| if i % 2 == 0 { 1.0 } else { f64::NAN }).collect();
        let white = Thinning::of(&every_second, &[1.0]);
        assert!([2, 8, 32, 128, 1024].iter().all(|m| (white.at(*m) - 1.0).abs() < 1e-9), "{white:?}");
        let half: Vec<bool> = [true, true, true, true, false, false, false, false].repeat(2);
        let within = 4.0 / 3.0 * (1.0 - 7.0 / 16.0);
        let by_hand = 2.0 * (7.0 / 16.0 - within * (1.0 / 4.0 - 1.0 / 8.0));
        assert!((square(&half, &[1.0, 0.5]).unwrap() - by_hand).abs() < 1e-12);
        assert_eq!(Thinning::of(&[1.0; 100], &[1.0]).at(16), 1.0);
    }
}
