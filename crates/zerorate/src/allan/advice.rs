//! What an Allan deviation curve says in words: warnings, how long to average, and the units that people use.

use super::fit::{Fit, Noise};
use core::fmt;

/// Averaging times of AN-1042, s: steps 4 and 8 of F-51.
pub const AN1042_TAUS_S: [f64; 2] = [10.0, 150.0];

/// The coefficients stand, but there is something to know. `Display` says what was seen, why it matters and what to
/// do; a number without a unit is in the unit of the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum AllanWarning {
    /// The shortest averages carry quantisation, not white noise.
    QuantisationLimited { q: f64, below_s: f64 },
    /// One averaging time lies far above the model.
    Periodic { tau_s: f64, ratio: f64, frequency_hz: f64 },
    /// The curve does not follow the model.
    Misfit { chi2: f64, freedom: usize },
    /// The rate drifts evenly.
    Drift { r: f64, over_record: f64 },
    /// The shortest averages lie below the line of white noise.
    ShortEndExcluded { points: usize, from_s: f64, used_from_s: f64 },
    /// The record is too short to tell a coefficient from zero.
    NotIdentified { noise: Noise, record_s: f64, needed_s: f64 },
}

impl AllanWarning {
    /// Short stable name, for scripts.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::QuantisationLimited { .. } => "quantisation-limited",
            Self::Periodic { .. } => "periodic-disturbance",
            Self::Misfit { .. } => "misfit",
            Self::Drift { .. } => "drift",
            Self::ShortEndExcluded { .. } => "short-end-excluded",
            Self::NotIdentified { .. } => "not-identified",
        }
    }
}

impl Noise {
    /// Name and letter.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Quantisation => "angle quantisation Q",
            Self::AngleRandomWalk => "angle random walk N",
            Self::BiasInstability => "bias instability B",
            Self::RateRandomWalk => "rate random walk K",
            Self::RateRamp => "rate ramp R",
        }
    }
}

impl fmt::Display for AllanWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::QuantisationLimited { q, below_s } => write!(
                f,
                "below {below_s:.3} s the curve falls as 1/τ: quantisation of the angle (Q = {q:.3e}) hides the white \
                 noise there; read with a finer step, or judge N at longer averages"
            ),
            Self::Periodic { tau_s, ratio, frequency_hz } => write!(
                f,
                "at {tau_s:.3} s the deviation is {ratio:.2} times what noise explains: a periodic disturbance near \
                 {frequency_hz:.3} Hz (or one that folds to it) lifts the curve, and N, B and K with it; find its \
                 source, or record without it"
            ),
            Self::Misfit { chi2, freedom } => write!(
                f,
                "the curve does not follow the noise model (χ² = {chi2:.0} for {freedom} degrees of freedom): the \
                 intervals are too narrow; look at the plot for steps, motion or a disturbance"
            ),
            Self::Drift { r, over_record } => write!(
                f,
                "the rate drifts evenly by {r:.3e} per second, {over_record:.3e} over the record: that is temperature \
                 or warm-up rather than noise, and it hides K; let the part settle, or take the temperature out first"
            ),
            Self::ShortEndExcluded { points, from_s, used_from_s } => write!(
                f,
                "from {from_s:.4} s the deviation lies below the line of white noise, as behind a low-pass filter: \
                 {points} averaging times were left out and N was read from {used_from_s:.4} s on; nothing to do \
                 unless the filter was not meant"
            ),
            Self::NotIdentified { noise, record_s, needed_s } => write!(
                f,
                "{} cannot be told from zero in {record_s:.0} s: its value is a guess within its interval; record \
                 about {needed_s:.0} s ({:.1} h)",
                noise.name(),
                needed_s / 3600.0
            ),
        }
    }
}

/// How long to average for the bias.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Averaging {
    /// The curve has its minimum here: longer averages get worse.
    Minimum {
        /// Averaging time, s.
        tau_s: f64,
        /// Fitted deviation there, in the unit of the rate.
        dev: f64,
    },
    /// From here on, longer averages gain less than 5 %; where the curve rises again, this record does not show.
    Flat {
        /// Averaging time, s.
        tau_s: f64,
        /// Fitted deviation there, in the unit of the rate.
        dev: f64,
    },
    /// The curve still falls at its longest averaging time.
    Falling {
        /// Longest averaging time, s.
        tau_s: f64,
        /// Fitted deviation there, in the unit of the rate.
        dev: f64,
    },
}

/// What the curve advises.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Advice {
    /// How long to average for the bias.
    pub averaging: Averaging,
    /// Fitted deviation at [`AN1042_TAUS_S`], in the unit of the rate (F-51, F-53); none where the fit does not reach
    /// so far.
    pub an1042: [Option<f64>; 2],
}

/// Shortfall from the floor at which averaging is said to be done.
const FLAT_WITHIN: f64 = 1.05;
/// Steps per octave of the search for the minimum.
const STEPS_PER_OCTAVE: f64 = 64.0;

/// Reads a fit as advice (F-53: how long to average is read off the Allan deviation).
#[must_use]
pub fn advice(fit: &Fit) -> Advice {
    let within = |tau_s: f64| tau_s >= fit.span_s.0 && tau_s <= fit.span_s.1;
    let an1042 = AN1042_TAUS_S.map(|tau_s| within(tau_s).then(|| deviation(fit, tau_s)));
    Advice { averaging: averaging(fit), an1042 }
}

fn averaging(fit: &Fit) -> Averaging {
    let last = fit.span_s.1;
    let flat_s = FLAT_WITHIN * FLAT_WITHIN - 1.0;
    let ratio = fit.n.value / (crate::noise::FLOOR_PER_B * fit.b.value).max(f64::MIN_POSITIVE);
    let knee_s = (ratio * ratio / flat_s).max(fit.span_s.0);
    let least_s = least(fit);
    if (fit.k.identified || fit.r.is_some()) && least_s < last {
        Averaging::Minimum { tau_s: least_s, dev: deviation(fit, least_s) }
    } else if fit.b.identified && knee_s < last {
        Averaging::Flat { tau_s: knee_s, dev: deviation(fit, knee_s) }
    } else {
        Averaging::Falling { tau_s: last, dev: deviation(fit, last) }
    }
}

fn least(fit: &Fit) -> f64 {
    let steps = (libm::log2(fit.span_s.1 / fit.span_s.0) * STEPS_PER_OCTAVE) as u32;
    let taus = (0..=steps).map(|step| fit.span_s.0 * libm::exp2(f64::from(step) / STEPS_PER_OCTAVE));
    taus.min_by(|&a, &b| fit.allan_variance(a).total_cmp(&fit.allan_variance(b))).unwrap_or(fit.span_s.1)
}

fn deviation(fit: &Fit, tau_s: f64) -> f64 {
    libm::sqrt(fit.allan_variance(tau_s))
}
