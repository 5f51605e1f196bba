//! The warnings about a record and its model.

use super::lines::Line;
use super::select::Selection;
use super::{Fit, MOST_ERROR, Term, steadiness};
use crate::{AllanWarning, Deviation, Input, Noise, Stat, chi2_quantile, deviations, octaves};
use alloc::vec::Vec;

/// The raw record, for the warnings.
#[derive(Clone, Copy)]
pub(super) struct Raw {
    pub(super) record_s: f64,
    pub(super) missing: usize,
}

/// Two choices of terms that differ by less in price cannot be told apart.
const CLOSE: f64 = 6.0;

/// Halves that differ by less than this share are alike for any use.
const CHANGE: f64 = 0.05;

/// From this number of samples on the band of a sensor is found: in all of 100 simulated records of the bands of the
/// ADIS16405's axes. 1000 samples show it in 93 to 100 records, 300 in 41 to 85.
const BAND_IS_SEEN: u64 = 2000;

pub(super) fn remarks(fit: &Fit, chosen: &Selection, rate: &[f64], rate_hz: f64, raw: Raw) -> Vec<AllanWarning> {
    let mut warnings = Vec::new();
    if fit.is_rejected {
        warnings.push(AllanWarning::Rejected { error: fit.model_error, most: MOST_ERROR });
    }
    let samples = (rate.len() - raw.missing.min(rate.len())) as u64;
    if samples > 0 && samples < BAND_IS_SEEN {
        warnings.push(AllanWarning::ShortRecord { samples, needed: BAND_IS_SEEN });
    }
    let off = off_curve(rate, rate_hz, fit).filter(|_| !fit.is_rejected);
    warnings.extend(off);
    if raw.missing > 0 {
        warnings.push(AllanWarning::Gaps { missing: raw.missing as u64, samples: rate.len() as u64 });
    }
    let lines = fit.terms.iter().filter_map(|term| if let Term::Line(line) = term { Some(line) } else { None });
    if let Some(strongest) = lines.clone().max_by(|a, b| a.rms.total_cmp(&b.rms)) {
        let Line { frequency_hz, rms, .. } = *strongest;
        warnings.push(AllanWarning::Lines { count: lines.count(), frequency_hz, rms });
    }
    if let Some(q) = fit.q {
        let below_s = 3.0 * q.value * q.value / (fit.n.value * fit.n.value).max(f64::MIN_POSITIVE);
        warnings.push(AllanWarning::QuantisationLimited { q: q.value, below_s: below_s.min(fit.span_s.1) });
    }
    if let Some(r) = fit.r {
        warnings.push(AllanWarning::Drift { r: r.value, over_record: r.value * raw.record_s });
    }
    warnings.extend(fit.terms.iter().filter_map(|term| match term {
        Term::WarmUp { size, tau_s } => Some(AllanWarning::WarmUp { size: size.value, tau_s: *tau_s }),
        _ => None,
    }));
    if let Some((form, worse)) = chosen.runner_up.filter(|(_, worse)| *worse < CLOSE) {
        let own = &chosen.found.form;
        let memory = form.markovs != own.markovs;
        warnings.push(if memory {
            AllanWarning::MemoryOrFlicker { markovs: own.markovs, others: form.markovs, worse }
        } else {
            AllanWarning::DriftOrWalk { has_drift: own.drift.is_some(), worse }
        });
    }
    warnings.extend(unsteady(fit, rate, rate_hz));
    let coefficients =
        [(Noise::AngleRandomWalk, fit.n), (Noise::BiasInstability, fit.b), (Noise::RateRandomWalk, fit.k)];
    let missing = coefficients.into_iter().filter_map(|(noise, c)| Some((noise, c.needed_s?)));
    warnings.extend(missing.map(|(noise, needed_s)| AllanWarning::NotIdentified {
        noise,
        record_s: raw.record_s,
        needed_s,
    }));
    warnings
}

/// Halves of the record that differ.
fn unsteady(fit: &Fit, rate: &[f64], rate_hz: f64) -> Option<AllanWarning> {
    let steadiness::Difference { tau_s, ratio } = steadiness::halves(rate, rate_hz, &fit.model)?;
    (libm::log(ratio).abs() > CHANGE).then_some(AllanWarning::Unsteady { tau_s, ratio })
}

/// Share of the records whose curve is reported as off though chance explains it.
const OFF_BY_CHANCE: f64 = 1e-3;

/// Where the measured curve is off the model's by more than [`MOST_ERROR`] and chance. The likelihood does not check
/// this: it leaves out lines, and the model error covers the fast noise only.
fn off_curve(rate: &[f64], rate_hz: f64, fit: &Fit) -> Option<AllanWarning> {
    let lengths = octaves(rate.len());
    let tail = OFF_BY_CHANCE / lengths.len().max(1) as f64 / 2.0;
    let ratio = |found: &Deviation| libm::fabs(libm::log(found.dev / fit.deviation(found.m)));
    let is_off = |found: &Deviation| {
        let edf = fit.model.freedom(found.m, rate.len() as u64);
        let limit = |p: f64| libm::log(chi2_quantile(p, edf) / edf) / 2.0;
        let log = libm::log(found.dev / fit.deviation(found.m));
        ratio(found) > libm::log1p(MOST_ERROR) && (log < limit(tail) || log > limit(1.0 - tail))
    };
    let measured = deviations(&Input::Rate(rate), rate_hz, Stat::Oadev, &lengths);
    let off: Vec<Deviation> =
        measured.into_iter().flatten().filter(|found| found.dev > 0.0 && is_off(found)).collect();
    let worst = off.iter().max_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
    let tau_s = worst.m as f64 / rate_hz;
    Some(AllanWarning::OffCurve { tau_s, ratio: worst.dev / fit.deviation(worst.m), octaves: off.len() })
}
