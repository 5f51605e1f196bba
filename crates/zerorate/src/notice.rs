//! What a measurement has to say beside its numbers: warnings, and the refusals that end it.

use crate::hour::{Deviation, Finding};
use crate::procedure::State;
use core::fmt;

/// Rotation of the Earth, °/s, on an axis parallel to its own (F-16).
pub const EARTH_DPS: f64 = 0.00418;
/// Bias per supply voltage, °/s/mV, at most (F-01).
pub const SUPPLY_DPS_PER_MV: f64 = 0.0002;
/// Typical BTC, °/s/°C: minus the bias temperature coefficient of F-05.
pub const TYPICAL_BTC_DPS_PER_C: f64 = -0.04;

/// The result stands, but there is something to know. `Display` says what was seen, why it matters and what to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum Warning {
    /// The Earth's rotation was not subtracted.
    EarthIncluded,
    /// It was, and no other constant rotation is accounted for.
    EarthSubtracted { earth_dps: f64 },
    /// A line through two temperatures shows no curvature; its typical size is in the uncertainty of BTC.
    CurvatureUnseen { u_dps_per_c: f64 },
    /// The temperature moved between the rate average and T3.
    Drifting { drift_c: f64, shift_dps: f64, u_pbc_dps: f64 },
    /// The rate did something that neither noise nor a line over temperature explains.
    Found(Finding),
    /// The rate did more than what was found.
    Restless,
    /// The bias hardly follows the temperature.
    Flat { btc_dps_per_c: f64, typical_dps_per_c: f64 },
    /// The hour as a whole was not looked at: its seconds were not kept, or there are too few.
    HourUnchecked,
    /// PBC was averaged for less than half of the best time.
    ShortAverage { average_s: f64, best_s: f64 },
    /// The rate was read below twice the bandwidth.
    Aliased { rate_hz: f64, needed_hz: f64 },
    /// Samples were lost, within the limit.
    Lost { lost: u64, fraction: f64 },
    /// The bias wanders more than the part's typical flicker noise.
    Wandering { floor_dps: f64, typical_dps: f64 },
    /// Readings that the part cannot have measured were left out.
    Impossible { count: u64, fraction: f64 },
    /// The mechanical resonance appears near zero, where it looks like a bias.
    Resonance { folded_hz: f64, rate_hz: f64, divider: Option<u16> },
}

