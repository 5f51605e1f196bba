//! Warnings: the result stands, but the user should know something about it.

use super::deviation::Brief;
use super::{more_temperatures, rows_with_remedies};
use crate::drift_checks::Finding;
use crate::part::Tone;
use crate::plan::EARTH_DPS;
use crate::remedy::{Names, Remedy, Say, Setting, say_all};
use crate::uncertainty::Uncertainty;
use core::fmt;
use zerorate_allan::Says;

/// A warning: the result stands, but the user should know something about it. `Display` says what was seen and what to
/// do, in one line of at most 100 characters with the code before it. `EXPLANATIONS` says why it matters and what else
/// helps. `Display` uses the names of [`Plan`](crate::Plan) for settings, and [`Say`] takes other names.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum Warning {
    /// The Earth's rotation was not subtracted.
    EarthIncluded,
    /// The Earth's rotation was subtracted, and no other constant rotation is accounted for.
    EarthSubtracted { earth_dps: f64 },
    /// A line through two temperatures shows no curvature. The uncertainty of BTC allows for its typical size.
    CurvatureUnseen { u_dps_per_c: f64 },
    /// The temperature moved between the rate average and T3.
    Drifting { drift_c: f64, shift_dps: f64, u_pbc_dps: f64 },
    /// The rate did something that neither noise nor a line over temperature explains.
    Found(Finding),
    /// The rate did more than what was found.
    Restless,
    /// The bias hardly follows the temperature.
    Flat { btc_dps_per_c: f64, typical_dps_per_c: f64 },
    /// The hour as a whole was not checked, because its seconds were not kept or are too few.
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
    /// No temperature was read. A host that listens to the edge before new data finds none.
    NoTemperature { wrong_edge: bool },
    /// A step of the rate was taken out.
    StepTaken { at_s: f64, size_dps: f64, u_dps: f64 },
    /// The platform sways, and the sway was taken out.
    SwayTaken { hz: f64, size_dps: f64 },
    /// The bias follows the temperature late. The curve holds for a temperature at rest.
    Late { lag_s: f64 },
    /// One warming shows one branch of the hysteresis.
    OneBranch { hysteresis_dps: Option<f64> },
    /// The wanted uncertainty was not reached.
    TargetMissed { u_dps: f64, target_dps: f64 },
}

/// Why a result at rest cannot exclude a rotation or a late step of the supply.
macro_rules! still {
    () => {
        "Any other rotation that is constant over the hour, or nearly constant, looks like bias and is part of PBC: \
         nothing at rest can tell the two apart. The same is true of a step of the supply that comes too late to be \
         seen. Such a step has up to 350 mV in the last second of step 8, 200 mV in the last five, and 100 mV before."
    };
}

/// Advice that excludes such a rotation.
macro_rules! mount {
    () => {
        "Mount the part where nothing turns. To be sure, calibrate again with the axis turned over: half of the \
         difference of the two PBC is rotation."
    };
}

