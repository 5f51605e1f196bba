//! The warnings about a curve or a noise model.

use crate::{Says, rows};
use alloc::format;
use alloc::string::String;
use core::fmt;

/// The longest record that anybody makes, s: a thousand hours.
pub const LONGEST_RECORD_S: f64 = 3.6e6;

/// A warning: the coefficients stand, but there is something to know. `Display` says in one line what was seen and
/// what to do. A number without a unit is in the unit of the rate.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum AllanWarning {
    /// The shortest averages carry quantisation, not white noise.
    QuantisationLimited { q: f64, below_s: f64 },
    /// One averaging time lies far above the model.
    Periodic { tau_s: f64, ratio: f64, frequency_hz: f64 },
    /// The curve does not follow the noise model of a curve.
    Misfit { chi2: f64, freedom: usize },
    /// The rate drifts evenly.
    Drift { r: f64, over_record: f64 },
    /// The shortest averages lie below the line of white noise.
    ShortEndExcluded { points: usize, from_s: f64, used_from_s: f64 },
    /// Samples were replaced.
    Glitches { glitches: u64, samples: u64, ratio: f64 },
    /// So many samples stand out of their neighbours that none was replaced.
    ManyGlitches { most: f64 },
    /// A jump of the level was taken out.
    Step { at_s: f64, size: f64 },
    /// The level jumps more often than is taken out.
    ManySteps { most: usize },
    /// Samples are missing.
    Gaps { missing: u64, samples: u64 },
    /// The spectrum has lines, which were left out.
    Lines { count: usize, frequency_hz: f64, rms: f64 },
    /// The level approaches its final value exponentially.
    WarmUp { size: f64, tau_s: f64 },
    /// Another number of Gauss–Markov terms fits about as well.
    MemoryOrFlicker { markovs: usize, others: usize, worse: f64 },
    /// A memory may be white noise behind a low-pass, which then has this N, unit·√s.
    MemoryOrFilter { tau_s: f64, n: f64 },
    /// A drift and a random walk fit about as well.
    DriftOrWalk { has_drift: bool, worse: f64 },
    /// The halves of the record differ.
    Unsteady { tau_s: f64, ratio: f64 },
    /// The samples are too few to show the sensor's band.
    ShortRecord { samples: u64, needed: u64 },
    /// A line is so strong that its leakage may be taken for noise: up to `share` of the fitted noise.
    Leakage { frequency_hz: f64, share: f64 },
    /// The measured curve differs from the model's.
    OffCurve { tau_s: f64, ratio: f64, octaves: usize },
    /// The model is off by more than the limit.
    Rejected { error: f64, most: f64, misfit: crate::Misfit },
    /// The slow rate follows the temperature: `explained` is the share of its variance, `slope` its change per °C.
    FollowsTemperature { explained: f64, slope: f64, span_c: f64 },
    /// The record is too short to tell a coefficient from zero.
    NotIdentified { noise: Noise, record_s: f64, needed_s: f64 },
}

