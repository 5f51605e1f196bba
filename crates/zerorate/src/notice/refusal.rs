//! Refusals: a measurement that must not become a calibration.

use super::remedy::write_remedies;
use super::{Deviation, Finding, Remedy, because_of, more_temperatures, rows_with_remedies};
use crate::plan::{Setting, SettingNames, State, Wording};
use core::fmt;

/// Largest change that counts as hardly any change of the temperature, °C.
const HARDLY_C: f64 = 5.0;

/// A refusal: the measurement must not become a calibration. `Display` says why, with the numbers, and what to do.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum Refusal {
    /// The rate varies more than noise and temperature explain.
    Moving { window: State, tau_s: f64, seen_dps: f64, limit_dps: f64 },
    /// The mean rate is larger than a bias can be.
    Turning { window: State, rate_dps: f64, limit_dps: f64 },
    /// The white noise is far above the typical one.
    Noisy { window: State, seen_dps_per_rt_hz: f64, limit_dps_per_rt_hz: f64 },
    /// T1 and T2 are too close for the wanted uncertainty of BTC.
    Span { t1_c: f64, t2_c: f64, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// The uncertainty of BTC comes from a possible curvature, so a larger span does not help.
    Curvature { u_btc_dps_per_c: f64, u_curvature_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// A deviation of the rate during the recording makes BTC too uncertain.
    Found { finding: Finding, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// The slow base motion is larger than the limit.
    BaseMotion { hz: f64, size_dps: f64, limit_dps: f64 },
    /// The bias wanders so much during step 8 that BTC would be too uncertain.
    Unsteady { floor_dps: f64, typical_dps: f64, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// Too many samples were lost.
    Lost { window: State, lost: u64, samples: u64, limit: f64 },
    /// Readings were beyond the range.
    Overranged { window: State, count: u64, samples: u64 },
    /// The readings stopped changing.
    Frozen { at_s: f64, for_s: f64, both: bool },
    /// Too many readings are impossible for the part, or bit errors explain those out of range. With `still_moves`,
    /// some readings are impossible, and the others vary too much.
    BitErrors { window: State, count: u64, samples: u64, still_moves: bool },
    /// Too many samples were lost, and data ready was silent in the gaps.
    Stuttering { window: State, lost: u64, samples: u64, silent_gaps: u64, gaps: u64 },
    /// Too few blocks of 0.1 s in a window hold samples. `needed` counts blocks.
    TooFew { window: State, tenths: u64, needed: u64 },
    /// A window holds no temperature. With `wrong_edge`, the host uses the edge of data ready before new data.
    NoTemperature { window: State, wrong_edge: bool },
    /// The recording is too short for a bias over temperature.
    TooFewMeans { means: usize, needed: usize },
    /// No bias over temperature explains the recording.
    NoCurve,
    /// The temperature did not cover enough of its span both while it rose and while it fell. The fields are the spans
    /// that it covered in each direction.
    OneWay { rise_c: f64, fall_c: f64 },
    /// A step or a base motion cannot be told from an effect of the temperature.
    StepOrTemperature { finding: Finding, u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
}

rows_with_remedies!(match Refusal {
    Self::Moving { window, tau_s, seen_dps, limit_dps } => Row {
        code: "moving",
        text: format_args!(
            "the part moves: during {window}, means over {tau_s:.1} s vary by {seen_dps:.4} °/s (Allan deviation), \
             more than the {limit_dps:.4} °/s of noise and temperature"
        ),
        remedies: &[Remedy::FixToStillPlatform],
    },
    Self::Turning { window, rate_dps, limit_dps } => Row {
        code: "turning",
        text: format_args!(
            "the part turns: its mean rate during {window} is {rate_dps:+.2} °/s, more than the ±{limit_dps} °/s \
             that a bias can be"
        ),
        remedies: &[Remedy::KeepStill],
    },
    Self::Noisy { window, seen_dps_per_rt_hz, limit_dps_per_rt_hz } => Row {
        code: "noisy",
        text: format_args!(
            "the part shakes or its supply is noisy: the noise during {window} is {seen_dps_per_rt_hz:.4} °/s/√Hz, \
             above the limit of {limit_dps_per_rt_hz:.4} °/s/√Hz"
        ),
        remedies: &[Remedy::RemoveVibration, Remedy::LinearSupply],
    },
    Self::Span { t1_c, t2_c, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: "small-span",
        text: format_args!(
            "the temperature {} ({t1_c:.3} to {t2_c:.3} °C, by {:.3} °C), so u(BTC) would be \
             {u_btc_dps_per_c:.4} °/s/°C, above the limit of {wanted_dps_per_c}",
            if (t2_c - t1_c).abs() < HARDLY_C { "hardly changed" } else { "changed too little" },
            t2_c - t1_c
        ),
        remedies: acceptable(&[Remedy::StartCold, Remedy::LongerWarmUp, Remedy::AcceptMoreUBtc], u_btc_dps_per_c),
    },
    Self::Curvature { u_btc_dps_per_c, u_curvature_dps_per_c, wanted_dps_per_c } => Row {
        code: "curvature-unseen",
        text: format_args!(
            "u(BTC) would be {u_btc_dps_per_c:.4} °/s/°C, above the limit of {wanted_dps_per_c}: \
             {u_curvature_dps_per_c:.4} of it allows for curvature that two temperatures cannot show"
        ),
        remedies: acceptable(&[Remedy::AcceptMoreUBtc, Remedy::AssumeLinear], u_btc_dps_per_c),
    },
    Self::Found { finding: Finding { deviation, btc_dps_per_c, .. }, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: { deviation.code() },
        text: format_args!(
            "{deviation}. BTC is off by about {btc_dps_per_c:+.4} °/s/°C, and u(BTC) would be {u_btc_dps_per_c:.4}, \
             above the limit of {wanted_dps_per_c}"
        ),
        remedies: {
            let remedies: &'static [Remedy] = match deviation {
                Deviation::Step { .. } => &[Remedy::LinearSupply, Remedy::CheckNothingMoved, Remedy::AcceptMoreUBtc],
                Deviation::BaseMotion { .. } => &[Remedy::FixToStillPlatform, Remedy::AcceptMoreUBtc],
                _ => &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly, Remedy::AcceptMoreUBtc],
            };
            acceptable(remedies, u_btc_dps_per_c)
        },
    },
    Self::BaseMotion { hz, size_dps, limit_dps } => Row {
        code: "swaying",
        text: format_args!(
            "the part moves: base motion of ±{size_dps:.3} °/s once in {:.0} s is above the limit of {limit_dps} °/s",
            1.0 / hz
        ),
        remedies: &[Remedy::FixToStillPlatform],
    },
    Self::Unsteady { floor_dps, typical_dps, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: "unsteady-offset",
        text: format_args!(
            "the rate is unsteady during the offset average (step 8): its flicker floor is {floor_dps:.4} °/s, and \
             {typical_dps} is typical. u(BTC) would be {u_btc_dps_per_c:.4} °/s/°C, above the limit of \
             {wanted_dps_per_c}"
        ),
        remedies: acceptable(&[Remedy::LinearSupply, Remedy::KeepStill, Remedy::AcceptMoreUBtc], u_btc_dps_per_c),
    },
    Self::Lost { window, lost, samples, limit } => Row {
        code: "lost-samples",
        text: format_args!(
            "{lost} of {} samples were lost during {window}, above the limit of {} %",
            lost + samples,
            limit * 100.0
        ),
        remedies: &[Remedy::ReadTemperatureLess, Remedy::LargerDivider, Remedy::AllowMoreLoss],
    },
    Self::Overranged { window, count, samples } => Row {
        code: "out-of-range",
        text: format_args!(
            "{count} of {samples} readings during {window} are out of range: the part turns, or its supply or \
             wiring is wrong"
        ),
        remedies: &[Remedy::KeepStill, Remedy::CheckSupplyAndWiring],
    },
    Self::Frozen { at_s, for_s, both } => Row {
        code: "frozen",
        text: format_args!(
            "the {} frozen: at {at_s:.1} s the code had not changed for {for_s:.1} s, and noise should change every \
             reading",
            if both { "readings are" } else { "rate is" }
        ),
        remedies: &[Remedy::ResetAndCheck],
    },
    Self::BitErrors { window, count, samples, still_moves } => Row {
        code: "bit-errors",
        text: format_args!(
            "the line carries bit errors: {count} of {samples} readings during {window} jump more than the bandwidth \
             of the part allows{}",
            if still_moves { ". The rest varies more than noise, by smaller errors or by motion" } else { "" },
        ),
        remedies: match still_moves {
            true => &[Remedy::SlowerClock, Remedy::ShorterCable, Remedy::FixToStillPlatform],
            false => &[Remedy::SlowerClock, Remedy::ShorterCable],
        },
    },
    Self::Stuttering { window, lost, samples, silent_gaps, gaps } => Row {
        code: "data-ready-stutters",
        text: format_args!(
            "data ready stutters, or the host missed it: {lost} of {} samples were lost during {window}, and no edge \
             came in {silent_gaps} of {gaps} gaps",
            lost + samples
        ),
        remedies: &[Remedy::CheckDataReady],
    },
    Self::TooFew { window, tenths, needed } => Row {
        code: "too-few-samples",
        text: format_args!(
            "{window} has samples in only {tenths} tenths of a second, and at least {needed} are needed"
        ),
        remedies: &[Remedy::CheckDataReady, Remedy::SmallerDivider, Remedy::LongerAverage],
    },
    Self::NoTemperature { window, wrong_edge } => Row {
        code: "no-temperature",
        text: format_args!("no temperature was read during {window}{}", because_of(wrong_edge)),
        remedies: more_temperatures(wrong_edge),
    },
    Self::TooFewMeans { means, needed } => Row {
        code: "no-curve",
        text: format_args!(
            "the recording gives only {means} means over time, and a bias over temperature needs at least {needed}"
        ),
        remedies: &[Remedy::LongerWarmUp, Remedy::SettleLonger],
    },
    Self::NoCurve => Row {
        code: "no-curve",
        text: format_args!("no bias over temperature explains the rate"),
        remedies: &[Remedy::KeepStill],
    },
    Self::OneWay { rise_c, fall_c } => Row {
        code: "one-way",
        text: format_args!(
            "the temperature covered {rise_c:.1} °C while it rose and {fall_c:.1} °C while it fell. A cycle must \
             cover at least half of its span in each direction"
        ),
        remedies: &[Remedy::HeatAndCool],
    },
    Self::StepOrTemperature { finding, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: { finding.deviation.code() },
        text: format_args!(
            "{}, which cannot be told from a change of the temperature. u(BTC) would be {u_btc_dps_per_c:.4} \
             °/s/°C, above the limit of {wanted_dps_per_c}",
            finding.deviation
        ),
        remedies: match finding.deviation {
            Deviation::BaseMotion { .. } => &[Remedy::FixToStillPlatform],
            _ => &[Remedy::LinearSupply, Remedy::CheckNothingMoved, Remedy::StartCold],
        },
    },
});

/// The remedies without [`Remedy::AcceptMoreUBtc`] if u(BTC) is more than its setting allows.
fn acceptable(remedies: &'static [Remedy], u_btc_dps_per_c: f64) -> &'static [Remedy] {
    let may_accept = Setting::MaxUBtc.bounds().is_none_or(|bounds| u_btc_dps_per_c <= bounds.most);
    match remedies {
        [rest @ .., Remedy::AcceptMoreUBtc] | [Remedy::AcceptMoreUBtc, rest @ ..] if !may_accept => rest,
        all => all,
    }
}

impl Wording for Refusal {
    fn fmt_with(&self, f: &mut fmt::Formatter<'_>, names: SettingNames) -> fmt::Result {
        self.text(f)?;
        write_remedies(self.remedies(), f, names)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.fmt_with(f, Setting::name)
    }
}

impl core::error::Error for Refusal {}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    #[test]
    fn a_larger_uncertainty_is_advised_only_where_its_setting_allows_it() {
        let refused =
            |t2_c, u_btc_dps_per_c| Refusal::Span { t1_c: 25.0, t2_c, u_btc_dps_per_c, wanted_dps_per_c: 0.01 };
        for (t2_c, u_btc_dps_per_c, says, accepts) in [
            (25.1, 1.0, "hardly changed", true),
            (25.1, 1.779, "hardly changed", false),
            (34.8, 0.02, "changed too little", true),
        ] {
            let refusal = refused(t2_c, u_btc_dps_per_c);
            assert!(refusal.to_string().contains(says), "{refusal}");
            assert_eq!(refusal.remedies().contains(&Remedy::AcceptMoreUBtc), accepts, "{refusal}");
        }
        let curved = Refusal::Curvature { u_btc_dps_per_c: 2.0, u_curvature_dps_per_c: 2.0, wanted_dps_per_c: 0.01 };
        assert_eq!(curved.remedies(), [Remedy::AssumeLinear]);
    }
}
