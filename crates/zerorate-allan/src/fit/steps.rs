//! Finds steps, at which the level of the rate jumps and stays.

use super::bins::at_coefficients;
use super::density::Table;
use super::masked::loud;
use super::scoring::{N2, Problem};
use super::select::{Selection, without_shape};
use super::spectrum::Spectrum;
use super::spectrum::averages::{averages, centred, fill_gaps, slot_length, white_in};
use super::transform::{cosine_transform, series, smooth_length};
use alloc::vec::Vec;
use core::f64::consts::PI;
use realfft::FftError;

/// A jump of the level.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Step {
    /// The time, s from the start of the record. It is known to some tenths of a second at best.
    pub at_s: f64,
    /// The size, in the unit of the rate.
    pub size: f64,
}

/// The most significant step that the model's noise does not explain.
#[derive(Clone, Copy, Debug)]
pub(super) struct Candidate {
    /// Index of the first sample after the step.
    pub(super) index: usize,
    pub(super) size: f64,
    /// Size of the step divided by the standard deviation of its estimate.
    pub(super) score: f64,
}

/// Number of values at each end in which no step is searched.
const MARGIN: usize = 10;

/// Averages are lengthened until at most this share of them is missing, but not to fewer than `FEWEST_SLOTS` averages.
const MOST_MISSING: f64 = 0.02;
const FEWEST_SLOTS: usize = 64;

/// The step with the largest score under the noise of the model, with flicker and random walk. The size at every time
/// is a generalised least squares estimate, by one transform of the coefficients c_k and their densities S_k. With
/// d_k = 2 sin(πk/2n), a unit step at t has the coefficients −√(2/n) sin(πkt/n)/d_k. [`loud`] lines are left out.
pub(super) fn largest(
    rate: &[f64],
    rate_hz: f64,
    (spectrum, chosen): &(Spectrum, Selection),
) -> Result<Option<Candidate>, FftError> {
    let left_out = loud(spectrum, chosen, rate_hz);
    let rate = &*spectrum.without_sines(rate, rate_hz);
    let level =
        |i: usize| chosen.found.form.drift.map_or(0.0, |drift| chosen.found.drift * drift.at(i as f64 / rate_hz));
    if spectrum.has_levels {
        let (slot, mut means, counts) = slots_without_gaps(rate);
        let slots = means.len();
        means.iter_mut().enumerate().for_each(|(i, mean)| *mean -= level(i * slot + slot / 2));
        fill_gaps(&mut means);
        let density = density_of_averages(chosen, slots, rate_hz / slot as f64, white_in(&counts, slot));
        let found = scan(&means, &density, &left_out)?;
        return Ok(found.map(|step| Candidate { index: moment(rate, step.index * slot, slot), ..step }));
    }
    let n = smooth_length(rate.len());
    let rate: Vec<f64> = rate[..n].iter().enumerate().map(|(i, value)| value - level(i)).collect();
    let table = &chosen.problem.table;
    let fitted = table.rows.iter().map(|row| row.f_hz).zip(chosen.found.density.iter().copied());
    let hz = rate_hz / (2 * n) as f64;
    // a filter weakens a step as much as the noise, so a density below N² counts as N²
    let whole = fitted.chain(spectrum.above(table.top_hz, rate_hz));
    let known: Vec<(f64, f64)> = whole.map(|(f_hz, density)| (f_hz, density.max(chosen.found.at[N2]))).collect();
    let densities: Vec<f64> = known.iter().map(|(_, density)| *density).collect();
    let density = at_coefficients(known.iter().map(|(f_hz, _)| f_hz / hz), &densities, n - 1);
    scan(&rate, &density.iter().map(|density| density * rate_hz).collect::<Vec<f64>>(), &left_out)
}

/// Averages so long that few are missing (lines across long gaps look like steps), with their length and counts.
fn slots_without_gaps(rate: &[f64]) -> (usize, Vec<f64>, Vec<usize>) {
    let mut slot = slot_length(rate.len());
    loop {
        let slots = smooth_length(rate.len() / slot);
        let (means, counts) = averages(&rate[..slots * slot], slot);
        let missing = counts.iter().filter(|count| **count == 0).count();
        if missing as f64 <= MOST_MISSING * slots as f64 || slots < 2 * FEWEST_SLOTS {
            return (slot, means, counts);
        }
        slot *= 2;
    }
}

/// The sample at which a step near `near` begins: there the running sum about the mean is farthest from 0.
fn moment(rate: &[f64], near: usize, slot: usize) -> usize {
    let from = near.saturating_sub(slot);
    let around = &rate[from..(near + slot).min(rate.len())];
    let there = || around.iter().zip(from..).filter(|(value, _)| !value.is_nan());
    let mean = there().map(|(value, _)| value).sum::<f64>() / there().count().max(1) as f64;
    let mut sum = 0.0;
    let sums = there().map(|(value, i)| {
        sum += value - mean;
        (libm::fabs(sum), i + 1)
    });
    sums.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(near, |(_, i)| i)
}

fn density_of_averages(chosen: &Selection, slots: usize, slot_rate_hz: f64, white: f64) -> Vec<f64> {
    let table = Table::new(super::bins::all_edges(slots).into_iter(), &[], slots, slot_rate_hz);
    let middles: Vec<f64> = table.rows.iter().map(|row| row.bin.middle()).collect();
    let mut form = chosen.found.form;
    let mut at = without_shape(&chosen.found);
    at[N2] *= white;
    (form.cosines, form.poles, form.drift) = (0, 0, None);
    let density = Problem::new(table, 0.0).density(&form, &at);
    at_coefficients(middles.into_iter(), &density, slots - 1).into_iter().map(|s| s * slot_rate_hz).collect()
}

fn scan(x: &[f64], density: &[f64], left_out: &[(usize, usize)]) -> Result<Option<Candidate>, FftError> {
    let n = x.len();
    let coefficients = cosine_transform(&centred(x))?;
    let half_angle = PI / (2 * n) as f64;
    // Both sums come from one transform. Without this scale, one of them would lose its digits beside the other if the
    // unit of the rate is large.
    let unit = libm::sqrt(density.iter().sum::<f64>() / n as f64);
    let weigh = |(k, (c, s)): (usize, (&f64, &f64))| {
        let d = 2.0 * libm::sin(half_angle * (k + 1) as f64);
        let s = s / (unit * unit);
        (1.0 / (s * d * d), c / unit / (s * d))
    };
    let mut pairs: Vec<(f64, f64)> = coefficients.iter().zip(density).enumerate().map(weigh).collect();
    for &(first, end) in left_out {
        let end = end.min(n);
        pairs[first.min(end) - 1..end - 1].fill((0.0, 0.0));
    }
    let total: f64 = pairs.iter().map(|(w, _)| w).sum();
    let sums = series(&pairs)?;
    let even = |t: usize| (sums[t] + sums[2 * n - t]) / 2.0;
    let at = |t: usize| {
        let over = -libm::sqrt(2.0 / n as f64) * (sums[t] - sums[2 * n - t]) / 2.0;
        let under = (total - even((2 * t).min(2 * n - 2 * t))) / n as f64;
        (over, under)
    };
    let score = |t: usize| {
        let (over, under) = at(t);
        over / libm::sqrt(under)
    };
    let inside = MARGIN.min(n)..n.saturating_sub(MARGIN);
    let best = inside.max_by(|&a, &b| libm::fabs(score(a)).total_cmp(&libm::fabs(score(b))));
    Ok(best.map(|index| {
        let (over, under) = at(index);
        Candidate { index, size: over / under * unit, score: over / libm::sqrt(under) }
    }))
}
