//! What a measurement has to say beside its numbers: warnings, and the refusals that end it.

use crate::drift_checks::{Deviation, Finding};
use crate::part::Tone;
use crate::plan::EARTH_DPS;
use crate::remedy::{Names, Remedy, Say, Setting, say_all};
use crate::states::State;
use crate::uncertainty::Uncertainty;
use core::fmt;
use zerorate_allan::codes;

/// The result stands, but there is something to know. `Display` says what was seen, why it matters and what to do,
/// with the names of [`Plan`](crate::Plan) for settings; [`Say`] does so with others.
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
    Resonance { tone: Tone, folded_hz: f64, rate_hz: f64, divider: Option<u16> },
    /// A correction was used where it was not measured.
    Extrapolated { low_c: f64, high_c: f64, temp_min_c: f64, temp_max_c: f64 },
    /// The typical noise or temperature coefficient of the part is not known: rest was not judged.
    RestUnjudged,
    /// The typical curvature or hysteresis of the part is not known, and is in no uncertainty.
    CurvatureUnknown,
    /// The white noise is far above the typical one.
    Noisy { ratio: f64 },
    /// It is far below.
    Quiet { ratio: f64 },
    /// Samples are being lost.
    Losing { lost: u64 },
    /// The samples do not come as fast as they should.
    RateOff { rate_hz: f64, nominal_hz: f64 },
    /// No temperature was read; where the host hears the edge before new data, it finds none.
    NoTemperature { wrong_edge: bool },
    /// A level that changed was taken out.
    StepTaken { at_s: f64, size_dps: f64, u_dps: f64 },
    /// The platform sways, and the sway was taken out.
    SwayTaken { hz: f64, size_dps: f64 },
    /// The bias follows the temperature late; the curve is that in balance.
    Late { lag_s: f64 },
    /// One warming shows one branch of the hysteresis.
    OneBranch { hysteresis_dps: Option<f64> },
    /// The uncertainty that was asked for was not reached.
    TargetMissed { u_dps: f64, target_dps: f64 },
}

codes!(Warning {
    EarthIncluded => "earth-included",
    EarthSubtracted => "earth-subtracted",
    CurvatureUnseen => "curvature-unseen",
    Drifting => "temperature-drifting",
    Restless => "restless",
    Flat => "flat-bias",
    HourUnchecked => "hour-unchecked",
    ShortAverage => "short-average",
    Aliased => "aliased",
    Lost => "lost-samples",
    Losing => "lost-samples",
    Wandering => "wandering-bias",
    Impossible => "impossible-readings",
    Resonance => "resonance",
    Extrapolated => "extrapolated",
    RestUnjudged => "rest-unjudged",
    CurvatureUnknown => "curvature-unknown",
    Noisy => "noisy",
    Quiet => "quiet",
    RateOff => "rate",
    NoTemperature => "no-temperature",
    StepTaken => "step",
    SwayTaken => "swaying",
    Late => "lagging",
    OneBranch => "one-branch",
    TargetMissed => "target-missed";
    Self::Found(finding) => finding.deviation.code()
});

