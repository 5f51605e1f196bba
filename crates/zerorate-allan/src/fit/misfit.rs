//! Finds where and why a model does not hold.

use super::MOST_ERROR;
use super::curve::{BLOCKS, Curves};
use super::model::Model;
use super::scoring::{Optimum, Problem};
use super::select::is_upper;
use crate::{Cause, Deviation, Misfit, chi2_quantile};
use alloc::vec::Vec;

/// Number of adjacent bins that are judged together.
const TOGETHER: usize = 8;
/// A band of fewer octaves with a steady excess of power is a resonance.
const NARROW: f64 = 2.0;
/// A narrow band with an excess that reaches this share of the upper end belongs to a filter.
const TO_THE_END: f64 = 0.9;
/// Codes are coarse if more than this share of the samples repeats the sample before.
const REPEATED: f64 = 0.5;
/// The sensor moves if the powers of the eighths of a record have more than this relative deviation beyond chance.
const MOVES: f64 = 0.3;
/// Share of the records whose curve is rejected by chance.
const OFF_BY_CHANCE: f64 = 1e-3;

/// The part of the curve that is off the model by more than [`MOST_ERROR`] and chance.
#[derive(Clone, Copy, Debug)]
pub(super) struct OffCurve {
    /// The averaging time of the largest error, s, and the measured over the modelled deviation there.
    pub(super) tau_s: f64,
    pub(super) ratio: f64,
    pub(super) octaves: usize,
}

impl OffCurve {
    /// Compares the curve with the model. `None` if they agree. The likelihood does not check this: it leaves out
    /// lines, and its model error covers the fast noise only.
    pub(super) fn of(measured: &[Deviation], curves: &Curves<'_>, model: &Model) -> Option<Self> {
        let tail = OFF_BY_CHANCE / measured.len().max(1) as f64 / 2.0;
        let ratio = |found: &Deviation| found.dev / libm::sqrt(model.measured_variance(found.m));
        let size = |found: &Deviation| libm::fabs(libm::log(ratio(found)));
        let is_off = |found: &Deviation| {
            let edf = model.measured_freedom(found.m, found.n, curves.samples() as u64);
            let limit = |p: f64| libm::log(chi2_quantile(p, edf) / edf) / 2.0;
            let log = libm::log(ratio(found));
            size(found) > libm::log1p(MOST_ERROR) && (log < limit(tail) || log > limit(1.0 - tail))
        };
        let off: Vec<&Deviation> = measured.iter().filter(|found| is_off(found)).collect();
        let worst = off.iter().max_by(|a, b| size(a).total_cmp(&size(b)))?;
        Some(Self { tau_s: worst.m as f64 / curves.rate_hz, ratio: ratio(worst), octaves: off.len() })
    }

    /// The largest error of the curve, as a share of the modelled deviation.
    pub(super) fn error(self) -> f64 {
        libm::fabs(self.ratio - 1.0)
    }

    /// The octave that an average of `tau_s` mostly measures, Hz, and the measured over the fitted power.
    fn band(self) -> (f64, f64, f64) {
        (0.25 / self.tau_s, 0.5 / self.tau_s, self.ratio * self.ratio)
    }
}

impl Misfit {
    /// The misfit of a moving sensor: motion changes the power of all frequencies.
    pub(super) fn of_motion(problem: &Problem, spread: f64) -> Self {
        let from_hz = problem.table.rows.first().map_or(0.0, |row| row.f_hz);
        Self { from_hz, to_hz: problem.table.top_hz, ratio: spread * spread, cause: Cause::Motion }
    }

    pub(super) fn of(
        (problem, found): (&Problem, &Optimum),
        off_curve: Option<OffCurve>,
        (curves, model): (&Curves<'_>, &Model),
    ) -> Self {
        let of_bins = || worst_band(problem, found);
        let of_curve = off_curve.filter(|_| problem.error <= MOST_ERROR);
        let (from_hz, to_hz, ratio) = of_curve.map_or_else(of_bins, OffCurve::band);
        let cause = if repeats(curves.rate) {
            Cause::CoarseCodes
        } else if moves(curves, model, curves.rate_hz / (from_hz + to_hz)) {
            Cause::Motion
        } else if ratio > 1.0 && libm::log2(to_hz / from_hz) < NARROW {
            if to_hz > TO_THE_END * problem.table.top_hz { Cause::Filter } else { Cause::Resonance }
        } else {
            Cause::Unknown
        };
        Self { from_hz, to_hz, ratio, cause }
    }
}

/// The band in which the spectrum is farthest from the model, Hz, and the measured over the modelled power there.
fn worst_band(problem: &Problem, found: &Optimum) -> (f64, f64, f64) {
    let rows = problem.table.rows.iter().zip(&found.density).filter(|(row, _)| is_upper(problem, row.f_hz));
    let bins: Vec<(f64, f64, f64)> =
        rows.map(|(row, density)| (row.f_hz, row.bin.power / density - 1.0, row.bin.freedom)).collect();
    let mean = |bins: &[(f64, f64, f64)]| {
        let nu: f64 = bins.iter().map(|(.., nu)| nu).sum();
        (bins.iter().map(|(_, off, nu)| off * nu).sum::<f64>() / nu, nu)
    };
    let weight = |bins: &[(f64, f64, f64)]| {
        let (off, nu) = mean(bins);
        off * off * nu
    };
    let windows: Vec<&[(f64, f64, f64)]> = bins.windows(TOGETHER.min(bins.len()).max(1)).collect();
    let Some(worst) = (0..windows.len()).max_by(|a, b| weight(windows[*a]).total_cmp(&weight(windows[*b]))) else {
        return (0.0, problem.table.top_hz, 1.0);
    };
    let sign = mean(windows[worst]).0;
    let goes_on = |window: &usize| mean(windows[*window]).0 * sign.signum() > MOST_ERROR / 2.0;
    let first = (0..=worst).rev().take_while(goes_on).last().unwrap_or(worst);
    let last = (worst..windows.len()).take_while(goes_on).last().unwrap_or(worst);
    let inside = &bins[first..(last + TOGETHER).min(bins.len())];
    (inside[0].0, inside[inside.len() - 1].0, 1.0 + mean(inside).0)
}

fn repeats(rate: &[f64]) -> bool {
    let pairs = rate.windows(2).filter(|pair| !pair[0].is_nan() && !pair[1].is_nan());
    let (same, all) =
        pairs.fold((0.0, 0.0), |(same, all), pair| (if pair[0] == pair[1] { same + 1.0 } else { same }, all + 1.0));
    same > REPEATED * all
}

/// Whether the Allan variance of averages of about `m` samples differs between the eighths of the record.
fn moves(curves: &Curves<'_>, model: &Model, m: f64) -> bool {
    let nearest = |a: &&u64, b: &&u64| {
        let off = |m_i: &u64| libm::fabs(libm::log(*m_i as f64 / m));
        off(a).total_cmp(&off(b))
    };
    let Some(&m) = curves.lengths.iter().min_by(nearest) else { return false };
    let logs: Vec<f64> =
        curves.blocks.iter().flatten().filter(|found| found.m == m).map(|found| 2.0 * libm::log(found.dev)).collect();
    let mean = logs.iter().sum::<f64>() / logs.len().max(1) as f64;
    let variance = logs.iter().map(|log| (log - mean) * (log - mean)).sum::<f64>() / (logs.len().max(2) - 1) as f64;
    let chance = 2.0 / model.freedom(m, (curves.samples() / BLOCKS) as u64);
    variance > MOVES * MOVES + 2.0 * chance
}
