//! Warnings: the result stands, but there is something to know.

use super::{because_of, more_temperatures, rows_with_remedies};
use crate::drift_checks::{Deviation, Finding};
use crate::part::Tone;
use crate::plan::EARTH_DPS;
use crate::remedy::{Names, Remedy, Say, Setting, say_all};
use crate::uncertainty::Uncertainty;
use alloc::format;
use core::fmt;
use zerorate_allan::Says;

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

rows_with_remedies!(match Warning {
    Self::EarthIncluded => Row {
        code: "earth-included",
        text: format_args!(
            "the Earth's rotation is inside PBC and not in its uncertainty: up to ±{EARTH_DPS} °/s, by the direction \
             of the axis. {STILL}"
        ),
        remedies: &[Remedy::GiveEarth],
        says: Says::Warning,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The Earth turns, and nothing was said about how much of that the axis sees.",
        matters: "Up to 0.00418 °/s of rotation (F-16) are inside PBC, more than the uncertainty of PBC. They come \
            and go as the axis is turned.",
        remedy: "Give the component on the axis: 0.00418 times the sine of the latitude for a vertical axis, with its \
            sign. Or accept it, if the part never changes its direction.",
        command: "zerorate calibrate --earth-dps 0.0031 -o unit.toml",
    },
    Self::EarthSubtracted { earth_dps } => Row {
        code: "earth-subtracted",
        text: format_args!(
            "{earth_dps:+.5} °/s were subtracted for the Earth's rotation (it is ±{EARTH_DPS} °/s at most). {STILL}"
        ),
        remedies: &[],
        says: Says::Warning,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The Earth's rotation was subtracted as you gave it.",
        matters: "Any other rotation that is constant during the measurement is still inside PBC: nothing at rest can \
            tell it from bias.",
        remedy: "Nothing, if nothing turned. To be sure, calibrate again with the axis turned over: half of the \
            difference of the two PBC is rotation.",
    },
    Self::CurvatureUnseen { u_dps_per_c } => Row {
        code: "curvature-unseen",
        text: format_args!(
            "two temperatures show no curvature: {u_dps_per_c:.5} °/s/°C in the uncertainty of BTC stands for a \
             typical unit's"
        ),
        remedies: &[Remedy::AssumeLinear],
        says: Says::Either,
        by: &["calibrate", "recalibrate"],
        seen: "Two temperatures give a line, and a line shows no curvature.",
        matters: "A typical unit bends. The uncertainty of BTC holds that; where it is then larger than was asked \
            for, the measurement is refused.",
        remedy: "Use a method that bends, or measure in a chamber. If this very unit is known to be linear, say so. \
            Or accept more.",
        command: "zerorate calibrate --method warmup -o unit.toml",
    },
    Self::Drifting { drift_c, shift_dps, u_pbc_dps } => Row {
        code: "temperature-drifting",
        text: format_args!(
            "the temperature still drifts: T3 is {drift_c:+.3} °C off the mean of step 8, which shifts PBC by \
             {shift_dps:+.5} °/s (u = {u_pbc_dps:.5})"
        ),
        remedies: &[Remedy::SettleLonger, Remedy::ShieldFromDraughts],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The temperature still moved between the average of the rate and T3.",
        matters: "PBC is off by BTC times that difference; the text says by how much.",
        remedy: "Settle longer, and shield the part from draughts.",
        command: "zerorate calibrate --settle 60m -o unit.toml",
    },
    Self::Found(Finding { deviation, pbc_dps, btc_dps_per_c }) => Row {
        code: { deviation.code() },
        text: format_args!(
            "{deviation}. It makes PBC wrong by about {pbc_dps:+.4} °/s and BTC by about {btc_dps_per_c:+.4} °/s/°C, \
             which is in their uncertainties"
        ),
        remedies: deviation.remedies(),
    },
    Self::Restless => Row {
        code: "restless",
        text: format_args!(
            "the rate moves in more ways than could be told apart, so the uncertainties may be too small"
        ),
        remedies: &[Remedy::FixToStillPlatform, Remedy::LinearSupply],
        says: Says::Either,
        by: &["calibrate", "recalibrate", "chamber"],
        seen: "The rate did more than noise and temperature explain, in ways that cannot be told apart; in a chamber, \
            for too great a share of the time.",
        matters: "The uncertainties may be too small. In a chamber there would be too little rest to learn from.",
        remedy: "Fix the part to a still platform, in a chamber on something that damps its fan; use a linear supply.",
    },
    Self::Flat { btc_dps_per_c, typical_dps_per_c } => Row {
        code: "flat-bias",
        text: format_args!(
            "the bias hardly follows the temperature: BTC is {btc_dps_per_c:+.4} °/s/°C where {typical_dps_per_c} is \
             typical; a wide hysteresis or a long lag looks the same over so few degrees"
        ),
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
        text: format_args!(
            "steps, lag, curvature, hysteresis and slow motion between the averages were not looked for, since the \
             seconds of the hour were not kept or are too few"
        ),
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
        text: format_args!(
            "PBC was averaged for {average_s:.1} s, less than half of the {best_s:.0} s where this part's Allan \
             deviation is least"
        ),
        remedies: &[Remedy::LongerOffset],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "PBC was averaged for less than half of the time at which this part's Allan deviation is least.",
        matters: "A longer average would have given a better PBC for the price of minutes.",
        remedy: "Average the offset longer.",
        command: "zerorate calibrate --offset 300s -o unit.toml",
    },
    Self::Aliased { rate_hz, needed_hz } => Row {
        code: "aliased",
        text: format_args!(
            "{rate_hz:.0} rate samples a second are below twice the bandwidth ({needed_hz:.0} Hz): noise folds in"
        ),
        remedies: &[Remedy::SmallerDivider],
        says: Says::Warning,
        by: &["probe", "capture", "calibrate", "chamber"],
        seen: "The rate is read less often than twice its bandwidth.",
        matters: "Noise from above half the rate folds in and cannot be taken out again: the averages are worse than \
            they need be.",
        remedy: "Read more often, or take bandwidth away with the capacitor (F-04).",
        command: "zerorate capture --divider 1 -o rest.arrows",
    },
    Self::Lost { lost, fraction } => Row {
        code: "lost-samples",
        text: format_args!("{lost} samples were lost ({:.4} %); the means leave them out", fraction * 100.0),
        remedies: &[],
        says: Says::Either,
        by: &["probe", "calibrate", "recalibrate", "chamber"],
        seen: "Samples were lost between the part and the program.",
        matters: "Means leave them out, and a few do no harm. Beyond the limit nobody can tell what was in them, and \
            the measurement is refused.",
        remedy: "Read the temperature less often, use a larger divider, raise the SPI clock, or allow more.",
        command: "zerorate calibrate --every-temp 57 -o unit.toml",
    },
    Self::Wandering { floor_dps, typical_dps } => Row {
        code: "wandering-bias",
        text: format_args!(
            "the bias wanders more than a typical unit's: a flicker floor of {floor_dps:.4} °/s where {typical_dps} \
             °/s is typical; the uncertainties follow it"
        ),
        remedies: &[],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The bias wanders more than a typical unit's flicker noise explains.",
        matters: "The uncertainties follow it and are larger than those of a typical unit. Something that moves \
            slowly looks the same.",
        remedy: "Nothing, if the unit is like that: compare with an Allan analysis of some hours.",
        command: "zerorate capture --duration 3h --divider 57 -o rest.parquet",
    },
    Self::Impossible { count, fraction } => Row {
        code: "impossible-readings",
        text: format_args!(
            "{count} readings ({:.4} %) are impossible for the bandwidth of the part, as after bit errors, and are \
             left out; errors too small to tell from motion may have passed",
            fraction * 100.0
        ),
        remedies: &[Remedy::SlowerClock, Remedy::ShorterCable],
        says: Says::Warning,
        by: &["capture", "calibrate", "recalibrate", "stream", "correct"],
        seen: "Some readings differ from their neighbours by more than the bandwidth of the part allows.",
        matters: "They are bit errors on the line, and are left out. Errors too small to tell from motion may have \
            passed.",
        remedy: "Lower the SPI clock, or shorten the cable.",
        command: "zerorate probe --device 'spi:/dev/spidev0.0?rdy=gpiochip0:25&hz=1000000'",
    },
    Self::Resonance { tone: Tone { hz, tolerance_hz, rms_dps }, folded_hz, rate_hz, divider } => Row {
        code: "resonance",
        text: format_args!(
            "at {rate_hz:.1} samples a second the resonance of about {:.1} kHz (known to ±{tolerance_hz:.0} Hz) \
             appears at {folded_hz:.1} Hz, where averaging may not remove it: up to {:.2} °/s of false bias{}",
            hz / 1e3,
            core::f64::consts::SQRT_2 * rms_dps,
            divider.map(|divider| format!("; a divider of {divider} is good")).unwrap_or_default()
        ),
        remedies: &[Remedy::OtherRate],
        says: Says::Warning,
        by: &["probe", "capture", "calibrate"],
        seen: "At this rate of reading the part's mechanical resonance folds to nearly zero.",
        matters: "There it looks like a bias that no average removes.",
        remedy: "Read at another rate: the text names a divider that is good.",
        command: "zerorate calibrate --divider 57 -o unit.toml",
    },
    Self::Extrapolated { low_c, high_c, temp_min_c, temp_max_c } => Row {
        code: "extrapolated",
        text: format_args!(
            "{low_c:.1} … {high_c:.1} °C leaves the {temp_min_c:.1} … {temp_max_c:.1} °C of the calibration: the \
             correction is extrapolated"
        ),
        remedies: &[Remedy::WiderSpan],
        says: Says::Warning,
        by: &["correct", "stream"],
        seen: "The temperature left the range in which the calibration was measured.",
        matters: "The correction goes on as a line or a curve, and nobody measured whether the part does.",
        remedy: "Calibrate over a wider span.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Self::RestUnjudged => Row {
        code: "rest-unjudged",
        text: format_args!(
            "the part's typical noise or temperature coefficient is not known: whether it was at rest was not judged, \
             and the uncertainties hold the white noise alone"
        ),
        remedies: &[Remedy::CompletePart],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The file of the part does not state its typical noise or temperature coefficient.",
        matters: "Whether the part was at rest was not judged, and the uncertainties hold the white noise alone.",
        remedy: "Complete the file of the part (docs/formats/part.md).",
    },
    Self::CurvatureUnknown => Row {
        code: "curvature-unknown",
        text: format_args!(
            "the part's typical curvature and hysteresis are not known: the uncertainty of BTC holds nothing of what \
             two temperatures cannot show"
        ),
        remedies: &[Remedy::CompletePart],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The file of the part does not state its typical curvature or hysteresis.",
        matters: "The uncertainty of BTC holds nothing of what two temperatures cannot show.",
        remedy: "Complete the file of the part (docs/formats/part.md), or use a method that bends.",
    },
    Self::Noisy { ratio } => Row {
        code: "noisy",
        text: format_args!(
            "the noise is {ratio:.1} times the typical one: the part moves, or its supply is not linear"
        ),
        remedies: &[Remedy::KeepStill, Remedy::LinearSupply],
        says: Says::Either,
        by: &["probe", "calibrate", "recalibrate"],
        seen: "The white noise is far above a typical part's.",
        matters: "The part shakes, or its supply is not linear; what it measures is not its bias alone.",
        remedy: "Keep the part still, remove the vibration, use a linear supply.",
    },
    Self::Quiet { ratio } => Row {
        code: "quiet",
        text: format_args!("the noise is {ratio:.2} times the typical one; a part that really senses is noisier"),
        remedies: &[Remedy::ResetAndCheck],
        says: Says::Warning,
        by: &["probe"],
        seen: "The white noise is far below a typical part's.",
        matters: "A part that senses is noisier: the readings may be those of a part that is not powered, or of \
            another channel.",
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
        text: format_args!("{rate_hz:.1} samples a second where {nominal_hz:.1} are expected"),
        remedies: &[Remedy::CheckDataReady, Remedy::FasterClock],
        says: Says::Warning,
        by: &["probe"],
        seen: "Samples do not come as often as the configuration says.",
        matters: "The clock is another, edges are missed, or one edge is taken for two.",
        remedy: "Check the data-ready wire; raise the SPI clock. A part with another clock: say so (mclk= in the \
            address).",
    },
    Self::NoTemperature { wrong_edge } => Row {
        code: "no-temperature",
        text: format_args!("no temperature was read{}", because_of(wrong_edge)),
        remedies: more_temperatures(wrong_edge),
        says: Says::Either,
        by: &["probe", "calibrate", "recalibrate", "chamber"],
        seen: "No temperature was read; or a log has none in any row.",
        matters: "Without it there is no coefficient, and no correction.",
        remedy: "Where data ready was heard twice for each sample, listen to its other edge (edge=rising in the \
            device's address). Otherwise read the temperature more often.",
        command: "zerorate capture --every-temp 1 -o rest.arrows",
    },
    Self::StepTaken { at_s, size_dps, u_dps } => Row {
        code: "step",
        text: format_args!(
            "the rate stepped by {size_dps:+.4} ± {:.4} °/s at {at_s:.0} s; the step is taken out and in the \
             uncertainty, and the correction is that after it",
            Uncertainty::FACTOR * u_dps
        ),
        remedies: &[Remedy::LinearSupply, Remedy::CheckNothingMoved],
    },
    Self::SwayTaken { hz, size_dps } => Row {
        code: "swaying",
        text: format_args!(
            "{}. The sway is taken out, and what is not known of it is in the uncertainty",
            Deviation::Sway { hz, size_dps }
        ),
        remedies: &[Remedy::FixToStillPlatform],
    },
    Self::Late { lag_s } => Row {
        code: "lagging",
        text: format_args!(
            "the bias follows the temperature sensor about {lag_s:.0} s late; the curve is that in balance, and a \
             temperature that changes by 1 °C a minute shifts the bias by what {:.1} °C do",
            lag_s / 60.0
        ),
        remedies: &[Remedy::WarmMoreSlowly],
    },
    Self::OneBranch { hysteresis_dps: Some(half_dps) } => Row {
        code: "one-branch",
        text: format_args!(
            "one warming shows one branch of the hysteresis: after cooling the bias of a typical unit is {:.4} °/s \
             off, which is not in the uncertainty",
            2.0 * half_dps
        ),
        remedies: &[Remedy::HeatAndCool],
        says: Says::Warning,
        by: &["calibrate", "recalibrate"],
        seen: "The part only warmed, or only cooled.",
        matters: "That shows one branch of the hysteresis. On the other branch the bias is another; that is not in \
            the uncertainty.",
        remedy: "Heat and cool the part, by hand or in a chamber.",
        command: "zerorate calibrate --method cycle -o unit.toml",
    },
    Self::OneBranch { hysteresis_dps: None } => Row {
        code: "one-branch",
        text: format_args!(
            "one warming shows one branch of the hysteresis: what cooling does is not known and not in the uncertainty"
        ),
        remedies: &[Remedy::HeatAndCool],
    },
    Self::TargetMissed { u_dps, target_dps } => Row {
        code: "target-missed",
        text: format_args!(
            "the correction is known to {:.1} °/h (standard uncertainty, rms over the temperatures seen), not to the \
             {:.1} °/h that were asked for: the part's own flicker and random walk do not allow it",
            3600.0 * u_dps,
            3600.0 * target_dps
        ),
        remedies: &[Remedy::GiveUpTarget, Remedy::Chamber],
        says: Says::Warning,
        by: &["calibrate"],
        seen: "The uncertainty that was asked for was not reached.",
        matters: "The part's own flicker and random walk do not allow it in that time, however long one averages.",
        remedy: "Ask for what the part can give, or measure in a chamber.",
    },
});

impl Say for Warning {
    fn say(&self, f: &mut fmt::Formatter<'_>, names: Names) -> fmt::Result {
        self.text(f)?;
        say_all(self.remedies(), f, names)
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.say(f, Setting::name)
    }
}

/// What no measurement at rest can see, and what it would take.
const STILL: &str = "Any other rotation that is constant over the hour, or nearly, looks like bias and is inside PBC, \
    and so is a step of the supply that comes too late to be seen (up to 350 mV in the last second of step 8, 200 mV \
    in the last five, 100 mV before): mount the part where nothing turns; to know, calibrate again with its axis \
    turned over: half of the difference of the two PBC is rotation";
