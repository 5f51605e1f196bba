//! The warnings about a curve or a noise model.

use crate::text::{hertz, span};
use crate::{Cause, rows};
use alloc::format;
use alloc::string::{String, ToString};
use core::fmt;

/// The longest practical record, s: a thousand hours.
pub const LONGEST_RECORD_S: f64 = 3.6e6;

/// A warning about a curve or a noise model. `Display` states in one line what was seen and what to do, with `unit`
/// for the unit of the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum AllanWarning {
    /// The shortest averages carry quantisation, not white noise.
    QuantisationLimited { q: f64, below_s: f64 },
    /// The rate drifts evenly.
    Drift { r: f64, over_record: f64 },
    /// Samples that noise does not explain were replaced by straight lines.
    Glitches { glitches: u64, samples: u64, ratio: f64 },
    /// So many samples stand out of their neighbours that none was replaced.
    ManyGlitches { most: f64 },
    /// A step of the level was removed.
    Step { at_s: f64, size: f64 },
    /// The level steps too often for the steps to be removed.
    ManySteps { most: usize },
    /// Samples are missing.
    Gaps { missing: u64, samples: u64 },
    /// The spectrum has lines, which were left out.
    Lines { count: usize, frequency_hz: f64, rms: f64 },
    /// The level approaches its final value exponentially.
    WarmUp { size: f64, tau_s: f64 },
    /// Another number of Gauss–Markov terms fits about as well.
    MemoryOrFlicker { markovs: usize, others: usize, worse: f64 },
    /// A Gauss–Markov term and low-pass filtered white noise explain the record equally well. `n` is N in the
    /// other explanation, unit·√s.
    MemoryOrFilter { tau_s: f64, n: f64 },
    /// A drift and a random walk fit about as well.
    DriftOrWalk { has_drift: bool, worse: f64 },
    /// A period explains the slow noise better than a random walk. `k` is K without the period, unit/√s.
    PeriodOrWalk { period_s: f64, k: f64 },
    /// One half of the record is noisier: `ratio` is the deviation of the first half divided by that of the second.
    Unsteady { tau_s: f64, ratio: f64 },
    /// The samples are too few to show how the sensor's filter shapes the noise.
    ShortRecord { samples: u64, needed: u64 },
    /// A line is so strong that its leakage may be taken for noise: up to `share` of the fitted noise.
    Leakage { frequency_hz: f64, share: f64 },
    /// The measured deviations differ from the model by more than 10 %, beyond chance, at `octaves` averaging times.
    OffCurve { tau_s: f64, ratio: f64, octaves: usize },
    /// The model is rejected. `error` is its relative error, and `most` the largest error that is accepted.
    Rejected { error: f64, most: f64, misfit: crate::Misfit },
    /// The slow rate follows the temperature: `explained` is the share of its variance, `slope` its change per °C.
    FollowsTemperature { explained: f64, slope: f64, span_c: f64 },
    /// The record is too short to tell a coefficient from zero.
    NotIdentified { noise: Noise, record_s: f64, needed_s: f64 },
}