impl Warning {
    /// What to do about it, the best first.
    #[must_use]
    pub fn remedies(&self) -> &'static [Remedy] {
        match self {
            Self::EarthIncluded => &[Remedy::GiveEarth],
            Self::EarthSubtracted { .. } | Self::Lost { .. } | Self::Wandering { .. } => &[],
            Self::CurvatureUnseen { .. } => &[Remedy::AssumeLinear],
            Self::Drifting { .. } => &[Remedy::SettleLonger, Remedy::ShieldFromDraughts],
            Self::Found(finding) => finding.deviation.remedies(),
            Self::Restless => &[Remedy::FixToStillPlatform, Remedy::LinearSupply],
            Self::Flat { .. } => &[Remedy::CheckOverWiderRange],
            Self::HourUnchecked => &[Remedy::RecordAndRecompute],
            Self::ShortAverage { .. } => &[Remedy::LongerOffset],
            Self::Aliased { .. } => &[Remedy::SmallerDivider],
            Self::Impossible { .. } => &[Remedy::SlowerClock, Remedy::ShorterCable],
            Self::Resonance { .. } => &[Remedy::OtherRate],
            Self::Extrapolated { .. } => &[Remedy::WiderSpan],
            Self::RestUnjudged | Self::CurvatureUnknown => &[Remedy::CompletePart],
            Self::Noisy { .. } => &[Remedy::KeepStill, Remedy::LinearSupply],
            Self::Quiet { .. } => &[Remedy::ResetAndCheck],
            Self::Losing { .. } => &[Remedy::FasterClock, Remedy::ReadTemperatureLess, Remedy::CheckDataReady],
            Self::RateOff { .. } => &[Remedy::CheckDataReady, Remedy::FasterClock],
            Self::NoTemperature { wrong_edge } => more_temperatures(*wrong_edge),
            Self::StepTaken { .. } => &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
            Self::SwayTaken { .. } => &[Remedy::FixToStillPlatform],
            Self::Late { .. } => &[Remedy::WarmMoreSlowly],
            Self::OneBranch { .. } => &[Remedy::HeatAndCool],
            Self::TargetMissed { .. } => &[Remedy::GiveUpTarget, Remedy::Chamber],
        }
    }

    /// What was seen, and why it matters.
    fn seen(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::EarthIncluded => write!(
                f,
                "the Earth's rotation is inside PBC and not in its uncertainty: up to ±{EARTH_DPS} °/s, by the \
                 direction of the axis. {STILL}"
            ),
            Self::EarthSubtracted { earth_dps } => write!(
                f,
                "{earth_dps:+.5} °/s were subtracted for the Earth's rotation (it is ±{EARTH_DPS} °/s at most). \
                 {STILL}"
            ),
            Self::CurvatureUnseen { u_dps_per_c } => write!(
                f,
                "two temperatures show no curvature: {u_dps_per_c:.5} °/s/°C in the uncertainty of BTC stands for a \
                 typical unit's"
            ),
            Self::Drifting { drift_c, shift_dps, u_pbc_dps } => write!(
                f,
                "the temperature still drifts: T3 is {drift_c:+.3} °C off the mean of step 8, which shifts PBC by \
                 {shift_dps:+.5} °/s (u = {u_pbc_dps:.5})"
            ),
            Self::Found(Finding { deviation, pbc_dps, btc_dps_per_c }) => write!(
                f,
                "{deviation}. It makes PBC wrong by about {pbc_dps:+.4} °/s and BTC by about {btc_dps_per_c:+.4} \
                 °/s/°C, which is in their uncertainties"
            ),
            Self::Restless => f.write_str(
                "the rate moves in more ways than could be told apart, so the uncertainties may be too small",
            ),
            Self::Flat { btc_dps_per_c, typical_dps_per_c } => write!(
                f,
                "the bias hardly follows the temperature: BTC is {btc_dps_per_c:+.4} °/s/°C where {typical_dps_per_c} \
                 is typical; a wide hysteresis or a long lag looks the same over so few degrees"
            ),
            Self::HourUnchecked => f.write_str(
                "steps, lag, curvature, hysteresis and slow motion between the averages were not looked for, since \
                 the seconds of the hour were not kept or are too few",
            ),
            Self::ShortAverage { average_s, best_s } => write!(
                f,
                "PBC was averaged for {average_s:.1} s, less than half of the {best_s:.0} s where this part's Allan \
                 deviation is least"
            ),
            Self::Aliased { rate_hz, needed_hz } => write!(
                f,
                "{rate_hz:.0} rate samples a second are below twice the bandwidth ({needed_hz:.0} Hz): noise folds in"
            ),
            Self::Lost { lost, fraction } => {
                write!(f, "{lost} samples were lost ({:.4} %); the means leave them out", fraction * 100.0)
            }
            Self::Wandering { floor_dps, typical_dps } => write!(
                f,
                "the bias wanders more than a typical unit's: a flicker floor of {floor_dps:.4} °/s where \
                 {typical_dps} °/s is typical; the uncertainties follow it"
            ),
            Self::Impossible { count, fraction } => write!(
                f,
                "{count} readings ({:.4} %) are impossible for the bandwidth of the part, as after bit errors, and \
                 are left out; errors too small to tell from motion may have passed",
                fraction * 100.0
            ),
            Self::Resonance { tone: Tone { hz, tolerance_hz, rms_dps }, folded_hz, rate_hz, divider } => {
                write!(
                    f,
                    "at {rate_hz:.1} samples a second the resonance of about {:.1} kHz (known to ±{tolerance_hz:.0} \
                     Hz) appears at {folded_hz:.1} Hz, where averaging may not remove it: up to {:.2} °/s of false \
                     bias",
                    hz / 1e3,
                    core::f64::consts::SQRT_2 * rms_dps
                )?;
                divider.map_or(Ok(()), |divider| write!(f, "; a divider of {divider} is good"))
            }
            Self::Extrapolated { low_c, high_c, temp_min_c, temp_max_c } => write!(
                f,
                "{low_c:.1} … {high_c:.1} °C leaves the {temp_min_c:.1} … {temp_max_c:.1} °C of the calibration: the \
                 correction is extrapolated"
            ),
            Self::RestUnjudged => f.write_str(
                "the part's typical noise or temperature coefficient is not known: whether it was at rest was not \
                 judged, and the uncertainties hold the white noise alone",
            ),
            Self::CurvatureUnknown => f.write_str(
                "the part's typical curvature and hysteresis are not known: the uncertainty of BTC holds nothing of \
                 what two temperatures cannot show",
            ),
            Self::Noisy { ratio } => {
                write!(f, "the noise is {ratio:.1} times the typical one: the part moves, or its supply is not linear")
            }
            Self::Quiet { ratio } => {
                write!(f, "the noise is {ratio:.2} times the typical one; a part that really senses is noisier")
            }
            Self::Losing { lost } => write!(f, "{lost} samples were lost"),
            Self::RateOff { rate_hz, nominal_hz } => {
                write!(f, "{rate_hz:.1} samples a second where {nominal_hz:.1} are expected")
            }
            Self::NoTemperature { wrong_edge } => write!(f, "no temperature was read{}", because_of(wrong_edge)),
            Self::StepTaken { at_s, size_dps, u_dps } => write!(
                f,
                "the rate stepped by {size_dps:+.4} ± {:.4} °/s at {at_s:.0} s; the step is taken out and in the \
                 uncertainty, and the correction is that after it",
                Uncertainty::FACTOR * u_dps
            ),
            Self::SwayTaken { hz, size_dps } => write!(
                f,
                "{}. The sway is taken out, and what is not known of it is in the uncertainty",
                Deviation::Sway { hz, size_dps }
            ),
            Self::Late { lag_s } => write!(
                f,
                "the bias follows the temperature sensor about {lag_s:.0} s late; the curve is that in balance, and a \
                 temperature that changes by 1 °C a minute shifts the bias by what {:.1} °C do",
                lag_s / 60.0
            ),
            Self::OneBranch { hysteresis_dps: Some(half_dps) } => write!(
                f,
                "one warming shows one branch of the hysteresis: after cooling the bias of a typical unit is {:.4} \
                 °/s off, which is not in the uncertainty",
                2.0 * half_dps
            ),
            Self::OneBranch { hysteresis_dps: None } => f.write_str(
                "one warming shows one branch of the hysteresis: what cooling does is not known and not in the \
                 uncertainty",
            ),
            Self::TargetMissed { u_dps, target_dps } => write!(
                f,
                "the correction is known to {:.1} °/h (standard uncertainty, rms over the temperatures seen), not to \
                 the {:.1} °/h that were asked for: the part's own flicker and random walk do not allow it",
                3600.0 * u_dps,
                3600.0 * target_dps
            ),
        }
    }
}

