//! Warnings: the result stands, but the user should know something about it.

use super::deviation::Brief;
use super::remedy::write_remedies;
use super::{Finding, Remedy, more_temperatures, rows_with_remedies};
use crate::part::Tone;
use crate::plan::{EARTH_DPS, Setting, SettingNames, Wording};
use crate::uncertainty::Uncertainty;
use core::fmt;

/// A warning: the result stands, but the user should know something about it. `Display` says what was seen and what to
/// do, in one line of at most 100 characters with the code before it. docs/codes.md says why it matters and what else
/// helps. `Display` uses the names of [`Plan`](crate::Plan) for settings, and [`Wording`] takes other names.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum Warning {
    /// The Earth's rotation was not subtracted.
    EarthIncluded,
    /// The Earth's rotation was subtracted, and no other constant rotation is accounted for.
    EarthSubtracted { earth_dps: f64 },
    /// The Earth's rotation was subtracted from a simulated part that does not turn.
    TwinAtRest { earth_dps: f64 },
    /// The bias is far above a typical one: the part may have turned.
    Turning { rate_dps: f64, typical_dps: f64 },
    /// A line through two temperatures shows no curvature. The uncertainty of BTC allows for its typical size.
    CurvatureUnseen { u_dps_per_c: f64 },
    /// From the average of step 8 to that for T3, the temperature changed enough to shift PBC by more than its noise.
    Drifting { drift_c: f64, shift_dps: f64, u_pbc_dps: f64 },
    /// The rate changed in a way that neither noise nor a line over temperature explains.
    Found(Finding),
    /// The rate varies more than the reported deviations explain.
    Restless,
    /// The bias hardly follows the temperature.
    Flat { btc_dps_per_c: f64, typical_dps_per_c: f64 },
    /// The measurement as a whole was not checked: its seconds were not kept or too few, or the noise is not known.
    HourUnchecked,
    /// PBC was averaged for less than half of the best time.
    ShortAverage { average_s: f64, best_s: f64 },
    /// The rate was sampled at less than twice the bandwidth.
    Aliased { rate_hz: f64, needed_hz: f64 },
    /// Samples were lost, within the limit.
    Lost { lost: u64, fraction: f64 },
    /// The bias wanders more than the part's typical flicker noise.
    Wandering { floor_dps: f64, typical_dps: f64 },
    /// Readings that the part cannot have measured were left out.
    Impossible { count: u64, fraction: f64 },
    /// The mechanical resonance appears near zero, where it looks like a bias.
    Resonance { tone: Tone, folded_hz: f64, rate_hz: f64, divider: Option<u16> },
    /// A correction was used at temperatures at which it was not measured.
    Extrapolated { low_c: f64, high_c: f64, temp_min_c: f64, temp_max_c: f64 },
    /// The typical noise or temperature coefficient of the part is not known, so rest was not judged.
    RestUnjudged,
    /// The typical curvature or hysteresis of the part is not known, so no uncertainty allows for it.
    CurvatureUnknown,
    /// The white noise is far above the typical one.
    Noisy { ratio: f64 },
    /// The white noise is far below the typical one.
    Quiet { ratio: f64 },
    /// Samples are being lost.
    Losing { lost: u64 },
    /// The samples do not come as fast as they should.
    RateOff { rate_hz: f64, nominal_hz: f64 },
    /// No temperature was read. With `wrong_edge`, the host uses the edge of data ready before new data.
    NoTemperature { wrong_edge: bool },
    /// A step of the rate was removed.
    StepTaken { at_s: f64, size_dps: f64, u_dps: f64 },
    /// An oscillation of the base was removed.
    BaseMotionRemoved { hz: f64, size_dps: f64 },
    /// The bias lags behind the temperature. The curve holds for a steady temperature.
    Late { lag_s: f64 },
    /// The sensor was only warmed, so that one branch of the hysteresis was measured.
    OneBranch { hysteresis_dps: Option<f64> },
    /// The wanted uncertainty was not reached.
    TargetMissed { u_dps: f64, target_dps: f64 },
}