impl Warning {
    /// Short stable name, for scripts.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::EarthIncluded => "earth-included",
            Self::EarthSubtracted { .. } => "earth-subtracted",
            Self::CurvatureUnseen { .. } => "curvature-unseen",
            Self::Drifting { .. } => "temperature-drifting",
            Self::Found(finding) => finding.deviation.code(),
            Self::Restless => "restless",
            Self::Flat { .. } => "flat-bias",
            Self::HourUnchecked => "hour-unchecked",
            Self::ShortAverage { .. } => "short-average",
            Self::Aliased { .. } => "aliased",
            Self::Lost { .. } => "lost-samples",
            Self::Wandering { .. } => "wandering-bias",
            Self::Impossible { .. } => "impossible-readings",
            Self::Resonance { .. } => "resonance",
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::EarthIncluded => write!(
                f,
                "the Earth's rotation is inside PBC and not in its uncertainty: up to ±{EARTH_DPS} °/s, by the direction of the axis; give its component with --earth-dps. {STILL}"
            ),
            Self::EarthSubtracted { earth_dps } => write!(
                f,
                "{earth_dps:+.5} °/s were subtracted for the Earth's rotation (it is ±{EARTH_DPS} °/s at most). {STILL}"
            ),
            Self::CurvatureUnseen { u_dps_per_c } => write!(
                f,
                "two temperatures show no curvature: {u_dps_per_c:.5} °/s/°C in the uncertainty of BTC stands for a typical unit's; use --assume-linear only if this unit is known to be linear"
            ),
            Self::Drifting { drift_c, shift_dps, u_pbc_dps } => write!(
                f,
                "the temperature still drifts: T3 is {drift_c:+.3} °C off the mean of step 8, which shifts PBC by {shift_dps:+.5} °/s (u = {u_pbc_dps:.5}); settle longer or shield the part from draughts"
            ),
            Self::Found(Finding { deviation, pbc_dps, btc_dps_per_c }) => write!(
                f,
                "{deviation}. It makes PBC wrong by about {pbc_dps:+.4} °/s and BTC by about {btc_dps_per_c:+.4} °/s/°C, which is in their uncertainties; {}",
                deviation.advice()
            ),
            Self::Restless => f.write_str(
                "the rate moves in more ways than could be told apart, so the uncertainties may be too small; fix the part to a still platform, use a linear supply, and measure again"
            ),
            Self::Flat { btc_dps_per_c, typical_dps_per_c } => write!(
                f,
                "the bias hardly follows the temperature: BTC is {btc_dps_per_c:+.4} °/s/°C where {typical_dps_per_c} is typical; a wide hysteresis or a long lag looks the same over so few degrees, so check it over a wider range before you rely on it elsewhere than at T3"
            ),
            Self::HourUnchecked => f.write_str(
                "steps, lag, curvature, hysteresis and slow motion between the averages were not looked for, since the seconds of the hour were not kept or are too few; record the samples and compute the calibration from them to have that done"
            ),
            Self::ShortAverage { average_s, best_s } => write!(
                f,
                "PBC was averaged for {average_s:.1} s, less than half of the {best_s:.0} s where this part's Allan deviation is least; use a longer --offset"
            ),
            Self::Aliased { rate_hz, needed_hz } => write!(
                f,
                "{rate_hz:.0} rate samples a second are below twice the bandwidth ({needed_hz:.0} Hz): noise folds in; use a smaller divider"
            ),
            Self::Lost { lost, fraction } => {
                write!(f, "{lost} samples were lost ({:.4} %); the means leave them out", fraction * 100.0)
            }
            Self::Wandering { floor_dps, typical_dps } => write!(
                f,
                "the bias wanders more than a typical unit's: a flicker floor of {floor_dps:.4} °/s where {typical_dps} °/s is typical; the uncertainties follow it"
            ),
            Self::Impossible { count, fraction } => write!(
                f,
                "{count} readings ({:.4} %) are impossible for the bandwidth of the part, as after bit errors, and are left out; errors too small to tell from motion may have passed: lower the SPI clock, shorten or shield the cable",
                fraction * 100.0
            ),
            Self::Resonance { folded_hz, rate_hz, divider } => {
                write!(
                    f,
                    "at {rate_hz:.1} samples a second the resonance of about 14.3 kHz (F-07, known to ±50 Hz) appears at {folded_hz:.1} Hz, where averaging may not remove it: up to 0.03 °/s of false bias; "
                )?;
                match divider {
                    Some(divider) => write!(f, "read on every edge number {divider} instead (a divider of {divider})"),
                    None => f.write_str("read at another rate"),
                }
            }
        }
    }
}

/// What no measurement at rest can see, and what it would take.
const STILL: &str = "Any other rotation that is constant over the hour, or nearly, looks like bias and is inside PBC, \
    and so is a step of the supply that comes too late to be seen (200 mV in the last second, 100 mV in the last five, \
    50 mV in the last twenty): mount the part where nothing turns; to know, calibrate again with its axis turned over: \
    half of the difference of the two PBC is rotation";