impl Say for Warning {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        self.seen(f)?;
        say_all(self.remedies(), f, names)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.say(f, Setting::name)
    }
}

/// What to do where no temperature was read.
const fn more_temperatures(wrong_edge: bool) -> &'static [Remedy] {
    if wrong_edge { &[Remedy::OtherEdge] } else { &[Remedy::ReadTemperatureMore] }
}

/// Why no temperature was read, as far as the edges tell.
pub(crate) const fn because_of(wrong_edge: bool) -> &'static str {
    if wrong_edge { ": two edges of data ready were heard for each sample, each before its data" } else { "" }
}

/// What no measurement at rest can see, and what it would take.
const STILL: &str = "Any other rotation that is constant over the hour, or nearly, looks like bias and is inside PBC, \
    and so is a step of the supply that comes too late to be seen (up to 350 mV in the last second of step 8, 200 mV \
    in the last five, 100 mV before): mount the part where nothing turns; to know, calibrate again with its axis \
    turned over: half of the difference of the two PBC is rotation";

codes!(Deviation {
    Step => "step",
    Curvature => "curved",
    Lag => "lagging",
    Hysteresis => "hysteresis",
    Sway => "swaying",
});

impl Deviation {
    fn remedies(&self) -> &'static [Remedy] {
        match self {
            Self::Step { .. } => &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
            Self::Curvature { .. } | Self::Hysteresis { .. } => &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
            Self::Lag { .. } => &[Remedy::WarmMoreSlowly, Remedy::Chamber, Remedy::CheckNothingMovedSlowly],
            Self::Sway { .. } => &[Remedy::FixToStillPlatform],
        }
    }
}

