//! Refusals: the measurement must not become a calibration.

use super::{because_of, more_temperatures, rows_with_remedies};
use crate::drift_checks::{Deviation, Finding};
use crate::remedy::{Names, Remedy, Say, Setting, say_all};
use crate::states::State;
use core::fmt;
use zerorate_allan::Says;

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

rows_with_remedies!(match Refusal {
    Self::Moving { window, tau_s, seen_dps, limit_dps } => Row {
        code: "moving",
        text: format_args!(
            "the part moves: during {window}, means over {tau_s:.1} s vary by {seen_dps:.4} °/s (Allan deviation) \
             where noise and temperature explain at most {limit_dps:.4} °/s"
        ),
        remedies: &[Remedy::FixToStillPlatform],
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "Means of the rate vary more than noise and temperature explain: the part moves.",
        matters: "Motion would become bias.",
        remedy: "Fix the part to a still platform, and stay away from it.",
    },
    Self::Turning { window, rate_dps, limit_dps } => Row {
        code: "turning",
        text: format_args!(
            "the part turns: during {window}, its mean rate is {rate_dps:+.2} °/s, more than the ±{limit_dps} °/s \
             that can be bias"
        ),
        remedies: &[Remedy::KeepStill],
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "The mean rate is larger than any bias of such a part.",
        matters: "The part turns, or is not the part that it is taken for.",
        remedy: "Keep the platform still; check the file of the part.",
        command: "zerorate probe",
    },
    Self::Noisy { window, seen_dps_per_rt_hz, limit_dps_per_rt_hz } => Row {
        code: "noisy",
        text: format_args!(
            "the part shakes or its supply is noisy: during {window}, the noise is {seen_dps_per_rt_hz:.4} °/s/√Hz, \
             above {limit_dps_per_rt_hz:.4} °/s/√Hz"
        ),
        remedies: &[Remedy::RemoveVibration, Remedy::LinearSupply],
    },
    Self::Span { t1_c, t2_c, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: "small-span",
        text: format_args!(
            "the temperature hardly changed: from T1 = {t1_c:.3} °C to T2 = {t2_c:.3} °C (by {:.3} °C), so BTC would \
             be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted",
            t2_c - t1_c
        ),
        remedies: &[Remedy::StartCold, Remedy::LongerWarmUp, Remedy::AcceptMoreUBtc],
        says: Says::Refusal,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The temperature hardly changed between the averages.",
        matters: "The coefficient is a difference of rates divided by a difference of temperatures: with a small one, \
            noise decides.",
        remedy: "Start with a part that was off for an hour, warm it longer, or accept more. In a chamber: check that \
            it is on, and that the part is in it.",
        command: "zerorate calibrate --warmup 20m -o unit.toml",
    },
    Self::Curvature { u_btc_dps_per_c, u_curvature_dps_per_c, wanted_dps_per_c } => Row {
        code: "curvature-unseen",
        text: format_args!(
            "BTC would be uncertain by {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted, \
             {u_curvature_dps_per_c:.4} of it from the curvature that two temperatures cannot show"
        ),
        remedies: &[Remedy::AcceptMoreUBtc, Remedy::AssumeLinear],
    },
    Self::Found { finding: Finding { deviation, btc_dps_per_c, .. }, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: { deviation.code() },
        text: format_args!(
            "{deviation}. It makes BTC wrong by about {btc_dps_per_c:+.4} °/s/°C, so that BTC would be uncertain by \
             {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted"
        ),
        remedies: match deviation {
            Deviation::Step { .. } => &[Remedy::LinearSupply, Remedy::CheckNothingMoved, Remedy::AcceptMoreUBtc],
            Deviation::Sway { .. } => &[Remedy::FixToStillPlatform, Remedy::AcceptMoreUBtc],
            _ => &[Remedy::Chamber, Remedy::CheckNothingMovedSlowly, Remedy::AcceptMoreUBtc],
        },
    },
    Self::Swaying { hz, size_dps, limit_dps } => Row {
        code: "swaying",
        text: format_args!(
            "the part moves: the rate sways by ±{size_dps:.3} °/s once in {:.0} s, more than the {limit_dps} °/s that \
             a result could bear",
            1.0 / hz
        ),
        remedies: &[Remedy::FixToStillPlatform],
    },
    Self::Unsteady { floor_dps, typical_dps, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: "unsteady-offset",
        text: format_args!(
            "the rate is unsteady during the offset average (step 8): it wanders or steps as a flicker floor of \
             {floor_dps:.4} °/s would, where {typical_dps} °/s is typical, so BTC would be uncertain by \
             {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted"
        ),
        remedies: &[Remedy::LinearSupply, Remedy::KeepStill, Remedy::AcceptMoreUBtc],
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "The rate wandered or stepped during the offset average (step 8).",
        matters: "BTC would be more uncertain than was asked for.",
        remedy: "Use a linear supply, keep the platform still, or accept more.",
        command: "zerorate calibrate --max-u-btc 0.01 -o unit.toml",
    },
    Self::Lost { window, lost, samples, limit } => Row {
        code: "lost-samples",
        text: format_args!(
            "{lost} of {} samples were lost during {window}, more than the {} % allowed",
            lost + samples,
            limit * 100.0
        ),
        remedies: &[Remedy::ReadTemperatureLess, Remedy::LargerDivider, Remedy::AllowMoreLoss],
    },
    Self::Overranged { window, count, samples } => Row {
        code: "out-of-range",
        text: format_args!(
            "{count} of {samples} readings during {window} are out of range: the part turns, or its supply or wiring \
             is wrong"
        ),
        remedies: &[Remedy::KeepStill, Remedy::CheckSupplyAndWiring],
        says: Says::Either,
        by: &["capture", "calibrate", "recalibrate", "stream", "correct"],
        seen: "Readings are beyond the range of the part.",
        matters: "It turns faster than it can measure, its supply is wrong, or the line carries errors. Such readings \
            are no measurements.",
        remedy: "Keep it still; check supply and wiring.",
        command: "zerorate probe",
    },
    Self::Frozen { at_s, for_s, both } => Row {
        code: "frozen",
        text: format_args!(
            "the {} frozen: at {at_s:.1} s the code had not changed for {for_s:.1} s, while noise changes every \
             reading",
            if both { "readings are" } else { "rate is" }
        ),
        remedies: &[Remedy::ResetAndCheck],
        says: Says::Either,
        by: &["capture", "calibrate", "recalibrate", "chamber", "stream", "correct", "allan", "imu"],
        seen: "The readings stopped changing, while noise changes every reading of a part that senses.",
        matters: "From there on nothing was measured.",
        remedy: "Reset the part; check its data line and its supply (ADIS16130: SDO is pin 12, the supply pins 11, \
            13, 15). Of a log, use what is before.",
        command: "zerorate probe",
    },
    Self::BitErrors { window, count, samples, still_moves } => Row {
        code: "bit-errors",
        text: format_args!(
            "the line carries bit errors: {count} of {samples} readings during {window} are impossible for the \
             bandwidth of the part{}",
            if still_moves {
                ", and the rest varies more than noise explains, by errors too small to tell from motion or by \
                    motion as well"
            } else {
                ""
            },
        ),
        remedies: match still_moves {
            true => &[Remedy::SlowerClock, Remedy::ShorterCable, Remedy::FixToStillPlatform],
            false => &[Remedy::SlowerClock, Remedy::ShorterCable],
        },
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "Too many readings are impossible for the bandwidth of the part; or some are, and the rest varies too.",
        matters: "A line that breaks these breaks others by amounts that nothing shows.",
        remedy: "Lower the SPI clock, shorten or shield the cable.",
    },
    Self::Stuttering { window, lost, samples, silent_gaps, gaps } => Row {
        code: "data-ready-stutters",
        text: format_args!(
            "{lost} of {} samples were lost during {window}, and in {silent_gaps} of {gaps} gaps no edge of data \
             ready came: data ready stutters, or the host was deaf to it for that long",
            lost + samples
        ),
        remedies: &[Remedy::CheckDataReady],
        says: Says::Either,
        by: &["probe", "capture", "calibrate", "recalibrate", "stream"],
        seen: "Samples were lost, and in the gaps no edge of data ready came.",
        matters: "It is the line that is silent, or the host was deaf to it. The part itself may be well.",
        remedy: "Check the wire of data ready (ADIS16130: RDY, pin 10), its level and its pull-up, and only then what \
            else the host does.",
        command: "zerorate probe",
    },
    Self::TooFew { window, samples, needed } => Row {
        code: "too-few-samples",
        text: format_args!("only {samples} samples during {window}, at least {needed} are needed"),
        remedies: &[Remedy::CheckDataReady, Remedy::SmallerDivider, Remedy::LongerAverage],
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "A window of the procedure holds too few samples.",
        matters: "An average of so few is no measurement.",
        remedy: "Check the data-ready wire; use a smaller divider, or average longer.",
        command: "zerorate probe",
    },
    Self::NoTemperature { window, wrong_edge } => Row {
        code: "no-temperature",
        text: format_args!("no temperature was read during {window}{}", because_of(wrong_edge)),
        remedies: more_temperatures(wrong_edge),
    },
    Self::OneWay { rise_c, fall_c } => Row {
        code: "one-way",
        text: format_args!(
            "the temperature covered {rise_c:.1} °C while it rose and {fall_c:.1} °C while it fell: a cycle covers \
             half of its span at least in each direction"
        ),
        remedies: &[Remedy::HeatAndCool],
        says: Says::Refusal,
        by: &["calibrate", "recalibrate"],
        seen: "With `--method cycle`, the temperature did not cover half of its span while it rose, or while it fell.",
        matters: "A cycle shows hysteresis and lag by going both ways. One way shows neither.",
        remedy: "Heat and cool the part while it is measured; or take the method for a warming alone.",
        command: "zerorate recalibrate unit.arrows --method warmup -o unit.toml",
    },
    Self::StepOrTemperature { finding, u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: { finding.deviation.code() },
        text: format_args!(
            "{}, while the temperature changed as well, and the two cannot be told apart: BTC would be uncertain by \
             {u_btc_dps_per_c:.4} °/s/°C where {wanted_dps_per_c} is wanted",
            finding.deviation
        ),
        remedies: match finding.deviation {
            Deviation::Sway { .. } => &[Remedy::FixToStillPlatform],
            _ => &[Remedy::LinearSupply, Remedy::CheckNothingMoved, Remedy::StartCold],
        },
    },
});

impl Say for Refusal {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        self.text(f)?;
        say_all(self.remedies(), f, names)
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.say(f, Setting::name)
    }
}

impl core::error::Error for Refusal {}