impl Deviation {
    fn code(&self) -> &'static str {
        match self {
            Self::Step { .. } => "step",
            Self::Curvature { .. } => "curved",
            Self::Lag { .. } => "lagging",
            Self::Hysteresis { .. } => "hysteresis",
            Self::Sway { .. } => "swaying",
        }
    }

    fn advice(&self) -> &'static str {
        match self {
            Self::Step { .. } => "use a linear supply, and check that nothing moved",
            Self::Curvature { .. } | Self::Hysteresis { .. } => {
                "a chamber at several temperatures tells more (F-54); check that nothing moved slowly"
            }
            Self::Lag { .. } => {
                "warm and settle longer, more slowly, or use a chamber (F-54); check that nothing moved slowly"
            }
            Self::Sway { .. } => "fix the part to a still platform",
        }
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Step { at_s, size_dps } => write!(
                f,
                "the rate stepped by {size_dps:+.4} °/s at {at_s:.0} s: as a supply step that would be at least {:.0} mV",
                size_dps.abs() / SUPPLY_DPS_PER_MV
            ),
            Self::Curvature { dps_per_c2 } => {
                write!(f, "the rate bends over temperature, by {dps_per_c2:+.5} °/s/°C²: a curved bias")
            }
            Self::Lag { lag_s } => {
                write!(
                    f,
                    "the rate follows the temperature late, as if the sensing element lagged by about {lag_s:.0} s"
                )
            }
            Self::Hysteresis { width_c } => write!(
                f,
                "the rate held still until the temperature had changed by about {width_c:.1} °C: a hysteresis, or a step at the start"
            ),
            Self::Sway { hz, size_dps } => {
                write!(f, "the rate sways by ±{size_dps:.4} °/s once in {:.0} s: the platform moves", 1.0 / hz)
            }
        }
    }
}