impl fmt::Display for Deviation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Step { at_s, size_dps, supply_mv } => {
                write!(f, "the rate stepped by {size_dps:+.4} °/s at {at_s:.0} s")?;
                supply_mv.map_or(Ok(()), |mv| write!(f, ": as a supply step that would be at least {mv:.0} mV"))
            }
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
                "the rate held still until the temperature had changed by about {width_c:.1} °C: a hysteresis, or a \
                 step at the start"
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
    /// A window holds no temperature; where the host hears the edge before new data, it finds none.
    NoTemperature { window: State, wrong_edge: bool },
    /// The temperature did not rise and fall; what it covered in each direction.
    OneWay { rise_c: f64, fall_c: f64 },
    /// A step or a sway of the rate cannot be told from what the temperature did.
    StepOrTemperature { finding: Finding, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
}

codes!(Refusal {
    Moving => "moving",
    Turning => "turning",
    Noisy => "noisy",
    Span => "small-span",
    Curvature => "curvature-unseen",
    Swaying => "swaying",
    Unsteady => "unsteady-offset",
    Lost => "lost-samples",
    Overranged => "out-of-range",
    Frozen => "frozen",
    BitErrors => "bit-errors",
    Stuttering => "data-ready-stutters",
    TooFew => "too-few-samples",
    NoTemperature => "no-temperature",
    OneWay => "one-way";
    Self::Found { finding, .. } | Self::StepOrTemperature { finding, .. } => finding.deviation.code()
});

