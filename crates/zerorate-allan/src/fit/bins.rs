//! The record's cosine spectrum in bins.

use alloc::vec::Vec;

/// Bins per octave, where they have several coefficients.
const PER_OCTAVE: f64 = 12.0;
/// Such a bin is at most 1/`LINEAR` of half the rate wide: lines and a filter's edge need narrow bins.
pub(super) const LINEAR: usize = 160;

/// Adjacent coefficients of the DCT-II. The mean of c²·dt estimates the two-sided density at f = k/(2·record length).
#[derive(Clone, Copy, Debug)]
pub(super) struct Bin {
    pub(super) first: usize,
    /// Index after the last coefficient.
    pub(super) end: usize,
    /// χ² degrees of freedom: the number of coefficients, or less if samples are missing or lines were removed.
    pub(super) freedom: f64,
    /// Mean power, unit²/Hz.
    pub(super) power: f64,
    pub(super) response: Response,
}

/// The response of a bin: its expected power is `offset` + `gain`·S where the noise has the density S.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Response {
    pub(super) offset: f64,
    pub(super) gain: f64,
}

impl Response {
    /// The response of a complete record.
    pub(super) const WHOLE: Self = Self { offset: 0.0, gain: 1.0 };
}

/// Least measured density, as a share of the power, after the power from gaps and folding is subtracted.
const LEAST_DENSITY: f64 = 1e-3;

impl Bin {
    /// Whether the bin has one coefficient. A drift is fitted to such bins only, because a mean power has no sign.
    pub(super) fn is_single(&self) -> bool {
        self.end - self.first == 1
    }

    /// The noise density that the bin measures, unit²/Hz.
    pub(super) fn density(&self) -> f64 {
        ((self.power - self.response.offset) / self.response.gain).max(LEAST_DENSITY * self.power)
    }

    pub(super) fn middle(&self) -> f64 {
        (self.first + self.end - 1) as f64 / 2.0
    }
}

/// The bins of a record of `samples` samples, without power.
pub(super) fn all_edges(samples: usize) -> Vec<Bin> {
    edges(1, samples, samples.saturating_sub(1) / LINEAR)
}

/// Bins of the coefficients from `first` to before `end`, at most `widest` wide, without power.
pub(super) fn edges(first: usize, end: usize, widest: usize) -> Vec<Bin> {
    let growth = libm::exp2(1.0 / PER_OCTAVE) - 1.0;
    let next = |first: usize| (first + ((first as f64 * growth) as usize).min(widest).max(1)).min(end);
    let firsts = core::iter::successors(Some(first), |&first| Some(next(first))).take_while(|&first| first < end);
    let bin = |first: usize| {
        let end = next(first);
        Bin { first, end, freedom: (end - first) as f64, power: 0.0, response: Response::WHOLE }
    };
    firsts.map(bin).collect()
}

/// Interpolates values known at ascending `middles` to the coefficients 1 … `count`.
pub(super) fn at_coefficients(middles: impl Iterator<Item = f64>, values: &[f64], count: usize) -> Vec<f64> {
    let known: Vec<(f64, f64)> = middles.zip(values.iter().copied()).collect();
    (1..=count).map(|k| interpolated(&known, k as f64)).collect()
}

/// Interpolates values known at ascending places: linear between the places, constant beyond the first and last.
pub(super) fn interpolated(known: &[(f64, f64)], at: f64) -> f64 {
    let next = known.partition_point(|(place, _)| *place < at);
    match (next.checked_sub(1).map(|before| known[before]), known.get(next)) {
        (Some((a, from)), Some(&(b, to))) => from + (to - from) * (at - a) / (b - a),
        (Some((_, level)), None) | (None, Some(&(_, level))) => level,
        (None, None) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_coefficient_is_in_one_bin() {
        for n in [3, 18, 1001, 360_000] {
            let found = all_edges(n);
            assert_eq!((found[0].first, found[found.len() - 1].end), (1, n));
            assert!(found.windows(2).all(|pair| pair[0].end == pair[1].first));
            assert!(found.iter().all(|bin| bin.freedom == (bin.end - bin.first) as f64));
        }
        assert!(all_edges(360_000).iter().take(17).all(Bin::is_single));
    }
}