/// The measurement must not become a calibration. `Display` says why, with the numbers, and what to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum Refusal {
    /// The rate varies more than noise and temperature explain.
    Moving { window: State, tau_s: f64, seen_dps: f64, limit_dps: f64 },
    /// A mean rate that no bias explains.
    Turning { window: State, rate_dps: f64, limit_dps: f64 },
    /// White noise far above the part's.
    Noisy { window: State, seen_dps_per_rt_hz: f64, limit_dps_per_rt_hz: f64 },
    /// T1 and T2 are too close for the wanted uncertainty of BTC.
    Span { t1_c: f64, t2_c: f64, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// The uncertainty of BTC comes from the curvature that may be there, so a larger span does not help.
    Curvature { u_btc_dps_per_c: f64, u_curvature_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// BTC would be too uncertain by what the rate did during the hour.
    Found { finding: Finding, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// The platform moves slowly, and far.
    Swaying { hz: f64, size_dps: f64, limit_dps: f64 },
    /// The bias wanders so much during step 8 that BTC would be too uncertain.
    Unsteady { floor_dps: f64, typical_dps: f64, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// Too many samples were lost.
    Lost { window: State, lost: u64, samples: u64, limit: f64 },
    /// Readings beyond the range.
    Overranged { window: State, count: u64, samples: u64 },
    /// The readings stopped changing.
    Frozen { at_s: f64, for_s: f64, both: bool },
    /// Too many readings that the part cannot have measured; or some, and a rest that moves.
    BitErrors { window: State, count: u64, samples: u64, still_moves: bool },
    /// Too many samples were lost, and in the gaps data ready itself was silent.
    Stuttering { window: State, lost: u64, samples: u64, silent_gaps: u64, gaps: u64 },
    /// A window holds too few samples.
    TooFew { window: State, samples: u64, needed: u64 },
    /// A window holds no temperature.
    NoTemperature { window: State },
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Moving { window, tau_s, seen_dps, limit_dps } => write!(
                f,
                "the part moves: during {window}, means over {tau_s:.1} s vary by {seen_dps:.4} °/s (Allan deviation) where noise and temperature explain at most {limit_dps:.4} °/s; fix the part to a still platform"
            ),
            Self::Turning { window, rate_dps, limit_dps } => write!(
                f,
                "the part turns: during {window}, its mean rate is {rate_dps:+.2} °/s, more than the ±{limit_dps} °/s that can be bias; keep the platform still"
            ),
            Self::Noisy { window, seen_dps_per_rt_hz, limit_dps_per_rt_hz } => write!(
                f,
                "the part shakes or its supply is noisy: during {window}, the noise is {seen_dps_per_rt_hz:.4} °/s/√Hz, above {limit_dps_per_rt_hz:.4} °/s/√Hz; remove the vibration and use a linear supply"
            ),
            Self::Span { t1_c, t2_c, u_btc_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "the temperature hardly changed: from T1 = {t1_c:.3} °C to T2 = {t2_c:.3} °C (by {:.3} °C), so BTC would be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted; start with a part that was off for an hour, wait longer (--warmup), or accept more with --max-u-btc",
                t2_c - t1_c
            ),
            Self::Curvature { u_btc_dps_per_c, u_curvature_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "BTC would be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted, {u_curvature_dps_per_c:.4} of it from the curvature that two temperatures cannot show; accept more with --max-u-btc, or use --assume-linear if this unit is known to be linear"
            ),
            Self::Found { finding: Finding { deviation, btc_dps_per_c, .. }, u_btc_dps_per_c, wanted_dps_per_c } => {
                write!(
                    f,
                    "{deviation}. It makes BTC wrong by about {btc_dps_per_c:+.4} °/s/°C, so that BTC would be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted; {}; or accept more with --max-u-btc",
                    deviation.advice()
                )
            }
            Self::Swaying { hz, size_dps, limit_dps } => write!(
                f,
                "the part moves: the rate sways by ±{size_dps:.3} °/s once in {:.0} s, more than the {limit_dps} °/s that a result could bear; fix the part to a still platform",
                1.0 / hz
            ),
            Self::Unsteady { floor_dps, typical_dps, u_btc_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "the rate is unsteady during the offset average (step 8): it wanders or steps as a flicker floor of {floor_dps:.4} °/s would, where {typical_dps} °/s is typical, so BTC would be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted; use a linear supply, keep the part still, or accept more with --max-u-btc"
            ),
            Self::Lost { window, lost, samples, limit } => write!(
                f,
                "{lost} of {} samples were lost during {window}, more than the {} % allowed; read temperature less often (--every-temp), then divide (--divider), or allow more with --max-lost",
                lost + samples,
                limit * 100.0
            ),
            Self::Overranged { window, count, samples } => write!(
                f,
                "{count} of {samples} readings during {window} are out of range: the part turns, or its supply or wiring is wrong"
            ),
            Self::BitErrors { window, count, samples, still_moves } => write!(
                f,
                "the line carries bit errors: {count} of {samples} readings during {window} are impossible for the bandwidth of the part{}; lower the SPI clock, shorten or shield the cable{}",
                if still_moves {
                    ", and the rest varies more than noise explains, by errors too small to tell from motion or by motion as well"
                } else {
                    ""
                },
                if still_moves { ", and fix the part to a still platform" } else { "" },
            ),
            Self::Stuttering { window, lost, samples, silent_gaps, gaps } => write!(
                f,
                "{lost} of {} samples were lost during {window}, and in {silent_gaps} of {gaps} gaps no edge of data ready came: RDY (pin 10) stutters, or the host was deaf to it for that long; check its wire, its level and its pull-up, and only then what else the host does",
                lost + samples
            ),
            Self::Frozen { at_s, for_s, both } => write!(
                f,
                "the {} frozen: at {at_s:.1} s the code had not changed for {for_s:.1} s, while noise changes every reading; reset the part and check SDO and the supply",
                if both { "readings are" } else { "rate is" }
            ),
            Self::TooFew { window, samples, needed } => write!(
                f,
                "only {samples} samples during {window}, at least {needed} are needed; check data ready, or use a smaller divider or a longer average"
            ),
            Self::NoTemperature { window } => {
                write!(f, "no temperature was read during {window}; use a smaller --every-temp")
            }
        }
    }
}

impl core::error::Error for Refusal {}
