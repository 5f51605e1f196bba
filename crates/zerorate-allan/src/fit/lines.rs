//! Finds spectral lines, which stand out of the bins beside them. Bins of broad lines are masked. The coefficients of
//! narrow lines are removed from their bins.

use super::bins::{Bin, at_coefficients};
use crate::chi2_quantile;
use alloc::vec;
use alloc::vec::Vec;
use core::ops::Range;

/// A spectral line: a disturbance or a resonance. The fit leaves it out, and its power is reported.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Line {
    /// Frequency, Hz. A disturbance above half the rate appears at its alias.
    pub frequency_hz: f64,
    /// Width, Hz. For a broad line, the width of the band that holds the middle half of its power.
    pub width_hz: f64,
    /// Root mean square, in the unit of the rate.
    pub rms: f64,
}

/// Expected number of false lines per record.
const ALARM: f64 = 0.01;
/// Lowest coefficient in which a line is sought. An excess below it is taken for slow noise.
const FIRST: usize = 48;
/// Factor on the limit that a bin in a line must exceed. The factor allows for the error of the base line.
const MARGIN: f64 = 1.15;
/// Number of coefficients that are tested together for narrow lines, and the margin for them.
const GROUP: usize = 4;
const NARROW_MARGIN: f64 = 1.1;
/// Least degrees of freedom of the bins on one side of a bin that set its base line.
const LEAST_FREEDOM: f64 = 32.0;
/// Degrees of freedom of a median, and of a line's end, as shares of those of the bins.
const OF_MEDIAN: f64 = core::f64::consts::FRAC_2_PI;
const OF_END: f64 = 0.25;
/// Number of coefficients that are removed before the first coefficient of a group with a line, and from it on.
const BEFORE: usize = 2;
const AFTER: usize = 6;

/// The mask of bins in a line, and the base line above which they stand out. The base line is computed twice, the
/// second time without the bins that stand out of the first.
pub(super) fn broad(bins: &[Bin]) -> (Vec<bool>, BaseLine) {
    let first = above(bins, &base_line(bins, &vec![false; bins.len()]));
    let base = base_line(bins, &first);
    (above(bins, &base), base)
}

/// The level above which lines stand out.
pub(super) struct BaseLine {
    level: Vec<f64>,
    /// Degrees of freedom of the level, which is estimated from few bins near the ends of a short record.
    freedom: Vec<f64>,
}

/// The limit of a ratio to an estimated level of `level_freedom` degrees of freedom, from the `limit` of a ratio to
/// the true level: the quantile of F where `limit` is that of χ². Both are normal in their cube roots (Abramowitz &
/// Stegun 26.4.14, 26.6.15). Infinity if no ratio is unlikely enough.
fn widened(limit: f64, freedom: f64, level_freedom: f64) -> f64 {
    let [own, of_level] = [freedom, level_freedom].map(|freedom| 2.0 / (9.0 * freedom));
    let z2 = libm::pow(libm::cbrt(limit) - (1.0 - own), 2.0) / own;
    let product = (1.0 - own) * (1.0 - of_level);
    let [own, of_level] = [own, of_level].map(|part| (1.0 - part) * (1.0 - part) - z2 * part);
    if of_level <= 0.0 {
        return f64::INFINITY;
    }
    let root = (product + libm::sqrt(product * product - own * of_level)) / of_level;
    root * root * root
}

/// A line whose coefficients were removed from the bins, or a sine that was removed from the samples.
#[derive(Clone, Debug)]
pub(super) struct Narrow {
    pub(super) line: Line,
    /// The first coefficient of the line, and one past its last. No bin has any of them, unless the line is gone.
    pub(super) run: (usize, usize),
    /// Variance and frequency of the line's sines in the model, a quarter of its power each.
    pub(super) sines: [(f64, f64); 4],
    /// Whether the line was a sine that was removed from the samples. Such a line does not leak into other bins.
    pub(super) is_gone: bool,
}

/// Removes narrow lines from the bins of `power` (coefficients 1, 2 …, `hz` apart). A bin with less than a quarter
/// left is removed too, so a coefficient is never both in a bin and in a line. `freedom` gives the degrees of freedom
/// of the mean over some adjacent coefficients.
pub(super) fn take_out_narrow(
    power: &[f64],
    bins: &mut Vec<Bin>,
    hz: f64,
    freedom: impl Fn(usize) -> f64,
) -> Vec<Narrow> {
    let (Some(first), Some(last)) = (bins.first(), bins.last()) else { return Vec::new() };
    let searched = first.first.max(FIRST).min(last.end) - 1..last.end - 1;
    let (mask, base) = broad(bins);
    let base = base_of_coefficients(power, bins, base, &mask, freedom(1));
    let mut flag = narrow(power, &base, searched, freedom(GROUP));
    bins.retain_mut(|bin| without(bin, power, &mut flag));
    stretches(&flag).into_iter().map(|run| narrow_line(run, power, &base.level, hz)).collect()
}