rows_with_remedies!(match Warning {
    Self::EarthIncluded => Row {
        code: "earth-included",
        text: format_args!("Earth rotation (up to {EARTH_DPS} °/s) is part of PBC"),
        remedies: &[Remedy::GiveEarth],
        says: Says::Warning,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The Earth turns, and nothing was said about how much of that the axis sees.",
        matters: concat!(
            "Up to ±0.00418 °/s of rotation (F-16) is part of PBC, and its uncertainty does not allow for that. The \
             amount depends on the direction of the axis, and it is more than the uncertainty of PBC. ",
            still!()
        ),
        remedy: concat!(
            "Give the component on the axis, with its sign: for a vertical axis it is 0.00418 °/s times the sine of \
             the latitude. Or accept it, if the part never changes its direction. ",
            mount!()
        ),
        command: "zerorate calibrate --earth-dps 0.0031 -o unit.toml",
    },
    Self::EarthSubtracted { earth_dps } => Row {
        code: "earth-subtracted",
        text: format_args!("{earth_dps:+.5} °/s of Earth rotation was subtracted; check that nothing else turns"),
        remedies: &[],
        says: Says::Warning,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The Earth's rotation (F-16, at most ±0.00418 °/s) was subtracted as you gave it.",
        matters: still!(),
        remedy: concat!("Nothing, if nothing turned. ", mount!()),
    },
    Self::CurvatureUnseen { u_dps_per_c } => Row {
        code: "curvature-unseen",
        text: format_args!("u(BTC) allows {u_dps_per_c:.4} °/s/°C for curvature"),
        remedies: &[Remedy::AssumeLinear],
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "Two temperatures give a line, and a line shows no curvature.",
        matters: "The bias of a typical unit bends over temperature. The standard uncertainty of BTC, u(BTC), allows \
            for a typical curvature. If that makes it larger than was asked for, the measurement is refused.",
        remedy: "Use a method that fits a curve, or measure in a chamber. If this very unit is known to be linear, \
            say so. Or accept more.",
        command: "zerorate calibrate --method warmup -o unit.toml",
    },
    Self::Drifting { drift_c, shift_dps, u_pbc_dps } => Row {
        code: "temperature-drifting",
        text: format_args!("T3 is {drift_c:+.3} °C off step 8: PBC shifts {shift_dps:+.4} °/s"),
        remedies: &[Remedy::SettleLonger, Remedy::ShieldFromDraughts],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The temperature still moved: T3 differs from the mean temperature of step 8, where the rate was \
            averaged.",
        matters: "PBC is off by BTC times that difference. Compare the shift with the uncertainty of PBC.",
        remedy: "Settle longer, and shield the part from draughts.",
        command: "zerorate calibrate --settle 60m -o unit.toml",
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
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The rate did more than noise and temperature explain, in ways that cannot be told apart. In a chamber \
            it did so for too great a share of the time.",
        matters: "The uncertainties may be too small. In a chamber there would be too little rest to learn from.",
        remedy: "Fix the part to a still platform, in a chamber on something that damps its fan; use a linear supply.",
    },
    Self::Flat { btc_dps_per_c, typical_dps_per_c } => Row {
        code: "flat-bias",
        text: format_args!("BTC is only {btc_dps_per_c:+.4} °/s/°C, and {typical_dps_per_c} is typical"),
        remedies: &[Remedy::CheckOverWiderRange],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The bias hardly follows the temperature, far less than a typical unit's.",
        matters: "Such units exist. But a wide hysteresis or a long lag looks the same over a few degrees.",
        remedy: "Check it over a wider range before you rely on it elsewhere than near T3.",
        command: "zerorate chamber two-point -o unit.toml",
    },
    Self::HourUnchecked => Row {
        code: "hour-unchecked",
        text: format_args!("too few seconds were kept to find steps, lag or motion"),
        remedies: &[Remedy::RecordAndRecompute],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The seconds of the hour were not kept, or are too few.",
        matters: "Steps, lag, curvature, hysteresis and slow motion between the averages were not looked for.",
        remedy: "Record the samples, and compute the calibration from the recording.",
        command: "zerorate calibrate --log unit.arrows -o unit.toml",
    },
    Self::ShortAverage { average_s, best_s } => Row {
        code: "short-average",
        text: format_args!("PBC was averaged for {average_s:.1} s, and {best_s:.0} s is best"),
        remedies: &[Remedy::LongerOffset],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "PBC was averaged for less than half of the time at which this part's Allan deviation is least.",
        matters: "A longer average gives a better PBC for a few minutes more.",
        remedy: "Average the offset longer.",
        command: "zerorate calibrate --offset 300s -o unit.toml",
    },
    Self::Aliased { rate_hz, needed_hz } => Row {
        code: "aliased",
        text: format_args!("{rate_hz:.0} samples/s are below twice the bandwidth ({needed_hz:.0} Hz)"),
        remedies: &[Remedy::SmallerDivider],
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber"],
        seen: "The rate is read less often than twice its bandwidth.",
        matters: "Noise from above half the sample rate folds in and cannot be taken out again. The averages are \
            worse than they need to be.",
        remedy: "Read more often, or reduce the bandwidth with the capacitor (F-04).",
        command: "zerorate capture --divider 1 -o rest.arrows",
    },
    Self::Lost { lost, fraction } => Row {
        code: "lost-samples",
        text: format_args!("{lost} samples were lost ({:.4} %); the means leave them out", fraction * 100.0),
        remedies: &[],
        says: Says::Either,
        by: &["probe", "calibrate", "recalibrate", "chamber"],
        seen: "Samples were lost between the part and the program.",
        matters: "The means leave them out, and a few do no harm. Beyond the limit nobody can tell what was in them, \
            and the measurement is refused.",
        remedy: "Read the temperature less often, use a larger divider, raise the SPI clock, check the data-ready \
            wire, or allow more.",
        command: "zerorate calibrate --every-temp 57 -o unit.toml",
    },
    Self::Wandering { floor_dps, typical_dps } => Row {
        code: "wandering-bias",
        text: format_args!(
            "the flicker floor is {floor_dps:.4} °/s, and {typical_dps} is typical; analyse hours of rest"
        ),
        remedies: &[],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The bias wanders more than a typical unit's flicker noise explains.",
        matters: "The uncertainties take this floor into account, so they are larger than for a typical unit. \
            Something that moves slowly looks the same.",
        remedy: "Nothing, if the unit is like that. To find out, compare with an Allan analysis of some hours.",
        command: "zerorate capture --duration 3h --divider 57 -o rest.parquet",
    },
    Self::Impossible { count, fraction } => Row {
        code: "impossible-readings",
        text: format_args!("{count} readings ({:.4} %) are bit errors, left out", fraction * 100.0),
        remedies: &[Remedy::SlowerClock, Remedy::ShorterCable],
        says: Says::Warning,
        by: &["capture", "calibrate", "recalibrate", "stream", "correct"],
        seen: "Some readings differ from their neighbours by more than the bandwidth of the part allows.",
        matters: "These readings are bit errors of the line, and the result leaves them out. Errors too small to tell \
            from motion may have passed.",
        remedy: "Lower the SPI clock, or shorten the cable.",
        command: "zerorate probe --device 'spi:/dev/spidev0.0?rdy=gpiochip0:25&hz=1000000'",
    },
    Self::Resonance { tone: Tone { rms_dps, .. }, rate_hz, divider, .. } => Row {
        code: "resonance",
        text: format_args!(
            "at {rate_hz:.1}/s the resonance adds up to {:.2} °/s{}",
            core::f64::consts::SQRT_2 * rms_dps,
            NoneAt(divider)
        ),
        remedies: &[Remedy::OtherRate],
        says: Says::Warning,
        by: &["probe", "capture", "calibrate"],
        seen: "At this sample rate the part's mechanical resonance folds to nearly zero. Its frequency is known only \
            to half of the last digit that the data sheet prints (ADIS16130: 14.3 kHz ± 50 Hz, F-07).",
        matters: "Near zero the resonance looks like a bias, and averaging may not remove it. The warning says how \
            large that bias may be at this rate.",
        remedy: "Read at another rate. The warning names a divider without this bias, if there is one.",
        command: "zerorate calibrate --divider 57 -o unit.toml",
    },
    Self::Extrapolated { low_c, high_c, temp_min_c, temp_max_c } => Row {
        code: "extrapolated",
        text: format_args!("{low_c:.1} … {high_c:.1} °C leaves the {temp_min_c:.1} … {temp_max_c:.1} °C calibrated"),
        remedies: &[Remedy::WiderSpan],
        says: Says::Warning,
        by: &["correct", "stream", "capture"],
        seen: "The temperature left the range in which the calibration was measured.",
        matters: "The correction is extrapolated there: it goes on as a line or a curve, and nobody measured whether \
            the bias does.",
        remedy: "Calibrate over a wider span.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Self::RestUnjudged => Row {
        code: "rest-unjudged",
        text: format_args!("typical noise or tempco is unknown, so rest was not judged"),
        remedies: &[Remedy::CompletePart],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The file of the part does not state its typical noise or temperature coefficient.",
        matters: "Nobody judged whether the part was at rest, and the uncertainties allow for white noise alone.",
        remedy: "Complete the file of the part (docs/formats/part.md).",
    },
    Self::CurvatureUnknown => Row {
        code: "curvature-unknown",
        text: format_args!("u(BTC) leaves out curvature and hysteresis"),
        remedies: &[Remedy::CompletePart],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The file of the part does not state its typical curvature or hysteresis.",
        matters: "Two temperatures show neither of them, and u(BTC), the standard uncertainty of BTC, allows for \
            neither.",
        remedy: "Complete the file of the part (docs/formats/part.md), or use a method that fits a curve.",
    },
    Self::Noisy { ratio } => Row {
        code: "noisy",
        text: format_args!("the noise is {ratio:.1} times typical: motion, or the supply"),
        remedies: &[Remedy::KeepStill, Remedy::LinearSupply],
        says: Says::Either,
        by: &["probe", "calibrate", "recalibrate"],
        seen: "The white noise is far above a typical part's.",
        matters: "The part shakes, or its supply is not linear. It does not measure its bias alone.",
        remedy: "Keep the part still, remove the vibration, use a linear supply.",
    },
    Self::Quiet { ratio } => Row {
        code: "quiet",
        text: format_args!("the noise is {ratio:.2} times typical"),
        remedies: &[Remedy::ResetAndCheck],
        says: Says::Warning,
        by: &["probe"],
        seen: "The white noise is far below a typical part's.",
        matters: "A part that senses is noisier. The readings may come from a part without power, or from another \
            channel.",
        remedy: "Reset the part, and check its data wire and its supply.",
        command: "zerorate probe",
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
        says: Says::Warning,
        by: &["probe"],
        seen: "Samples do not come as often as the configuration says.",
        matters: "The part has another clock, edges are missed, or one edge is taken for two.",
        remedy: "Check the data-ready wire, its level and its pull-up, and only then what else the host does. Raise \
            the SPI clock. If the part has another clock, say so (mclk= in the address).",
    },
    Self::NoTemperature { wrong_edge } => Row {
        code: "no-temperature",
        text: format_args!("{}", if wrong_edge { "two edges per sample" } else { "no temperature was read" }),
        remedies: more_temperatures(wrong_edge),
        says: Says::Either,
        by: &["probe", "calibrate", "recalibrate", "chamber"],
        seen: "No temperature was read, or a log has none in any row. If data ready has two edges for each sample, \
            the program listened to the one that comes before the data.",
        matters: "Coefficient and correction need a temperature.",
        remedy: "If data ready was heard twice for each sample, use its other edge (edge=rising or edge=falling in \
            the device's address). Otherwise read the temperature more often.",
        command: "zerorate capture --every-temp 1 -o rest.arrows",
    },
    Self::StepTaken { at_s, size_dps, u_dps } => Row {
        code: "step",
        text: format_args!(
            "rate stepped {size_dps:+.4} ± {:.4} °/s at {at_s:.0} s, taken out",
            Uncertainty::FACTOR * u_dps
        ),
        remedies: &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
    },
    Self::SwayTaken { hz, size_dps } => Row {
        code: "swaying",
        text: format_args!("the part sways ±{size_dps:.4} °/s once in {:.0} s, taken out", 1.0 / hz),
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
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The part only warmed, or only cooled.",
        matters: "One direction shows one branch of the hysteresis. The bias on the other branch differs, and the \
            uncertainty does not allow for that. The warning says by how much for a typical unit, if that is known.",
        remedy: "Heat and cool the part, by hand or in a chamber.",
        command: "zerorate calibrate --method cycle -o unit.toml",
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
        says: Says::Warning,
        by: &["calibrate"],
        seen: "The wanted uncertainty was not reached. The warning gives the standard uncertainty of the \
            correction (rms over the temperatures seen), and the one that was asked for.",
        matters: "The part's own flicker and random walk do not allow it in that time, however long the average.",
        remedy: "Ask for what the part can give, or measure in a chamber.",
    },
});

