//! The record's cosine spectrum in bins.

use alloc::vec::Vec;

/// Bins per octave, and at least this many up to half the rate: lines and a filter's edge need narrow bins there.
const PER_OCTAVE: f64 = 12.0;
const LINEAR: usize = 160;

/// Adjacent coefficients of the DCT-II. The mean of their c²·dt estimates the two-sided density at f = k/(2T).
#[derive(Clone, Copy, Debug)]
pub(super) struct Bin {
    /// The first of them.
    pub(super) first: usize,
    /// One past the last.
    pub(super) end: usize,
    /// χ² degrees of freedom: the number of coefficients, less where samples or lines were taken out.
    pub(super) freedom: f64,
    /// Mean power, unit²/Hz.
    pub(super) power: f64,
    /// The way from the density of the noise to the density of the sampled record.
    pub(super) response: Response,
}

/// The response of a bin. Its expected power is `offset` + `slow`·(S − W) + `white`·W where the noise has the density
/// S, of which W is white.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Response {
    pub(super) offset: f64,
    pub(super) slow: f64,
    pub(super) white: f64,
}

impl Response {
    /// The response of a complete record.
    pub(super) const WHOLE: Self = Self { offset: 0.0, slow: 1.0, white: 1.0 };
}

impl Bin {
    /// Whether it is one coefficient, in which the phase of a drift shows.
    pub(super) fn is_single(&self) -> bool {
        self.end - self.first == 1
    }

    /// Its middle, in coefficients.
    pub(super) fn middle(&self) -> f64 {
        (self.first + self.end - 1) as f64 / 2.0
    }
}

/// Bins of the powers of the coefficients 1, 2 …
pub(super) fn bins(power: &[f64]) -> Vec<Bin> {
    let mut bins = empty_bins(power.len() + 1);
    for bin in &mut bins {
        bin.power = power[bin.first - 1..bin.end - 1].iter().sum::<f64>() / bin.freedom;
    }
    bins
}

/// The bins of a record of `samples` samples, without power.
pub(super) fn empty_bins(samples: usize) -> Vec<Bin> {
    let widest = (samples.saturating_sub(1) / LINEAR).max(1);
    let growth = libm::exp2(1.0 / PER_OCTAVE) - 1.0;
    let next = |first: usize| (first + ((first as f64 * growth) as usize).min(widest).max(1)).min(samples);
    let firsts = core::iter::successors(Some(1), |&first| Some(next(first))).take_while(|&first| first < samples);
    let bin = |first: usize| {
        let end = next(first);
        Bin { first, end, freedom: (end - first) as f64, power: 0.0, response: Response::WHOLE }
    };
    firsts.map(bin).collect()
}

/// Interpolates values known at ascending `middles` to the coefficients 1 … `count`: linear between, level beyond.
pub(super) fn at_coefficients(middles: impl Iterator<Item = f64>, values: &[f64], count: usize) -> Vec<f64> {
    let known: Vec<(f64, f64)> = middles.zip(values.iter().copied()).collect();
    let mut at = Vec::with_capacity(count);
    let mut next = 0;
    for k in 1..=count {
        let k = k as f64;
        while next < known.len() && known[next].0 < k {
            next += 1;
        }
        at.push(match (next.checked_sub(1).map(|before| known[before]), known.get(next)) {
            (Some((a, from)), Some(&(b, to))) => from + (to - from) * (k - a) / (b - a),
            (Some((_, level)), None) | (None, Some(&(_, level))) => level,
            (None, None) => 0.0,
        });
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn every_coefficient_is_in_one_bin() {
        for n in [2, 17, 1000, 359_999] {
            let found = bins(&vec![2.0; n]);
            assert_eq!((found[0].first, found[found.len() - 1].end), (1, n + 1));
            assert!(found.windows(2).all(|pair| pair[0].end == pair[1].first));
            assert!(found.iter().all(|bin| bin.power == 2.0 && bin.freedom == (bin.end - bin.first) as f64));
        }
        assert!(bins(&vec![1.0; 359_999]).iter().take(17).all(Bin::is_single));
    }
}