fn narrow_line((from, to): (usize, usize), power: &[f64], base: &[f64], hz: f64) -> Narrow {
    let (power, base) = (&power[from..to], &base[from..to]);
    let excess: f64 = power.iter().zip(base).map(|(p, b)| p - b).sum();
    let weight: f64 = power.iter().sum();
    let middle: f64 = power.iter().zip(from..).map(|(p, i)| p * (i + 1) as f64).sum::<f64>() / weight;
    let variance = (excess * 2.0 * hz).max(0.0);
    let line = Line { frequency_hz: middle * hz, width_hz: (to - from) as f64 * hz, rms: libm::sqrt(variance) };
    // the frequency at which the sum of powers reaches the share `part`
    let at = |part: f64| {
        let mut sum = 0.0;
        let below = |p: &&f64| {
            sum += **p;
            sum < part * weight
        };
        (from + 1 + power.iter().take_while(below).count()) as f64 * hz
    };
    let sines = [0.125, 0.375, 0.625, 0.875].map(|part| (variance / 4.0, at(part)));
    Narrow { line, run: (from + 1, to + 1), sines, is_gone: false }
}

/// Running median of the unmasked bins, over an octave to either side. At the ends the slope is removed first.
fn base_line(bins: &[Bin], mask: &[bool]) -> BaseLine {
    let mut expected = Memo::new(|freedom| chi2_quantile(0.5, freedom) / freedom);
    let y: Vec<f64> = bins.iter().map(|bin| libm::log(bin.density() / expected.of(bin.freedom))).collect();
    let x: Vec<f64> = bins.iter().map(|bin| libm::log2(bin.middle())).collect();
    let (level, freedom) = (0..bins.len()).map(|j| level(&x, &y, (bins, mask), j)).unzip();
    BaseLine { level, freedom }
}

/// The level at bin `j`, and its degrees of freedom.
fn level(x: &[f64], y: &[f64], (bins, mask): (&[Bin], &[bool]), j: usize) -> (f64, f64) {
    let (below, above) = (x.partition_point(|x_i| *x_i < x[j] - 1.0), x.partition_point(|x_i| *x_i < x[j] + 1.0));
    let least = libm::ceil(LEAST_FREEDOM / bins[j].freedom).max(4.0) as usize;
    let reach = (j - below).min(above - 1 - j).max(least);
    let (from, to) = (j.saturating_sub(reach), (j + reach + 1).min(x.len()));
    let part: Vec<usize> = (from..to).filter(|&i| !mask[i]).collect();
    if part.len() < 4 {
        return (libm::exp(y[j]), bins[j].freedom);
    }
    let freedom = OF_MEDIAN * part.iter().map(|&i| bins[i].freedom).sum::<f64>();
    let at_end = j + reach >= x.len() || j < reach;
    let slope = if at_end {
        let half = part.len() / 2;
        let pairs = part[..part.len() - half].iter().zip(&part[part.len() - half..]);
        median(pairs.map(|(&a, &b)| (y[b] - y[a]) / (x[b] - x[a])).collect())
    } else {
        0.0
    };
    let level = median(part.into_iter().map(|i| y[i] - slope * (x[i] - x[j])).collect());
    (libm::exp(level), if at_end { OF_END * freedom } else { freedom })
}

/// The median; 0 without values.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    match values.len() {
        0 => 0.0,
        n if n % 2 == 1 => values[n / 2],
        n => f64::midpoint(values[n / 2 - 1], values[n / 2]),
    }
}

/// The mask of bins that stand out of the base line, and of the bins beside them that are still above it.
fn above(bins: &[Bin], base: &BaseLine) -> Vec<bool> {
    let alarm = ALARM / bins.len() as f64;
    let mut limit = Memo::new(|freedom| MARGIN * chi2_quantile(1.0 - alarm, freedom) / freedom);
    let expected = |bin: &Bin, base: f64| bin.response.offset + bin.response.gain * base;
    let ratio: Vec<f64> = bins.iter().zip(&base.level).map(|(bin, base)| bin.power / expected(bin, *base)).collect();
    let mut is_peak = |((bin, ratio), level): ((&Bin, &f64), &f64)| {
        bin.first >= FIRST && *ratio > widened(limit.of(bin.freedom), bin.freedom, *level)
    };
    let peak: Vec<bool> = bins.iter().zip(&ratio).zip(&base.freedom).map(&mut is_peak).collect();
    let shoulder =
        |i: usize| bins[i].first >= FIRST && ratio[i] > (1.0 + 2.0 * libm::sqrt(2.0 / bins[i].freedom)).min(1.05);
    let mut mask = peak.clone();
    for j in (0..bins.len()).filter(|&j| peak[j]) {
        (j + 1..bins.len()).take_while(|&i| !peak[i] && shoulder(i)).for_each(|i| mask[i] = true);
        (0..j).rev().take_while(|&i| !peak[i] && shoulder(i)).for_each(|i| mask[i] = true);
    }
    mask
}

