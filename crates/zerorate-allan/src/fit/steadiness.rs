//! Compares the noise in the parts of a record.

use super::curve::{BLOCKS, Curves};
use super::model::Model;
use crate::{Deviation, chi2_quantile};
use alloc::vec::Vec;

/// An averaging time whose variance is within this share of white noise alone shows how steady the white noise is.
const WHITE: f64 = 0.1;
/// Standard deviations by which the halves of a record must differ at one averaging time.
const DIFFERENT: f64 = 5.0;

/// Length of the windows whose spread shows motion, s, and the least numbers of samples in a window and of windows.
const WINDOW_S: f64 = 10.0;
const FEWEST_IN_WINDOW: usize = 20;
const FEWEST_WINDOWS: usize = 10;
/// The share of the windows that is left out at either end.
const OUTSIDE: f64 = 0.1;
/// Codes resolve noise of more than this many steps: half a step, as for rounding.
const RESOLVED: f64 = 0.5;
/// A sensor moves if the largest standard deviation of the remaining windows exceeds the smallest by this factor.
const MOVES: f64 = 10.0;

/// The ratio of the largest to the smallest standard deviation in windows of ten seconds, without the loudest and the
/// quietest tenth of the windows. `None` if the sensor may be at rest, or for too few windows.
pub(super) fn motion(rate: &[f64], rate_hz: f64) -> Option<f64> {
    let size = ((WINDOW_S * rate_hz) as usize).max(FEWEST_IN_WINDOW);
    let mut sizes: Vec<f64> = rate.chunks_exact(size).filter_map(about_line).filter(|size| *size > 0.0).collect();
    if sizes.len() < FEWEST_WINDOWS {
        return None;
    }
    sizes.sort_unstable_by(f64::total_cmp);
    let outside = (OUTSIDE * sizes.len() as f64) as usize;
    let quiet = sizes[outside].max(step(rate));
    Some(sizes[sizes.len() - 1 - outside] / quiet).filter(|ratio| *ratio > MOVES)
}

/// The standard deviation of a window about its straight line; `None` if half of the window or more is missing.
fn about_line(window: &[f64]) -> Option<f64> {
    let there = || window.iter().enumerate().filter(|(_, value)| !value.is_nan()).map(|(i, value)| (i as f64, *value));
    let count = there().count() as f64;
    let (t_mean, mean) = (there().map(|(t, _)| t).sum::<f64>() / count, there().map(|(_, v)| v).sum::<f64>() / count);
    let (tt, tv, vv) = there().fold((0.0, 0.0, 0.0), |(tt, tv, vv), (t, v)| {
        let (t, v) = (t - t_mean, v - mean);
        (tt + t * t, tv + t * v, vv + v * v)
    });
    (2.0 * count > window.len() as f64).then(|| libm::sqrt((vv - tv * tv / tt).max(0.0) / count))
}

/// The smallest non-zero difference of adjacent samples; 0 if none differ. Coarse codes may hardly change in a window,
/// so no standard deviation below this counts as quiet.
fn step(rate: &[f64]) -> f64 {
    let steps = rate.windows(2).map(|pair| libm::fabs(pair[1] - pair[0])).filter(|step| *step > 0.0);
    let least = steps.fold(f64::INFINITY, f64::min);
    if least.is_finite() { least } else { 0.0 }
}

/// The variance of ln σ²(τ) between eighths of the record. The likelihood assumes steady noise and leaves it out.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Scatter {
    /// One entry per octave, up to a sixteenth of an eighth of the record.
    by_length: Vec<OfLength>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct OfLength {
    /// The averaging time, in samples.
    m: u64,
    variance: f64,
    /// The variance that chance explains.
    chance: f64,
}

impl OfLength {
    fn extra(&self) -> f64 {
        (self.variance - self.chance).max(0.0)
    }

    /// The excess if fewer than 1 of 100 steady records have as large a variance by chance, otherwise 0.
    fn significant(&self) -> f64 {
        let freedom = (BLOCKS - 1) as f64;
        if self.variance / self.chance * freedom > chi2_quantile(0.99, freedom) { self.extra() } else { 0.0 }
    }
}