rows_with_remedies!(match Warning {
    Self::EarthIncluded => Row {
        code: "earth-included",
        text: format_args!("Earth rotation (up to {EARTH_DPS} °/s) is part of PBC"),
        remedies: &[Remedy::GiveEarth],
    },
    Self::EarthSubtracted { earth_dps } => Row {
        code: "earth-subtracted",
        text: format_args!("{earth_dps:+.5} °/s of Earth rotation was subtracted; check that nothing else turns"),
        remedies: &[],
    },
    Self::TwinAtRest { earth_dps } => Row {
        code: "twin-at-rest",
        text: format_args!(
            "the twin does not turn: PBC is {earth_dps:+.5} °/s off; give it rotation_dps={earth_dps:.5}"
        ),
        remedies: &[],
    },
    Self::Turning { rate_dps, typical_dps } => Row {
        code: "turning",
        text: format_args!("a bias of {rate_dps:+.2} °/s (±{typical_dps} is typical) may be rotation"),
        remedies: &[Remedy::KeepStill],
    },
    Self::CurvatureUnseen { u_dps_per_c } => Row {
        code: "curvature-unseen",
        text: format_args!("u(BTC) allows {u_dps_per_c:.4} °/s/°C for curvature"),
        remedies: &[Remedy::AssumeLinear],
    },
    Self::Drifting { drift_c, shift_dps, u_pbc_dps } => Row {
        code: "temperature-drifting",
        text: format_args!("T3 is {drift_c:+.3} °C off step 8: PBC shifts {shift_dps:+.4} °/s"),
        remedies: &[Remedy::SettleLonger, Remedy::ShieldFromDraughts],
    },
    Self::Found(Finding { deviation, pbc_dps, btc_dps_per_c }) => Row {
        code: { deviation.code() },
        text: format_args!("{} (PBC {pbc_dps:+.4} °/s, BTC {btc_dps_per_c:+.4} °/s/°C)", Brief(deviation)),
        remedies: deviation.remedies(),
    },
    Self::Restless => Row {
        code: "restless",
        text: format_args!("unexplained changes may make the uncertainties too small"),
        remedies: &[Remedy::FixToStillPlatform, Remedy::LinearSupply],
    },
    Self::Flat { btc_dps_per_c, typical_dps_per_c } => Row {
        code: "flat-bias",
        text: format_args!("BTC is only {btc_dps_per_c:+.4} °/s/°C, and {typical_dps_per_c} is typical"),
        remedies: &[Remedy::CheckOverWiderRange],
    },
    Self::HourUnchecked => Row {
        code: "hour-unchecked",
        text: format_args!("cannot see steps, lag or motion: short, or noise unknown"),
        remedies: &[Remedy::RecordAndRecompute],
    },
    Self::ShortAverage { average_s, best_s } => Row {
        code: "short-average",
        text: format_args!("PBC was averaged for {average_s:.1} s, and {best_s:.0} s is best"),
        remedies: &[Remedy::LongerOffset],
    },
    Self::Aliased { rate_hz, needed_hz } => Row {
        code: "aliased",
        text: format_args!("{rate_hz:.0} samples/s are below twice the bandwidth ({needed_hz:.0} Hz)"),
        remedies: &[Remedy::SmallerDivider],
    },
    Self::Lost { lost, fraction } => Row {
        code: "lost-samples",
        text: format_args!("{lost} samples were lost ({:.4} %); the means leave them out", fraction * 100.0),
        remedies: &[],
    },
    Self::Wandering { floor_dps, typical_dps } => Row {
        code: "wandering-bias",
        text: format_args!(
            "the flicker floor is {floor_dps:.4} °/s, and {typical_dps} is typical; analyse hours of rest"
        ),
        remedies: &[],
    },
    Self::Impossible { count, fraction } => Row {
        code: "impossible-readings",
        text: format_args!("{count} readings ({:.4} %) are bit errors, left out", fraction * 100.0),
        remedies: &[Remedy::SlowerClock, Remedy::ShorterCable],
    },
    Self::Resonance { tone: Tone { rms_dps, .. }, rate_hz, divider, .. } => Row {
        code: "resonance",
        text: format_args!(
            "at {rate_hz:.1}/s the resonance adds up to {:.2} °/s{}",
            core::f64::consts::SQRT_2 * rms_dps,
            NoneAt(divider)
        ),
        remedies: &[Remedy::OtherRate],
    },
    Self::Extrapolated { low_c, high_c, temp_min_c, temp_max_c } => Row {
        code: "extrapolated",
        text: format_args!("{low_c:.1} … {high_c:.1} °C leaves the {temp_min_c:.1} … {temp_max_c:.1} °C calibrated"),
        remedies: &[Remedy::WiderSpan],
    },
    Self::RestUnjudged => Row {
        code: "rest-unjudged",
        text: format_args!("typical noise or tempco is unknown, so rest was not judged"),
        remedies: &[Remedy::CompletePart],
    },
    Self::CurvatureUnknown => Row {
        code: "curvature-unknown",
        text: format_args!("u(BTC) leaves out curvature and hysteresis"),
        remedies: &[Remedy::CompletePart],
    },
    Self::Noisy { ratio } => Row {
        code: "noisy",
        text: format_args!("the noise is {ratio:.1} times typical: motion, or the supply"),
        remedies: &[Remedy::KeepStill, Remedy::LinearSupply],
    },
    Self::Quiet { ratio } => Row {
        code: "quiet",
        text: format_args!("the noise is {ratio:.2} times typical"),
        remedies: &[Remedy::ResetAndCheck],
    },
    Self::Losing { lost } => Row {
        code: "lost-samples",
        text: format_args!("{lost} samples were lost"),
        remedies: &[Remedy::FasterClock, Remedy::ReadTemperatureLess, Remedy::CheckDataReady],
    },
    Self::RateOff { rate_hz, nominal_hz } => Row {
        code: "rate",
        text: format_args!("{rate_hz:.1} samples/s, and {nominal_hz:.1} are expected"),
        remedies: &[Remedy::CheckDataReady, Remedy::FasterClock],
    },
    Self::NoTemperature { wrong_edge } => Row {
        code: "no-temperature",
        text: format_args!("{}", if wrong_edge { "two edges per sample" } else { "no temperature was read" }),
        remedies: more_temperatures(wrong_edge),
    },
    Self::StepTaken { at_s, size_dps, u_dps } => Row {
        code: "step",
        text: format_args!(
            "rate stepped {size_dps:+.4} ± {:.4} °/s at {at_s:.0} s, taken out",
            Uncertainty::FACTOR * u_dps
        ),
        remedies: &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
    },
    Self::BaseMotionRemoved { hz, size_dps } => Row {
        code: "swaying",
        text: format_args!("base motion of ±{size_dps:.4} °/s once in {:.0} s was removed", 1.0 / hz),
        remedies: &[Remedy::FixToStillPlatform],
    },
    Self::Late { lag_s } => Row {
        code: "lagging",
        text: format_args!("the bias lags by {lag_s:.0} s: at 1 °C/min it is {:.1} °C behind", lag_s / 60.0),
        remedies: &[Remedy::WarmMoreSlowly],
    },
    Self::OneBranch { hysteresis_dps: Some(half_dps) } => Row {
        code: "one-branch",
        text: format_args!("a typical {:.4} °/s shift by cooling is not in the uncertainty", 2.0 * half_dps),
        remedies: &[Remedy::HeatAndCool],
    },
    Self::OneBranch { hysteresis_dps: None } => Row {
        code: "one-branch",
        text: format_args!("the shift by cooling is unknown and not in the uncertainty"),
        remedies: &[Remedy::HeatAndCool],
    },
    Self::TargetMissed { u_dps, target_dps } => Row {
        code: "target-missed",
        text: format_args!("standard uncertainty {:.1} °/h, not {:.1} °/h", 3600.0 * u_dps, 3600.0 * target_dps),
        remedies: &[Remedy::GiveUpTarget, Remedy::Chamber],
    },
});