/// The base line at every coefficient. In bins of a broad line with at least 32 degrees of freedom, it is raised to
/// the level of the line.
fn base_of_coefficients(power: &[f64], bins: &[Bin], base: BaseLine, mask: &[bool], freedom: f64) -> BaseLine {
    let [mut at, of_level] =
        [base.level, base.freedom].map(|of| at_coefficients(bins.iter().map(Bin::middle), &of, power.len()));
    let usual = chi2_quantile(0.5, freedom) / freedom;
    for (bin, _) in bins.iter().zip(mask).filter(|(bin, masked)| **masked && bin.freedom >= 32.0) {
        let inside = bin.first - 1..bin.end - 1;
        let ratios = power[inside.clone()].iter().zip(&at[inside.clone()]).map(|(p, b)| p / b).collect();
        let raise = (median(ratios) / usual).max(1.0);
        at[inside].iter_mut().for_each(|base| *base *= raise);
    }
    BaseLine { level: at, freedom: of_level }
}

/// The mask of coefficients in a narrow line. The mean over a group of them has `freedom` degrees of freedom.
fn narrow(power: &[f64], base: &BaseLine, searched: Range<usize>, freedom: f64) -> Vec<bool> {
    let chance = ALARM * GROUP as f64 / (power.len() + 1) as f64;
    let limit = NARROW_MARGIN * chi2_quantile(1.0 - chance, freedom) / freedom;
    let mut flag = vec![false; power.len()];
    let ratio: Vec<f64> =
        power[searched.clone()].iter().zip(&base.level[searched.clone()]).map(|(p, b)| p / b).collect();
    for (i, group) in (searched.start..).zip(ratio.windows(GROUP)) {
        let mean = group.iter().sum::<f64>() / GROUP as f64;
        if mean > limit && mean > widened(limit, freedom, base.freedom[i]) {
            flag[i.saturating_sub(BEFORE).max(searched.start)..(i + AFTER).min(searched.end)].fill(true);
        }
    }
    flag
}

fn stretches(flag: &[bool]) -> Vec<(usize, usize)> {
    let mut found: Vec<(usize, usize)> = Vec::new();
    for i in (0..flag.len()).filter(|&i| flag[i]) {
        match found.last_mut() {
            Some((_, to)) if *to == i => *to = i + 1,
            _ => found.push((i, i + 1)),
        }
    }
    found
}

/// Removes the flagged coefficients from a bin. If less than a quarter would be left, all coefficients are flagged and
/// the bin is dropped (`false`).
fn without(bin: &mut Bin, power: &[f64], flag: &mut [bool]) -> bool {
    let inside = bin.first - 1..bin.end - 1;
    let lost = || power[inside.clone()].iter().zip(&flag[inside.clone()]).filter(|(_, out)| **out).map(|(p, _)| p);
    let (count, width) = (lost().count() as f64, inside.len() as f64);
    let left = width - count;
    if left < (width / 4.0).max(1.0) {
        flag[inside].fill(true);
        return false;
    }
    if count > 0.0 {
        *bin = Bin {
            power: (bin.power * width - lost().sum::<f64>()) / left,
            freedom: bin.freedom * left / width,
            ..*bin
        };
    }
    true
}

/// A function that remembers its last result.
struct Memo<F> {
    of: F,
    last: (f64, f64),
}

impl<F: Fn(f64) -> f64> Memo<F> {
    fn new(of: F) -> Self {
        Self { of, last: (f64::NAN, f64::NAN) }
    }

    fn of(&mut self, argument: f64) -> f64 {
        if self.last.0 != argument {
            self.last = (argument, (self.of)(argument));
        }
        self.last.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Coefficient `i` is at index `i - 1`, so that indices 9 to 12 are coefficients 10 to 13.
    #[test]
    fn a_narrow_line_has_its_power_at_its_coefficients() {
        let mut power = vec![1.0; 20];
        power[9..13].fill(5.0);
        let narrow = narrow_line((9, 13), &power, &[1.0; 20], 0.5);
        assert_eq!(narrow.run, (10, 14));
        let variance = (4.0 * 4.0) * 2.0 * 0.5;
        assert_eq!(narrow.line, Line { frequency_hz: 11.5 * 0.5, width_hz: 4.0 * 0.5, rms: libm::sqrt(variance) });
        assert_eq!(narrow.sines, [10.0, 11.0, 12.0, 13.0].map(|coefficient| (variance / 4.0, coefficient * 0.5)));
    }
}