impl Say for Warning {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        self.text(f)?;
        say_all(self.remedies().get(..1).unwrap_or_default(), f, names)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.say(f, Setting::name)
    }
}

/// Names a divider that does not fold a resonance, if there is one.
struct NoneAt(Option<u16>);

impl fmt::Display for NoneAt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.map_or(Ok(()), |divider| write!(f, " (none at {divider})"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::drift_checks::Deviation;
    use alloc::format;
    use alloc::string::ToString;
    use alloc::vec::Vec;

    /// The options of the command line.
    fn option(setting: Setting) -> &'static str {
        match setting {
            Setting::Earth => "--earth-dps",
            Setting::AssumeLinear => "--assume-linear",
            Setting::Settle => "--settle",
            Setting::Offset => "--offset",
            Setting::Divider => "--divider",
            Setting::Target => "--target-dph",
            Setting::EveryTemp => "--every-temp",
            Setting::Edge => "edge=rising or edge=falling in --device",
            other => panic!("what is the option of {other:?}?"),
        }
    }

    fn found(deviation: Deviation) -> Warning {
        Warning::Found(Finding { deviation, pbc_dps: -0.0123, btc_dps_per_c: 0.0123 })
    }

    fn typical() -> Vec<Warning> {
        let tone = Tone { hz: 14_300.0, tolerance_hz: 50.0, rms_dps: 0.085 };
        [
            Warning::EarthIncluded,
            Warning::EarthSubtracted { earth_dps: 0.003_21 },
            Warning::CurvatureUnseen { u_dps_per_c: 0.002_34 },
            Warning::Drifting { drift_c: 0.123, shift_dps: -0.012_34, u_pbc_dps: 0.0045 },
            found(Deviation::Step { at_s: 2492.0, size_dps: -0.0384, supply_mv: Some(192.0) }),
            found(Deviation::Curvature { dps_per_c2: -0.001_23 }),
            found(Deviation::Lag { lag_s: 123.0 }),
            found(Deviation::Hysteresis { width_c: 12.3 }),
            found(Deviation::Sway { hz: 0.000_35, size_dps: 0.0567 }),
            Warning::Restless,
            Warning::Flat { btc_dps_per_c: -0.0012, typical_dps_per_c: 0.04 },
            Warning::HourUnchecked,
            Warning::ShortAverage { average_s: 60.0, best_s: 300.0 },
            Warning::Aliased { rate_hz: 111.6, needed_hz: 600.0 },
            Warning::Lost { lost: 12_345, fraction: 0.001_234 },
            Warning::Wandering { floor_dps: 0.0123, typical_dps: 0.0016 },
            Warning::Impossible { count: 12_345, fraction: 0.001_234 },
            Warning::Resonance { tone, folded_hz: 12.3, rate_hz: 2846.3, divider: Some(57) },
            Warning::Resonance { tone, folded_hz: 12.3, rate_hz: 2846.3, divider: None },
            Warning::Extrapolated { low_c: -39.0, high_c: 84.0, temp_min_c: 25.0, temp_max_c: 31.0 },
            Warning::RestUnjudged,
            Warning::CurvatureUnknown,
            Warning::Noisy { ratio: 12.3 },
            Warning::Quiet { ratio: 0.05 },
            Warning::Losing { lost: 12_345 },
            Warning::RateOff { rate_hz: 2846.3, nominal_hz: 5692.6 },
            Warning::NoTemperature { wrong_edge: true },
            Warning::NoTemperature { wrong_edge: false },
            Warning::StepTaken { at_s: 2492.0, size_dps: -0.0384, u_dps: 0.0012 },
            Warning::SwayTaken { hz: 0.000_35, size_dps: 0.0567 },
            Warning::Late { lag_s: 123.0 },
            Warning::OneBranch { hysteresis_dps: Some(0.0123) },
            Warning::OneBranch { hysteresis_dps: None },
            Warning::TargetMissed { u_dps: 0.0034, target_dps: 0.0003 },
        ]
        .into()
    }

    #[test]
    fn a_warning_is_one_line_of_at_most_100_characters() {
        let lines: Vec<_> = typical().iter().map(|one| format!("{}: {}", one.code(), one.with(option))).collect();
        let long: Vec<_> = lines.iter().filter(|line| line.chars().count() > 100 || line.contains('\n')).collect();
        assert!(long.is_empty(), "{long:#?}");
        let untold = |code: &&str| !typical().iter().any(|one| one.code() == *code);
        assert_eq!(Warning::codes().find(untold), None, "a warning of this code belongs into the test");
        let earth = typical()[0].to_string();
        assert!(earth.ends_with("is part of PBC; give its component (earth_dps)"), "{earth}");
    }
}