/// Says whether the effect of a standing warning is in the uncertainty, is not in it, or was taken out. A standing
/// warning comes with every measurement of the same part by the same plan. `None` for other codes.
#[must_use]
pub fn standing_place(code: &str) -> Option<&'static str> {
    match code {
        "earth-included" | "one-branch" => Some("not in the uncertainty"),
        "curvature-unseen" => Some("in the uncertainty"),
        "earth-subtracted" => Some("taken out"),
        _ => None,
    }
}

impl Warning {
    /// Whether the warning follows from plan and part, so that every measurement of this part by this plan has it.
    #[must_use]
    pub fn is_standing(&self) -> bool {
        standing_place(self.code()).is_some()
    }
}

impl Wording for Warning {
    fn fmt_with(&self, f: &mut fmt::Formatter<'_>, names: SettingNames) -> fmt::Result {
        self.text(f)?;
        write_remedies(self.remedies().get(..1).unwrap_or_default(), f, names)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fmt_with(f, Setting::name)
    }
}

/// Writes a divider at which the resonance does not look like a bias, if there is one.
struct NoneAt(Option<u16>);

impl fmt::Display for NoneAt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |divider| write!(f, " (none at {divider})"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    #[test]
    fn the_best_remedy_ends_the_text() {
        let earth = Warning::EarthIncluded.to_string();
        assert!(earth.ends_with("is part of PBC; give its component (earth_dps)"), "{earth}");
    }
}