impl Refusal {
    /// What to do about it, the best first.
    #[must_use]
    pub fn remedies(&self) -> &'static [Remedy] {
        match self {
            Self::Moving { .. } | Self::Swaying { .. } => &[Remedy::FixToStillPlatform],
            Self::Turning { .. } => &[Remedy::KeepStill],
            Self::Noisy { .. } => &[Remedy::RemoveVibration, Remedy::LinearSupply],
            Self::Span { .. } => &[Remedy::StartCold, Remedy::LongerWarmUp, Remedy::AcceptMoreUBtc],
            Self::Curvature { .. } => &[Remedy::AcceptMoreUBtc, Remedy::AssumeLinear],
            Self::Found { finding, .. } => match finding.deviation {
                Deviation::Step { .. } => &[Remedy::LinearSupply, Remedy::CheckNothingMoved, Remedy::AcceptMoreUBtc],
                Deviation::Sway { .. } => &[Remedy::FixToStillPlatform, Remedy::AcceptMoreUBtc],
                _ => &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly, Remedy::AcceptMoreUBtc],
            },
            Self::Unsteady { .. } => &[Remedy::LinearSupply, Remedy::KeepStill, Remedy::AcceptMoreUBtc],
            Self::Lost { .. } => &[Remedy::ReadTemperatureLess, Remedy::LargerDivider, Remedy::AllowMoreLoss],
            Self::Overranged { .. } => &[Remedy::KeepStill, Remedy::CheckSupplyAndWiring],
            Self::Frozen { .. } => &[Remedy::ResetAndCheck],
            Self::BitErrors { still_moves: true, .. } => {
                &[Remedy::SlowerClock, Remedy::ShorterCable, Remedy::FixToStillPlatform]
            }
            Self::BitErrors { .. } => &[Remedy::SlowerClock, Remedy::ShorterCable],
            Self::Stuttering { .. } => &[Remedy::CheckDataReady],
            Self::TooFew { .. } => &[Remedy::CheckDataReady, Remedy::SmallerDivider, Remedy::LongerAverage],
            Self::NoTemperature { wrong_edge, .. } => more_temperatures(*wrong_edge),
            Self::OneWay { .. } => &[Remedy::HeatAndCool],
            Self::StepOrTemperature { finding: Finding { deviation: Deviation::Sway { .. }, .. }, .. } => {
                &[Remedy::FixToStillPlatform]
            }
            Self::StepOrTemperature { .. } => &[Remedy::LinearSupply, Remedy::CheckNothingMoved, Remedy::StartCold],
        }
    }

    /// What was seen, and why it must not become a calibration.
    fn seen(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Moving { window, tau_s, seen_dps, limit_dps } => write!(
                f,
                "the part moves: during {window}, means over {tau_s:.1} s vary by {seen_dps:.4} °/s (Allan deviation) \
                 where noise and temperature explain at most {limit_dps:.4} °/s"
            ),
            Self::Turning { window, rate_dps, limit_dps } => write!(
                f,
                "the part turns: during {window}, its mean rate is {rate_dps:+.2} °/s, more than the ±{limit_dps} °/s \
                 that can be bias"
            ),
            Self::Noisy { window, seen_dps_per_rt_hz, limit_dps_per_rt_hz } => write!(
                f,
                "the part shakes or its supply is noisy: during {window}, the noise is {seen_dps_per_rt_hz:.4} \
                 °/s/√Hz, above {limit_dps_per_rt_hz:.4} °/s/√Hz"
            ),
            Self::Span { t1_c, t2_c, u_btc_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "the temperature hardly changed: from T1 = {t1_c:.3} °C to T2 = {t2_c:.3} °C (by {:.3} °C), so BTC \
                 would be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted",
                t2_c - t1_c
            ),
            Self::Curvature { u_btc_dps_per_c, u_curvature_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "BTC would be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted, \
                 {u_curvature_dps_per_c:.4} of it from the curvature that two temperatures cannot show"
            ),
            Self::Found { finding: Finding { deviation, btc_dps_per_c, .. }, u_btc_dps_per_c, wanted_dps_per_c } => {
                write!(
                    f,
                    "{deviation}. It makes BTC wrong by about {btc_dps_per_c:+.4} °/s/°C, so that BTC would be \
                     uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted"
                )
            }
            Self::Swaying { hz, size_dps, limit_dps } => write!(
                f,
                "the part moves: the rate sways by ±{size_dps:.3} °/s once in {:.0} s, more than the {limit_dps} °/s \
                 that a result could bear",
                1.0 / hz
            ),
            Self::Unsteady { floor_dps, typical_dps, u_btc_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "the rate is unsteady during the offset average (step 8): it wanders or steps as a flicker floor of \
                 {floor_dps:.4} °/s would, where {typical_dps} °/s is typical, so BTC would be uncertain by \
                 {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted"
            ),
            Self::Lost { window, lost, samples, limit } => write!(
                f,
                "{lost} of {} samples were lost during {window}, more than the {} % allowed",
                lost + samples,
                limit * 100.0
            ),
            Self::Overranged { window, count, samples } => write!(
                f,
                "{count} of {samples} readings during {window} are out of range: the part turns, or its supply or \
                 wiring is wrong"
            ),
            Self::BitErrors { window, count, samples, still_moves } => write!(
                f,
                "the line carries bit errors: {count} of {samples} readings during {window} are impossible for the \
                 bandwidth of the part{}",
                if still_moves {
                    ", and the rest varies more than noise explains, by errors too small to tell from motion or by \
                     motion as well"
                } else {
                    ""
                },
            ),
            Self::Stuttering { window, lost, samples, silent_gaps, gaps } => write!(
                f,
                "{lost} of {} samples were lost during {window}, and in {silent_gaps} of {gaps} gaps no edge of data \
                 ready came: data ready stutters, or the host was deaf to it for that long",
                lost + samples
            ),
            Self::Frozen { at_s, for_s, both } => write!(
                f,
                "the {} frozen: at {at_s:.1} s the code had not changed for {for_s:.1} s, while noise changes every \
                 reading",
                if both { "readings are" } else { "rate is" }
            ),
            Self::TooFew { window, samples, needed } => {
                write!(f, "only {samples} samples during {window}, at least {needed} are needed")
            }
            Self::NoTemperature { window, wrong_edge } => {
                write!(f, "no temperature was read during {window}{}", because_of(wrong_edge))
            }
            Self::OneWay { rise_c, fall_c } => write!(
                f,
                "the temperature covered {rise_c:.1} °C while it rose and {fall_c:.1} °C while it fell: a cycle \
                 covers half of its span at least in each direction"
            ),
            Self::StepOrTemperature { finding, u_btc_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "{}, while the temperature changed as well, and the two cannot be told apart: BTC would be uncertain \
                 by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted",
                finding.deviation
            ),
        }
    }
}

impl Say for Refusal {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        self.seen(f)?;
        say_all(self.remedies(), f, names)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.say(f, Setting::name)
    }
}

impl core::error::Error for Refusal {}