rows!(match AllanWarning {
    Self::QuantisationLimited { q, below_s } => Row {
        code: "quantisation-limited",
        text: format_args!("quantisation hides the white noise below {below_s:.3} s; read with a finer step"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "At the shortest averages the curve falls as 1/τ.",
        matters: "That is quantisation of the angle, whose Q the model states. It comes from the step of the numbers, \
            not from the sensor, and hides the white noise there.",
        remedy: "Read with a finer step, or judge N at longer averages.",
    },
    Self::Periodic { tau_s, ratio, frequency_hz } => Row {
        code: "periodic-disturbance",
        text: format_args!(
            "near {frequency_hz:.3} Hz something lifts the curve {ratio:.2} times at {tau_s:.3} s; find it"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "At one averaging time the deviation lies far above what noise explains.",
        matters: "A periodic disturbance near that frequency, or near one that folds to it, lifts the curve, and N, B \
            and K with it.",
        remedy: "Find its source, or record without it.",
    },
    Self::Misfit { chi2, freedom } => Row {
        code: "misfit",
        text: format_args!(
            "the model does not fit (χ² = {chi2:.0} for {freedom} degrees of freedom); look at the plot"
        ),
        says: Says::Warning,
        by: &["allan"],
        seen: "The curve does not follow the noise model.",
        matters: "The intervals are too narrow.",
        remedy: "Look at the plot for steps, motion or a disturbance.",
        command: "zerorate allan log.csv --fit --plot log.svg",
    },
    Self::Drift { r, over_record } => Row {
        code: "drift",
        text: format_args!("the rate drifts by {over_record:.3e} over the record and hides K; let the sensor settle"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The rate drifts evenly over the record. The model states the drift per second as R.",
        matters: "That is temperature or warm-up rather than noise, and it hides K.",
        remedy: "Let the sensor settle, or take the temperature out.",
        command: "zerorate allan rest.parquet --fit --detrend temp",
    },
    Self::ShortEndExcluded { points, from_s, used_from_s } => Row {
        code: "short-end-excluded",
        text: format_args!("{points} averaging times below {used_from_s:.4} s left out; check that a filter is meant"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The shortest averages lie below the line of white noise, as behind a low-pass filter.",
        matters: "They were left out, and N was read from the longer ones.",
        remedy: "Nothing, unless the filter was not meant.",
    },
    Self::Glitches { glitches, samples, ratio } => Row {
        code: "glitches",
        text: format_args!(
            "{glitches} glitch{} ({samples} sample{}) replaced by straight lines; look for knocks or bit errors",
            if glitches == 1 { "" } else { "es" },
            plural(samples)
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A few samples cannot be noise: knocks or bit errors.",
        matters: "They were replaced by the line between their neighbours. With them the difference from one sample \
            to the next would be larger, and N with it.",
        remedy: "Look at them, or keep them if they are what you measure.",
        command: "zerorate allan log.csv --fit --keep-glitches",
    },
    Self::ManyGlitches { most } => Row {
        code: "many-glitches",
        text: format_args!(
            "over {:.0} % of the samples stand out, so none was replaced; look for bit errors",
            most * 100.0
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Many samples stand out of their neighbours.",
        matters: "So many cannot be glitches: nothing was replaced, and N includes them.",
        remedy: "Look at the readings for bit errors, or for a sensor whose noise does not follow a bell curve.",
    },
    Self::Step { at_s, size } => Row {
        code: "step",
        text: format_args!(
            "at {at_s:.1} s the level jumps by {size:.3e} (taken out); look for a knock or a switched supply"
        ),
    },
    Self::ManySteps { most } => Row {
        code: "many-steps",
        text: format_args!("the level jumps more than {most} times (not taken out); record where nothing moves"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The level jumps again and again.",
        matters: "Nothing was taken out: K, B or a Gauss–Markov term describes wander that is made of jumps.",
        remedy: "Record where nothing moves.",
    },
    Self::Gaps { missing, samples } => Row {
        code: "gaps",
        text: format_args!("{missing} of {samples} samples are missing; check that losses do not depend on the rate"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Samples are missing in the record.",
        matters: "The model allows for that as long as the losses do not depend on the rate.",
        remedy: "Nothing for a few. If they are many, find out what lost them.",
    },
    Self::Lines { count, frequency_hz, rms } => Row {
        code: "lines",
        text: format_args!(
            "{count} spectral line{}, the strongest at {frequency_hz:.3} Hz ({rms:.3e} rms); find the source",
            plural(count as u64)
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The spectrum has lines: disturbances or resonances.",
        matters: "They are left out of N, B and K, but are part of the measured curve.",
        remedy: "Find their source, or record without it.",
        command: "zerorate allan log.csv --fit --report log.html",
    },
    Self::WarmUp { size, tau_s } => Row {
        code: "warm-up",
        text: format_args!(
            "the level falls by {size:.3e} (time constant {tau_s:.0} s) and hides K; let the sensor settle"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The level approaches its final value exponentially.",
        matters: "That is warm-up rather than noise, and it hides K.",
        remedy: "Let the sensor settle, or leave out the beginning.",
        command: "zerorate allan log.csv --fit --skip 45m",
    },
    Self::MemoryOrFlicker { markovs, others, worse } => Row {
        code: "memory-or-flicker",
        text: format_args!(
            "{markovs} or {others} Gauss–Markov terms fit; do not extrapolate beyond a quarter of the record"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The model has the number of Gauss–Markov terms that the text names first. The second number, with \
            another B, explains the record about as well.",
        matters: "This record cannot tell them apart. Both give the same curve within it.",
        remedy: "Do not extrapolate beyond a quarter of the record's length.",
    },
    Self::MemoryOrFilter { tau_s, n } => Row {
        code: "memory-or-filter",
        text: format_args!("a memory of {tau_s:.3} s may be a low-pass of white noise; N is then {n:.3e}"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A Gauss–Markov term explains nearly all of the power, up to high frequencies.",
        matters: "White noise behind a low-pass of the first order has the same spectrum. N then is the one that the \
            text names, not the one of the model.",
        remedy: "If the sensor has such a low-pass, take the N of the text, or record a few thousand time constants.",
    },
    Self::DriftOrWalk { has_drift, worse } => Row {
        code: "drift-or-walk",
        text: format_args!(
            "{} was taken, but {} fits about as well; record again",
            if has_drift { "a drift" } else { "a random walk" },
            if has_drift { "a random walk" } else { "a drift" }
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A drift and a random walk explain the record about as well.",
        matters: "One record cannot tell drift, warm-up and random walk apart.",
        remedy: "Record again and fit both together, or take the temperature out.",
        command: "zerorate allan a.csv b.csv --fit --pool",
    },
    Self::Unsteady { tau_s, ratio } => Row {
        code: "unsteady",
        text: format_args!(
            "the {} half is {:.2} times as noisy as the {} at {tau_s:.3} s; let the sensor settle",
            if ratio > 1.0 { "first" } else { "second" },
            ratio.max(1.0 / ratio),
            if ratio > 1.0 { "second" } else { "first" }
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The noise is not steady: at one averaging time the deviations of the two halves differ.",
        matters: "The model describes the whole record, and does not predict another record.",
        remedy: "Let the sensor settle and record again.",
    },
    Self::ShortRecord { samples, needed } => Row {
        code: "short-record",
        text: format_args!("{samples} samples are too few, N may be off by a quarter; record {needed} or more"),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "So few samples do not show how the sensor's filter bends its noise.",
        matters: "N may be off by a quarter, and by more beside a resonance. Its interval does not show that.",
        remedy: "Record longer; the text says how many samples.",
    },
    Self::Leakage { frequency_hz, share } => Row {
        code: "leakage",
        text: format_args!(
            "up to {:.0} % of the fitted noise may be the line at {frequency_hz:.3} Hz; record without it",
            share * 100.0
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A line is so strong that its leakage into the spectrum may be taken for noise. It comes, goes or \
            wanders: a sine that lasts as long as the record is taken out, and leaks nowhere.",
        matters: "N may be too large, and B and K more so. Steps that were found may not be real.",
        remedy: "Record without the disturbance.",
    },
    Self::OffCurve { tau_s, ratio, octaves } => Row {
        code: "off-curve",
        text: format_args!(
            "at {tau_s:.3} s the curve is {ratio:.2} times the model ({octaves} octave{} off); do not use it there",
            plural(octaves as u64)
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "At some averaging times the measured deviation differs from the model's by more than chance.",
        matters: "The model error does not show it, because the model is fitted to the spectrum without its lines.",
        remedy: "Do not use the model at these averaging times. Look at the plot for slow motion or a strong \
            disturbance.",
    },
    Self::Rejected { error, most: _, misfit } => Row {
        code: "model-rejected",
        text: format_args!("off by {:.0} %: {misfit}", error * 100.0),
        says: Says::Either,
        by: &["allan", "imu"],
        seen: "The noise model is off by more than the limit at which it is rejected.",
        matters: "No coefficient is identified: none of them is a result, so none is written for a filter.",
        remedy: "The text names the frequencies and the likely cause. Where the power comes and goes, record at rest. \
            Below a steady resonance the model may still hold: `allan --max-freq HZ`. Where most samples repeat the \
            one before, read with a finer step. `imu --accept-rejected` writes all the same, and says so in the file.",
        command: "zerorate allan log.csv --fit --report log.html",
    },
    Self::FollowsTemperature { explained, slope, span_c } => Row {
        code: "follows-temperature",
        text: format_args!("{:.0} % of slow variance is temperature; take it out", explained * 100.0),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The rate follows the temperature: a line over temperature explains that share of its slow variance.",
        matters: "K, B and drift describe the temperature rather than noise.",
        remedy: "Take the temperature out, leave out the beginning, or record a sensor that has settled.",
        command: "zerorate allan rest.parquet --fit --detrend temp --skip 45m",
    },
    Self::NotIdentified { noise, record_s, needed_s } => Row {
        code: "not-identified",
        text: format_args!("{} cannot be told from zero {}", noise.name(), longer(needed_s)),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A coefficient cannot be told from zero in so short a record.",
        matters: "Its value is a guess within its interval. Where no practical record would tell it from zero, it is \
            too small to matter.",
        remedy: "Record as long as the text says, or do without that coefficient.",
    },
});

impl fmt::Display for AllanWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

/// One of the noises of the model.
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

/// Says how long a record would identify a coefficient.
fn longer(needed_s: f64) -> String {
    match needed_s <= LONGEST_RECORD_S {
        true if needed_s < 7200.0 => format!("in this record; record about {needed_s:.0} s"),
        true => format!("in this record; record about {:.1} h", needed_s / 3600.0),
        false => String::from("in any practical record; do without it"),
    }
}

/// The ending of a noun that is counted.
const fn plural(count: u64) -> &'static str {
    if count == 1 { "" } else { "s" }
}

#[cfg(test)]
mod tests {
    use super::AllanWarning::*;
    use super::*;
    use alloc::string::ToString;
    use alloc::vec::Vec;

    /// A line of a warning is no longer, with its code.
    const MOST_CHARS: usize = 100;
    /// The command line and the Python package name their options at the end of this one.
    const OPTIONS: [(&str, &str); 1] = [("follows-temperature", " (--detrend temp, --skip 45m)")];

    const OFF: crate::Misfit =
        crate::Misfit { from_hz: 12.345, to_hz: 23.456, ratio: 1.234, cause: crate::Cause::Resonance };

    /// One of each, in the order of the rows, with numbers as long as they typically are.
    const TYPICAL: [AllanWarning; 22] = [
        QuantisationLimited { q: 1.234e-6, below_s: 12.345 },
        Periodic { tau_s: 12.345, ratio: 12.34, frequency_hz: 123.456 },
        Misfit { chi2: 1234.0, freedom: 17 },
        Drift { r: -1.234e-6, over_record: -1.234e-3 },
        ShortEndExcluded { points: 12, from_s: 0.0123, used_from_s: 12.3456 },
        Glitches { glitches: 123, samples: 1234, ratio: 1.234 },
        ManyGlitches { most: 0.01 },
        Step { at_s: 12345.6, size: -1.234e-3 },
        ManySteps { most: 3 },
        Gaps { missing: 12345, samples: 12_345_678 },
        Lines { count: 12, frequency_hz: 123.456, rms: 1.234e-3 },
        WarmUp { size: -1.234e-3, tau_s: 1234.0 },
        MemoryOrFlicker { markovs: 2, others: 1, worse: 1.2 },
        MemoryOrFilter { tau_s: 12.345, n: 1.234e-3 },
        DriftOrWalk { has_drift: true, worse: 1.2 },
        Unsteady { tau_s: 123.456, ratio: 0.81 },
        ShortRecord { samples: 1234, needed: 2000 },
        Leakage { frequency_hz: 123.456, share: 0.12 },
        OffCurve { tau_s: 123.456, ratio: 1.23, octaves: 3 },
        Rejected { error: 0.23, most: 0.1, misfit: OFF },
        FollowsTemperature { explained: 0.93, slope: 1.234e-3, span_c: 12.3 },
        NotIdentified { noise: Noise::AngleRandomWalk, record_s: 12345.0, needed_s: 612_345.0 },
    ];

    #[test]
    fn a_warning_is_one_short_line() {
        let of_rows: Vec<_> = AllanWarning::codes().collect();
        assert_eq!(of_rows, TYPICAL.iter().map(AllanWarning::code).collect::<Vec<_>>());
        let endless = NotIdentified { noise: Noise::AngleRandomWalk, record_s: 12345.0, needed_s: f64::INFINITY };
        for warning in TYPICAL.iter().chain([&endless]) {
            let options = OPTIONS.iter().find(|(code, _)| *code == warning.code()).map_or("", |(_, options)| options);
            let line = format!("{}: {warning}{options}", warning.code());
            assert!(line.chars().count() <= MOST_CHARS && !line.contains('\n'), "{}: {line}", line.chars().count());
        }
    }

    #[test]
    fn one_is_not_several() {
        let glitch = Glitches { glitches: 1, samples: 1, ratio: 1.2 }.to_string();
        assert!(glitch.starts_with("1 glitch (1 sample) replaced"), "{glitch}");
    }
}