impl Scatter {
    pub(super) fn of(curves: &Curves<'_>, model: &Model) -> Self {
        let samples = (curves.samples() / BLOCKS) as u64;
        let of = |&m: &u64| {
            let all = || curves.blocks.iter().flatten().filter(move |found| found.m == m);
            let count = all().count() as f64;
            let log = |found: &Deviation| 2.0 * libm::log(found.dev);
            let mean = all().map(log).sum::<f64>() / count;
            let squares = all().map(|found| libm::pow(log(found) - mean, 2.0)).sum::<f64>();
            let terms = all().map(|found| found.n as f64).sum::<f64>() / count;
            let freedom = model.measured_freedom(m, terms as u64, samples);
            (count >= 2.0).then(|| OfLength { m, variance: squares / (count - 1.0), chance: 2.0 / freedom })
        };
        Self { by_length: curves.lengths.iter().filter_map(of).collect() }
    }

    /// Mean excess of three octaves around an averaging time; beyond the end, of the last octaves.
    pub(super) fn near(&self, m: u64) -> f64 {
        let at = self.by_length.partition_point(|of| of.m < m).min(self.by_length.len().max(1) - 1);
        let near = &self.by_length[at.saturating_sub(1)..(at + 2).min(self.by_length.len())];
        near.iter().map(OfLength::extra).sum::<f64>() / near.len().max(1) as f64
    }

    /// The variance of ln N in the mean of the record, from the shortest averaging time at which the curve is white
    /// noise, or else from the averaging time closest to it.
    pub(super) fn variance_of_ln_n(&self, rate_hz: f64, n2: f64, model: &Model) -> f64 {
        let off_white = |of: &OfLength| libm::fabs(libm::log(n2 * rate_hz / of.m as f64 / model.allan_variance(of.m)));
        let nearest = || self.by_length.iter().min_by(|a, b| off_white(a).total_cmp(&off_white(b)));
        let white = self.by_length.iter().find(|of| off_white(of) < WHITE).or_else(nearest);
        // ln σ² is 2 ln N
        white.map_or(0.0, OfLength::significant) / 4.0 / BLOCKS as f64
    }
}

/// An averaging time at which the halves differ by more than chance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Difference {
    pub(super) tau_s: f64,
    /// Deviation of the first half divided by the deviation of the second half.
    pub(super) ratio: f64,
}

/// The ratio of the halves at the averaging time at which they differ most, if one half moves: a few loud windows that
/// [`motion`] leaves out. Codes that do not resolve the noise of the quiet half tell nothing.
pub(super) fn loud_half(curves: &Curves<'_>, model: &Model) -> Option<f64> {
    let of_blocks = |m: u64| curves.blocks.iter().flatten().filter(move |found| found.m == m).map(|found| found.dev);
    let spread = |m: &u64| of_blocks(*m).fold(0.0, f64::max) / of_blocks(*m).fold(f64::INFINITY, f64::min);
    // the eighths of most records are alike, and then the halves, whose curves take passes over the record
    if curves.lengths.iter().all(|m| spread(m) <= MOVES) {
        return None;
    }
    let Difference { tau_s, ratio } = halves(curves, model)?;
    let quiet = curves.blocks.iter().filter_map(|block| Some(block.first()?.dev)).fold(f64::INFINITY, f64::min);
    let is_resolved = quiet > RESOLVED * step(curves.rate);
    let ratio = ratio.max(1.0 / ratio);
    (tau_s <= WINDOW_S && is_resolved && ratio > MOVES && ratio.is_finite()).then_some(ratio)
}

/// The averaging time at which the halves of a record differ most, if they do.
pub(super) fn halves(curves: &Curves<'_>, model: &Model) -> Option<Difference> {
    let samples = curves.samples() as u64 / 2;
    let second = curves.of_parts(BLOCKS / 2..BLOCKS);
    let same = |a: &Deviation| second.iter().find(|b| b.m == a.m).copied();
    let pairs = curves.of_parts(0..BLOCKS / 2).into_iter().filter_map(|a| Some((a, same(&a)?)));
    let score = |(a, b): &(Deviation, Deviation)| {
        let freedom = |found: &Deviation| model.measured_freedom(found.m, found.n, samples);
        let spread = libm::sqrt(2.0 / freedom(a) + 2.0 / freedom(b));
        libm::fabs(2.0 * libm::log(a.dev / b.dev)) / spread
    };
    let worst = pairs.max_by(|a, b| score(a).total_cmp(&score(b))).filter(|pair| score(pair) > DIFFERENT)?;
    let (a, b) = worst;
    Some(Difference { tau_s: a.m as f64 / curves.rate_hz, ratio: a.dev / b.dev })
}