rows!(match AllanWarning {
    Self::QuantisationLimited { q, below_s } => Row {
        code: "quantisation-limited",
        text: format_args!("quantisation is as large as the white noise at {below_s:.1e} s; read with a finer step"),
    },
    Self::Drift { r, over_record } => Row {
        code: "drift",
        text: format_args!(
            "the rate drifts by {over_record:.3e} {{unit}} over the record and hides K; let the sensor settle"
        ),
    },
    Self::Glitches { glitches, samples, ratio } => Row {
        code: "glitches",
        text: format_args!(
            "{glitches} glitch{} ({samples} sample{}) replaced by straight lines; look for knocks or bit errors",
            if glitches == 1 { "" } else { "es" },
            plural(samples)
        ),
    },
    Self::ManyGlitches { most } => Row {
        code: "many-glitches",
        text: format_args!(
            "over {:.0} % of the samples stand out, so none was replaced; motion, or bit errors?",
            most * 100.0
        ),
    },
    Self::Step { at_s, size } => Row {
        code: "step",
        text: format_args!(
            "at {at_s:.1} s the level jumps by {size:.3e} {{unit}} (taken out); a knock or a switched supply?"
        ),
    },
    Self::ManySteps { most } => Row {
        code: "many-steps",
        text: format_args!("the level jumps more than {most} times (not taken out); record where nothing moves"),
    },
    Self::Gaps { missing, samples } => Row {
        code: "gaps",
        text: format_args!("{missing} of {samples} samples are missing; check that losses do not depend on the rate"),
    },
    Self::Lines { count, frequency_hz, rms } => Row {
        code: "lines",
        text: format_args!(
            "{count} spectral line{}, the strongest at {} ({rms:.3e} {{unit}} rms); find the source",
            plural(count as u64),
            hertz(frequency_hz)
        ),
    },
    Self::WarmUp { size, tau_s } => Row {
        code: "warm-up",
        text: format_args!(
            "the level {} by {:.3e} {{unit}} (time constant {}), which blurs B and K; let it settle",
            if size < 0.0 { "rises" } else { "falls" },
            size.abs(),
            span(tau_s)
        ),
    },
    Self::MemoryOrFlicker { markovs, others, worse } => Row {
        code: "memory-or-flicker",
        text: format_args!(
            "{others} Gauss–Markov terms fit as well as {markovs}; trust neither beyond 1/4 of the record"
        ),
    },
    Self::MemoryOrFilter { tau_s, n } => Row {
        code: "memory-or-filter",
        text: format_args!("a memory of {tau_s:.3} s looks like a low-pass; then N is {n:.3e} {{unit}}·√s"),
    },
    Self::DriftOrWalk { has_drift, worse } => Row {
        code: "drift-or-walk",
        text: format_args!(
            "{} was taken, but {} fits about as well; record again",
            if has_drift { "a drift" } else { "a random walk" },
            if has_drift { "a random walk" } else { "a drift" }
        ),
    },
    Self::PeriodOrWalk { period_s, k } => Row {
        code: "drift-or-walk",
        text: format_args!(
            "a period of {period_s:.0} s fits better than K ({k:.3e} {{unit}}/√s beside it); find the source"
        ),
    },
    Self::Unsteady { tau_s, ratio } => Row {
        code: "unsteady",
        text: format_args!(
            "the {} half is {:.2} times as noisy as the {} at {tau_s:.3} s; let the sensor settle",
            if ratio > 1.0 { "first" } else { "second" },
            ratio.max(1.0 / ratio),
            if ratio > 1.0 { "second" } else { "first" }
        ),
    },
    Self::ShortRecord { samples, needed } => Row {
        code: "short-record",
        text: format_args!("{samples} samples are too few, N may be off by a quarter; record {needed} or more"),
    },
    Self::Leakage { frequency_hz, share } => Row {
        code: "leakage",
        text: format_args!(
            "up to {:.0} % of the fitted noise may be the line at {}; record without it",
            share * 100.0,
            hertz(frequency_hz)
        ),
    },
    Self::OffCurve { tau_s, ratio, octaves } => Row {
        code: "off-curve",
        text: format_args!(
            "at {tau_s:.3} s the curve is {ratio:.2} times the model ({octaves} octave{} off); do not use it there",
            plural(octaves as u64)
        ),
    },
    Self::Rejected { error, most, misfit } =>
        Row { code: "model-rejected", text: format_args!("{}{misfit}", off(error, most, misfit.cause)) },
    Self::FollowsTemperature { explained, slope, span_c } => Row {
        code: "follows-temperature",
        text: format_args!("{:.0} % of slow variance is temperature; take it out", explained * 100.0),
    },
    Self::NotIdentified { noise, record_s, needed_s } => Row {
        code: "not-identified",
        text: format_args!("{} cannot be told from zero{}", noise.name(), longer(needed_s)),
    },
});

impl AllanWarning {
    /// The text with this unit of the rate.
    #[must_use]
    pub fn in_unit(&self, unit: &str) -> String {
        WithoutUnit(self).to_string().replace("{unit}", unit)
    }
}

/// The text with `{unit}` in place of the unit of the rate.
struct WithoutUnit<'a>(&'a AllanWarning);

impl fmt::Display for WithoutUnit<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.text(f)
    }
}

impl fmt::Display for AllanWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.in_unit("unit"))
    }
}

/// A noise that one coefficient of the model describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Noise {
    /// Angle quantisation Q.
    Quantisation,
    /// Angle random walk N: white noise of the rate.
    AngleRandomWalk,
    /// Bias instability B: flicker noise of the rate.
    BiasInstability,
    /// Rate random walk K.
    RateRandomWalk,
    /// Rate ramp R.
    RateRamp,
}

impl Noise {
    /// The name and the symbol.
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

/// The relative error of a model, as the beginning of a sentence, unless the model was rejected for another reason.
fn off(error: f64, most: f64, cause: Cause) -> String {
    let is_off = cause != Cause::Motion && error >= most / (1.0 + most);
    if is_off { format!("off by {:.0} %: ", error * 100.0) } else { String::new() }
}

/// The record length that would identify a coefficient, as the end of a sentence.
fn longer(needed_s: f64) -> String {
    match needed_s <= LONGEST_RECORD_S {
        true => format!("; a value of this order takes about {}", span(needed_s)),
        false => String::from(" in any practical record; do without it"),
    }
}

const fn plural(count: u64) -> &'static str {
    if count == 1 { "" } else { "s" }
}
