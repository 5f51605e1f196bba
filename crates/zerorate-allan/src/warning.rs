//! What there is to know about a curve or a noise model.

use crate::{Says, rows};
use alloc::format;
use alloc::string::String;
use core::fmt;

/// A record that would have to be longer, s, nobody makes: a thousand hours.
pub const LONGEST_RECORD_S: f64 = 3.6e6;

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
    /// The curve does not follow the noise model of a curve.
    Misfit { chi2: f64, freedom: usize },
    /// The rate drifts evenly.
    Drift { r: f64, over_record: f64 },
    /// The shortest averages lie below the line of white noise.
    ShortEndExcluded { points: usize, from_s: f64, used_from_s: f64 },
    /// Samples were replaced.
    Glitches { glitches: u64, samples: u64, ratio: f64 },
    /// So many samples stand out that none was replaced.
    ManyGlitches { most: f64 },
    /// A jump of the level was taken out.
    Step { at_s: f64, size: f64 },
    /// More jumps than are taken out.
    ManySteps { most: usize },
    /// Samples are missing.
    Gaps { missing: u64, samples: u64 },
    /// The spectrum has lines, which were left out.
    Lines { count: usize, frequency_hz: f64, rms: f64 },
    /// The level goes to its end as an exponential.
    WarmUp { size: f64, tau_s: f64 },
    /// Another number of Gauss–Markov terms fits about as well.
    MemoryOrFlicker { markovs: usize, others: usize, worse: f64 },
    /// A drift and a random walk fit about as well.
    DriftOrWalk { has_drift: bool, worse: f64 },
    /// The halves of the record differ.
    Unsteady { tau_s: f64, ratio: f64 },
    /// So few samples do not show the sensor's band.
    ShortRecord { samples: u64, needed: u64 },
    /// A line is so strong that what it leaks into the spectrum may be taken for noise: up to this share of it.
    Leakage { frequency_hz: f64, share: f64 },
    /// The measured curve is not the model's.
    OffCurve { tau_s: f64, ratio: f64, octaves: usize },
    /// The model is wrong by more than it may be.
    Rejected { error: f64, most: f64 },
    /// The slow rate follows the temperature: `explained` is the share of its variance, `slope` that per °C.
    FollowsTemperature { explained: f64, slope: f64, span_c: f64 },
    /// The record is too short to tell a coefficient from zero.
    NotIdentified { noise: Noise, record_s: f64, needed_s: f64 },
}

