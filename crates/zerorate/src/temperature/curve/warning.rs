//! Warnings and refusals of a bias over temperature.

use super::{LEAST_SPAN_C, LogCurve, LogMeans, MOST_MOTION};
use crate::temperature::{Block, ThermalError};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use zerorate_allan::rows;

/// A warning about the curve of an axis.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "the variants say what their fields are")]
pub enum CurveWarning {
    /// The bias does not depend on the temperature, as far as the record can tell.
    Unrelated,
    /// The thermometer reads in steps of this size, °C, which were taken as intervals.
    CoarseThermometer { step_c: f64 },
    /// The thermometer stuck for this time, s, which was left out.
    StuckThermometer { stuck_s: f64 },
    /// The noise of the thermometer was averaged over this time, s.
    NoisyThermometer { smoothed_s: f64 },
    /// The thermometer lags the sensor by this time, s.
    LateThermometer { late_s: f64 },
    /// The best lag would be about the longest that is tried, s, so the curve has no lag.
    LongLag { longest_s: f64 },
    /// A lag of this size, s, or a draught that only the thermometer feels explains the logs. The curve has no lag.
    LagOrDraught { lag_s: f64 },
    /// The sensor moved `times` times, first from `from_s` of a log and last until `to_s` of a log. This was left out.
    Moved { from_s: f64, to_s: f64, times: usize },
    /// The logs have one direction of the temperature, so the hysteresis is not known.
    OneDirection,
    /// At the end, the bias still lagged: a change of `unsettled`, in `unit`, was to come.
    StillFollowing { unsettled: f64, unit: &'static str },
    /// Steps of the level were removed: their number, and the size of the largest in `unit`.
    Jumped { jumps: usize, largest: f64, unit: &'static str },
    /// A polynomial of order 3 differs from the curve by up to `left`, in `unit`.
    BeyondCubic { left: f64, unit: &'static str },
}

rows!(match CurveWarning as Display {
    Self::Unrelated => Row {
        code: "temperature-unrelated",
        text: format_args!("the bias follows this temperature at no lag; is it the sensor's own?"),
    },
    Self::CoarseThermometer { step_c } =>
        Row { code: "temperature-coarse", text: format_args!("steps of {step_c:.2} °C were taken as intervals") },
    Self::StuckThermometer { stuck_s } => Row {
        code: "temperature-stuck",
        text: format_args!("the thermometer stood still for {stuck_s:.0} s, which is left out"),
    },
    Self::NoisyThermometer { smoothed_s } => Row {
        code: "temperature-noisy",
        text: format_args!("the thermometer is noisy and was averaged over {smoothed_s:.0} s; warm slowly"),
    },
    Self::LateThermometer { late_s } => Row {
        code: "temperature-late",
        text: format_args!("the thermometer lags the sensor by some {late_s:.0} s; use one nearer to it"),
    },
    Self::LongLag { longest_s } => Row {
        code: "lag-doubtful",
        text: format_args!("only a lag of about {longest_s:.0} s would fit, and none was taken; see the residuals"),
    },
    Self::LagOrDraught { lag_s } => Row {
        code: "lag-doubtful",
        text: format_args!("a lag of {lag_s:.0} s or a draught at the thermometer; the band holds both"),
    },
    Self::Moved { from_s, to_s, times } => Row {
        code: "motion",
        text: format_args!("the sensor moves from {from_s:.0} s to {to_s:.0} s ({times} times), which is left out"),
    },
    Self::OneDirection => Row {
        code: "one-branch",
        text: format_args!("the logs only warm or only cool, so hysteresis is not in the band"),
    },
    Self::StillFollowing { unsettled, unit } => Row {
        code: "still-following",
        text: format_args!("{unsettled:.4} {unit} of the bias was still to come at the end; let it settle"),
    },
    Self::Jumped { jumps, largest, unit } =>
        Row { code: "step", text: format_args!("{jumps} jumps of up to {largest:.4} {unit} were taken out") },
    Self::BeyondCubic { left, unit } =>
        Row { code: "beyond-cubic", text: format_args!("a polynomial of order 3 leaves up to {left:.4} {unit}") },
});

impl CurveWarning {
    /// The warning as scripts read it: `code: text`.
    #[must_use]
    pub fn coded(&self) -> String {
        format!("{}: {self}", self.code())
    }
}

/// Difference of the log evidence below which nothing speaks for a dependence on temperature.
const NO_EVIDENCE: f64 = 2.0;
/// Ratio of the change that is still to come to the uncertainty above which there is a warning.
const UNSETTLED: f64 = 3.0;
/// Ratio to the uncertainty, and share of the bias's span, above which a difference from a cubic gives a warning.
const LEFT: (f64, f64) = (1.0, 0.01);

impl LogCurve {
    /// The warnings about the curve, which comes from these logs. `unit` is the unit of the samples.
    #[must_use]
    pub fn warnings(&self, logs: &[LogMeans], unit: &'static str) -> Vec<CurveWarning> {
        let (low_c, high_c) = self.span_c();
        let middle_c = (low_c + high_c) / 2.0;
        let (u, left, unsettled) = (self.u_at(middle_c), self.cubic(middle_c).left, self.unsettled.abs());
        let thermometers = || logs.iter().map(LogMeans::thermometer);
        let stuck_s: f64 = thermometers().map(|of| of.stuck_s).sum();
        let smoothed_s = thermometers().map(|of| of.smoothed_s).fold(0.0, f64::max);
        let late_s = self.thermometer_late_s;
        let coarse = thermometers().filter_map(|of| of.coarse_step_c).reduce(f64::max);
        let moving: Vec<(f64, f64)> = logs.iter().flat_map(|log| log.moving_s().to_vec()).collect();
        let ends = moving.first().zip(moving.last());
        let (jumps, largest) = (self.steps.len(), self.steps.iter().map(|step| step.size.abs()).fold(0.0, f64::max));
        let all = [
            (self.log_odds < NO_EVIDENCE).then_some(CurveWarning::Unrelated),
            coarse.map(|step_c| CurveWarning::CoarseThermometer { step_c }),
            (stuck_s > 0.0).then_some(CurveWarning::StuckThermometer { stuck_s }),
            (smoothed_s > 0.0 && late_s == 0.0 && self.lag_or_draught_s.is_none())
                .then_some(CurveWarning::NoisyThermometer { smoothed_s }),
            (late_s > 0.0).then_some(CurveWarning::LateThermometer { late_s }),
            self.long_lag_s
                .filter(|_| self.lag_or_draught_s.is_none())
                .map(|longest_s| CurveWarning::LongLag { longest_s }),
            self.lag_or_draught_s.map(|lag_s| CurveWarning::LagOrDraught { lag_s }),
            ends.map(|(first, last)| CurveWarning::Moved { from_s: first.0, to_s: last.1, times: moving.len() }),
            (jumps > 0).then_some(CurveWarning::Jumped { jumps, largest, unit }),
            (unsettled > UNSETTLED * u).then_some(CurveWarning::StillFollowing { unsettled, unit }),
            self.hysteresis.is_none().then_some(CurveWarning::OneDirection),
            (left > LEFT.0 * u && left > LEFT.1 * self.span.before)
                .then_some(CurveWarning::BeyondCubic { left, unit }),
        ];
        all.into_iter().flatten().collect()
    }
}

/// Checks that the axes of a sensor, each with its logs, can give curves.
///
/// # Errors
/// Returns a refusal if the temperature spans too little, or the sensor moves too long.
pub fn check<'a>(axes: impl Iterator<Item = &'a [LogMeans]> + Clone) -> Result<(), CurveRefusal> {
    let logs = || axes.clone().flatten();
    let ends = |(low, high): (f64, f64), block: &Block| (low.min(block.temp_c), high.max(block.temp_c));
    let (low_c, high_c) = logs().flat_map(LogMeans::blocks).fold((f64::MAX, f64::MIN), ends);
    if low_c <= high_c && high_c - low_c < LEAST_SPAN_C {
        let ends_s = logs().flat_map(LogMeans::blocks).map(|block| block.start_s + block.length_s);
        let length_s = ends_s.fold(0.0, f64::max);
        return Err(CurveRefusal::SmallSpan { low_c, high_c, length_s });
    }
    let share = logs().map(LogMeans::moving_share).fold(0.0, f64::max);
    if share > MOST_MOTION { Err(CurveRefusal::Moves { share }) } else { Ok(()) }
}

/// The reason why logs give no curve.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs, reason = "temperatures, °C, shares and numbers of means")]
pub enum CurveRefusal {
    /// The temperature spans too little.
    SmallSpan { low_c: f64, high_c: f64, length_s: f64 },
    /// The sensor moves for too large a share of the logs.
    Moves { share: f64 },
    /// The logs are too short, or an axis is constant for most of them.
    TooShort { axis: String, blocks: usize, needed: usize },
    /// No model explains an axis.
    NoCurve { axis: String },
    /// The bias is more uncertain than was asked for.
    TooUncertain { axis: String, u_dps: f64, at_c: f64, wanted_dps: f64 },
}

rows!(match CurveRefusal as Display {
    Self::SmallSpan { low_c, high_c, length_s } => Row {
        code: "small-span",
        text: format_args!(
            "the temperature goes from {low_c:.1} to {high_c:.1} °C in {length_s:.1} s, and a curve needs at least \
             5 °C; warm or cool it further"
        ),
    },
    Self::Moves { share } => Row {
        code: "moving",
        text: format_args!(
            "the sensor moves for {:.0} % of the log; record it at rest, or choose a part in which it rests",
            100.0 * share
        ),
    },
    Self::TooShort { ref axis, blocks, needed } => Row {
        code: "too-few-samples",
        text: format_args!("axis {axis} gives {blocks} means of a second or more, and a curve needs {needed}"),
    },
    Self::NoCurve { ref axis } => Row {
        code: "no-curve",
        text: format_args!("axis {axis} does not vary, or no model explains it; choose the others, if they do"),
    },
    Self::TooUncertain { ref axis, u_dps, at_c, wanted_dps } => Row {
        code: "uncertain",
        text: format_args!(
            "the bias of {axis} is uncertain by {u_dps:.2e} °/s at {at_c:.1} °C (standard), above the limit of \
             {wanted_dps}; warm it further or more slowly, let it settle, give more logs, or accept more"
        ),
    },
});

impl CurveRefusal {
    /// Makes the refusal of an axis from its error.
    #[must_use]
    pub fn of_axis(error: ThermalError, axis: &str) -> Self {
        let axis = axis.into();
        match error {
            ThermalError::TooFew { blocks, needed } => Self::TooShort { axis, blocks, needed },
            ThermalError::Degenerate => Self::NoCurve { axis },
        }
    }
}
