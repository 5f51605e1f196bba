//! Advice on averaging from a noise model.

use super::{AllanWarning, Fit, Term};

/// The averaging times that AN-1042 prescribes, s (F-51): 10 s in step 4, 150 s in step 8.
pub const AN1042_TAUS_S: [f64; 2] = [10.0, 150.0];

/// The advised averaging time for the bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Averaging {
    /// The curve has its minimum at `tau_s`. Longer averages are worse.
    Minimum {
        /// Averaging time, s.
        tau_s: f64,
        /// Fitted deviation at `tau_s`, in the unit of the rate.
        dev: f64,
    },
    /// Longer averages gain less than 5 %. The record does not identify where the curve rises again.
    Flat {
        /// Averaging time, s.
        tau_s: f64,
        /// Fitted deviation at `tau_s`, in the unit of the rate.
        dev: f64,
    },
    /// The curve falls to its longest averaging time, and the record does not identify a floor.
    Falling {
        /// Longest averaging time, s.
        tau_s: f64,
        /// Fitted deviation at `tau_s`, in the unit of the rate.
        dev: f64,
    },
}

/// The advice from a fitted Allan deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advice {
    /// The advised averaging time for the bias.
    pub averaging: Averaging,
    /// Fitted deviation at [`AN1042_TAUS_S`], unit of the rate (F-51, F-53); `None` outside the span of the fit.
    pub an1042: [Option<f64>; 2],
}

/// An average is long enough if its deviation is within this factor of the least deviation.
const FLAT_WITHIN: f64 = 1.05;
/// An average counts as filtered if its deviation is below this share of the white noise N/√τ.
const FILTERED_BELOW: f64 = 0.9;
const STEPS_PER_OCTAVE: f64 = 32.0;

/// Derives advice from a fit (F-53: the Allan deviation shows how long to average). `None` if the model is rejected or
/// if the rate follows the temperature.
#[must_use]
pub fn advice(fit: &Fit) -> Option<Advice> {
    let within = |tau_s: f64| tau_s >= fit.span_s.0 && tau_s <= fit.span_s.1;
    let an1042 = AN1042_TAUS_S.map(|tau_s| within(tau_s).then(|| deviation(fit, tau_s)));
    // no advice in that case: the drift of a warming sensor raises the curve, so short averages would seem best
    let follows = |warning: &AllanWarning| matches!(warning, AllanWarning::FollowsTemperature { .. });
    let is_of_noise = !fit.is_rejected && !fit.warnings.iter().any(follows);
    is_of_noise.then(|| Advice { averaging: averaging(fit), an1042 })
}

fn averaging(fit: &Fit) -> Averaging {
    let (least_s, last) = (least(fit), fit.span_s.1);
    let last_dev = deviation(fit, last);
    let least_dev = deviation(fit, least_s).min(last_dev);
    let has_minimum = least_dev < last_dev;
    let moves = |term: &Term| matches!(term, Term::GaussMarkov { .. } | Term::WarmUp { .. });
    let rises = fit.k.identified || fit.r.is_some() || fit.terms.iter().any(moves);
    let done_s = taus(fit).find(|tau_s| deviation(fit, *tau_s) <= FLAT_WITHIN * least_dev).unwrap_or(last);
    if rises && has_minimum {
        Averaging::Minimum { tau_s: least_s, dev: least_dev }
    } else if (has_minimum || fit.b.identified) && done_s < last {
        Averaging::Flat { tau_s: done_s, dev: deviation(fit, done_s) }
    } else {
        Averaging::Falling { tau_s: last, dev: last_dev }
    }
}

fn least(fit: &Fit) -> f64 {
    taus(fit).min_by(|&a, &b| deviation(fit, a).total_cmp(&deviation(fit, b))).unwrap_or(fit.span_s.1)
}

/// The averaging times to choose from, ascending, up to the longest. A low-pass filter or correlated noise makes the
/// curve rise and then fall again, so that short averages have a small deviation although they are far from the bias.
/// The choice therefore starts after that rise. A warm-up also makes the curve rise and fall, but averages up to its
/// end are not better, so its rise is not skipped.
fn taus(fit: &Fit) -> impl Iterator<Item = f64> {
    let (first, last) = fit.span_s;
    let octaves = libm::log2(last / first);
    let steps = (octaves * STEPS_PER_OCTAVE) as u32;
    let tau_s = move |step: u32| first * libm::exp2(f64::from(step) / STEPS_PER_OCTAVE);
    let is_filtered = |step: u32| {
        let tau_s = tau_s(step);
        deviation(fit, tau_s) < FILTERED_BELOW * fit.n.value / libm::sqrt(tau_s)
    };
    let change = |step: u32| deviation(fit, 2.0 * tau_s(step)) / deviation(fit, tau_s(step));
    let before_the_last = ((octaves - 1.0).max(0.0) * STEPS_PER_OCTAVE) as u32;
    let last_fall = (0..before_the_last).rev().find(|step| change(*step) * FLAT_WITHIN < 1.0).unwrap_or(0);
    let warms_up = fit.terms.iter().any(|term| matches!(term, Term::WarmUp { .. }));
    let last_rise = (0..last_fall).rev().find(|step| !warms_up && change(*step) > FLAT_WITHIN);
    let from = last_rise.map_or(0, |step| step + 1);
    ((from..steps).find(|step| !is_filtered(*step)).unwrap_or(from)..=steps).map(tau_s)
}

/// `fit.span_s.0` is the sample interval, s.
fn deviation(fit: &Fit, tau_s: f64) -> f64 {
    fit.deviation(libm::round(tau_s / fit.span_s.0).max(1.0) as u64)
}