rows!(match AllanWarning {
    Self::QuantisationLimited { q, below_s } => Row {
        code: "quantisation-limited",
        text: format_args!(
            "below {below_s:.3} s the curve falls as 1/τ: quantisation of the angle (Q = {q:.3e}) hides the white \
             noise there; read with a finer step, or judge N at longer averages"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "At the shortest averages the curve falls as 1/τ.",
        matters: "That is the step of the numbers, not the sensor, and it hides the white noise there.",
        remedy: "Read with a finer step, or judge N at longer averages.",
    },
    Self::Periodic { tau_s, ratio, frequency_hz } => Row {
        code: "periodic-disturbance",
        text: format_args!(
            "at {tau_s:.3} s the deviation is {ratio:.2} times what noise explains: a periodic disturbance near \
             {frequency_hz:.3} Hz (or one that folds to it) lifts the curve, and N, B and K with it; find its source, \
             or record without it"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "One averaging time lies far above what noise explains.",
        matters: "Something periodic lifts the curve, and N, B and K with it.",
        remedy: "Find its source, or record without it.",
    },
    Self::Misfit { chi2, freedom } => Row {
        code: "misfit",
        text: format_args!(
            "the curve does not follow the noise model (χ² = {chi2:.0} for {freedom} degrees of freedom): the \
             intervals are too narrow; look at the plot for steps, motion or a disturbance"
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
        text: format_args!(
            "the rate drifts evenly by {r:.3e} per second, {over_record:.3e} over the record: that is temperature or \
             warm-up rather than noise, and it hides K; let the part settle, or take the temperature out first"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The rate drifts evenly over the record.",
        matters: "That is temperature or warm-up rather than noise, and it hides K.",
        remedy: "Let the part settle, or take the temperature out.",
        command: "zerorate allan rest.parquet --fit --detrend temp",
    },
    Self::ShortEndExcluded { points, from_s, used_from_s } => Row {
        code: "short-end-excluded",
        text: format_args!(
            "from {from_s:.4} s the deviation lies below the line of white noise, as behind a low-pass filter: \
             {points} averaging times were left out and N was read from {used_from_s:.4} s on; nothing to do unless \
             the filter was not meant"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The shortest averages lie below the line of white noise, as behind a low-pass filter.",
        matters: "They were left out, and N was read behind them.",
        remedy: "Nothing, unless the filter was not meant.",
    },
    Self::Glitches { glitches, samples, ratio } => Row {
        code: "glitches",
        text: format_args!(
            "{glitches} glitches cannot be noise (knocks, bit errors): {samples} samples were replaced by the line \
             between their neighbours; with them the difference from one sample to the next is {ratio:.3} times as \
             large, and N grows with it; look at them, or keep them if they are what you measure"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A few samples cannot be noise: knocks or bit errors.",
        matters: "They were replaced by the line between their neighbours; with them N would be larger.",
        remedy: "Look at them, or keep them if they are what you measure.",
        command: "zerorate allan log.csv --fit --keep-glitches",
    },
    Self::ManyGlitches { most } => Row {
        code: "many-glitches",
        text: format_args!(
            "more than {:.0} % of the samples stand out of their neighbours: nothing was replaced, and N has them in \
             it; look at the readings for bit errors, or at a sensor whose noise is no bell curve",
            most * 100.0
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Many samples stand out of their neighbours.",
        matters: "So many are no glitches: nothing was replaced, and N has them in it.",
        remedy: "Look for bit errors, or for a sensor whose noise is no bell curve.",
    },
    Self::Step { at_s, size } => Row {
        code: "step",
        text: format_args!(
            "at {at_s:.1} s the level jumps by {size:.3e} and stays: it was taken out, since a random walk would be \
             seen in its place; look for a knock, a switched supply or a table that gave way"
        ),
    },
    Self::ManySteps { most } => Row {
        code: "many-steps",
        text: format_args!(
            "the level jumps more than {most} times: nothing was taken out, and K, B or a Gauss–Markov term describes \
             wander that is made of jumps; record where nothing moves"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The level jumps again and again.",
        matters: "Nothing was taken out: K, B or a Gauss–Markov term describe wander that is made of jumps.",
        remedy: "Record where nothing moves.",
    },
    Self::Gaps { missing, samples } => Row {
        code: "gaps",
        text: format_args!(
            "{missing} of {samples} samples are missing: the model allows for that as long as the losses do not \
             depend on the rate"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Samples are missing in the record.",
        matters: "The model allows for that as long as the losses do not depend on the rate.",
        remedy: "Nothing for a few. Find out what lost them if they are many.",
    },
    Self::Lines { count, frequency_hz, rms } => Row {
        code: "lines",
        text: format_args!(
            "the spectrum has {count} line{} (the strongest at {frequency_hz:.3} Hz, {rms:.3e} rms): disturbances or \
             resonances, left out of N, B and K but part of the curve; find their source, or record without it",
            if count == 1 { "" } else { "s" }
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
            "the level falls by {size:.3e} with a time constant of about {tau_s:.0} s: that is warm-up rather than \
             noise, and it hides K; let the part settle, or cut the beginning"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The level goes to its end as an exponential.",
        matters: "That is warm-up rather than noise, and it hides K.",
        remedy: "Let the part settle, or leave out the beginning.",
        command: "zerorate allan log.csv --fit --skip 45m",
    },
    Self::MemoryOrFlicker { markovs, others, worse } => Row {
        code: "memory-or-flicker",
        text: format_args!(
            "{markovs} Gauss–Markov terms were taken, and {others} with another B explain the record about as well \
             (−2 ln L and price differ by {worse:.1}): this record cannot tell them apart; both give the same curve \
             within it, so do not extrapolate beyond a quarter of its length"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "Another number of Gauss–Markov terms, with another B, explains the record about as well.",
        matters: "This record cannot tell them apart. Both give the same curve within it.",
        remedy: "Do not extrapolate beyond a quarter of the record's length.",
    },
    Self::DriftOrWalk { has_drift, worse } => Row {
        code: "drift-or-walk",
        text: format_args!(
            "{} was taken, and {} explains the record about as well (−2 ln L and price differ by {worse:.1}): one \
             record cannot tell drift, warm-up and random walk apart; record again, or take the temperature out",
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
            "the noise is not steady: at {tau_s:.3} s the {} half of the record has {:.2} times the deviation of the \
             {} half; the model is of the whole, and will not predict another record; let the part settle and record \
             again",
            if ratio > 1.0 { "first" } else { "second" },
            ratio.max(1.0 / ratio),
            if ratio > 1.0 { "second" } else { "first" }
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The two halves of the record differ.",
        matters: "The model is of the whole, and does not predict another record.",
        remedy: "Let the part settle and record again.",
    },
    Self::ShortRecord { samples, needed } => Row {
        code: "short-record",
        text: format_args!(
            "{samples} samples are too few to see how the sensor's filter bends its noise: N may be off by a quarter, \
             and by more beside a resonance, whatever its interval says; record {needed} or more"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "So few samples do not show how the sensor's filter bends its noise.",
        matters: "N may be off by a quarter, whatever its interval says.",
        remedy: "Record longer; the text says how many samples.",
    },
    Self::Leakage { frequency_hz, share } => Row {
        code: "leakage",
        text: format_args!(
            "the line at {frequency_hz:.3} Hz is so strong that up to {:.0} % of what the noise is fitted to may be \
             what it leaks there: N may be too large, B and K by more, and steps may be none; record without it",
            share * 100.0
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A line is so strong that what it leaks into the spectrum may be taken for noise.",
        matters: "N may be too large, B and K by more, and steps may be none.",
        remedy: "Record without the disturbance.",
    },
    Self::OffCurve { tau_s, ratio, octaves } => Row {
        code: "off-curve",
        text: format_args!(
            "at {tau_s:.3} s the measured deviation is {ratio:.2} times the model's, and {octaves} octaves are off by \
             more than chance: the model error, which is of the spectrum without its lines, does not show it; do not \
             use the model at these averaging times, and look at the plot for slow motion or a strong disturbance"
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "At some averaging times the measured deviation is not the model's.",
        matters: "The model is of the spectrum without its lines, and does not hold there.",
        remedy: "Do not use the model at these times; look for slow motion or a strong disturbance.",
    },
    Self::Rejected { error, most } => Row {
        code: "model-rejected",
        text: format_args!(
            "the noise model is off by {:.0} %, more than the {:.0} % at which it is rejected: no coefficient is \
             identified; look at the spectrum and the plot for motion, several disturbances, or codes that hardly \
             change",
            error * 100.0,
            most * 100.0
        ),
        says: Says::Either,
        by: &["allan", "imu"],
        seen: "The noise model is wrong by more than it may be.",
        matters: "None of its coefficients is a result, so none is written for a filter.",
        remedy: "Look at spectrum and plot for motion, several disturbances, or codes that hardly change. `imu \
            --force` writes all the same, and says so in the file.",
        command: "zerorate allan log.csv --fit --report log.html",
    },
    Self::FollowsTemperature { explained, slope, span_c } => Row {
        code: "follows-temperature",
        text: format_args!(
            "the rate follows the temperature: a line over it ({slope:.3e} per °C, {span_c:.1} °C) explains {:.0} % \
             of its slow variance, and K, B and drift describe that rather than noise; take it out, leave out the \
             beginning, or record a part that has settled",
            explained * 100.0
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "The slow part of the rate follows the temperature.",
        matters: "K, B and drift describe that rather than noise.",
        remedy: "Take it out, leave out the beginning, or record a part that has settled.",
        command: "zerorate allan rest.parquet --fit --detrend temp --skip 45m",
    },
    Self::NotIdentified { noise, record_s, needed_s } => Row {
        code: "not-identified",
        text: format_args!(
            "{} cannot be told from zero in {record_s:.0} s: its value is a guess within its interval; {}",
            noise.name(),
            longer(needed_s)
        ),
        says: Says::Warning,
        by: &["allan", "imu"],
        seen: "A coefficient cannot be told from zero in so short a record.",
        matters: "Its value is a guess within its interval.",
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

/// What to record so that a coefficient is identified.
fn longer(needed_s: f64) -> String {
    match needed_s <= LONGEST_RECORD_S {
        true => format!("record about {needed_s:.0} s ({:.1} h)", needed_s / 3600.0),
        false => String::from("no record of practical length would tell, and where it is so small it does not matter"),
    }
}
