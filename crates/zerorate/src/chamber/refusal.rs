//! Refusals of a measurement in a chamber: the reasons why it ends without a result.

use super::plan::REACHED_C;
use super::states::ChamberState;
use crate::notice::{Refusal, because_of};
use crate::temperature::ThermalError;
use alloc::format;
use alloc::string::String;
use core::fmt;
use zerorate_allan::rows;

/// A refusal of a measurement in a chamber. Steps count from 1. `Display` says what was seen and what to do.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum ChamberRefusal {
    /// The part stopped converting.
    Frozen { at_s: f64, for_s: f64 },
    /// The temperature of the part was not read.
    NoTemperature { step: usize, after_s: f64, wrong_edge: bool },
    /// Readings were beyond the range, and no second of `after_s` seconds had a valid rate of every axis.
    OutOfRange { step: usize, after_s: f64 },
    /// No reading came for `for_s` seconds.
    Silent { step: usize, for_s: f64 },
    /// More samples were lost than the limit allows.
    Lost { lost: u64, samples: u64, limit: f64 },
    /// The part's temperature did not come to rest near the set point in time. `air_c` is the chamber's last reading.
    NotSettled { step: usize, set_c: f64, temp_c: f64, drift_c_per_min: f64, most_c_per_min: f64, air_c: Option<f64> },
    /// The air was far from the set point for too long.
    NotReached { step: usize, set_c: f64, air_c: f64, after_s: f64 },
    /// The air went beyond all temperatures of the plan by more than the allowed overshoot.
    Overshoot { step: usize, air_c: f64, low_c: f64, high_c: f64 },
    /// The air is at a temperature that may harm the part.
    BeyondPart { step: usize, air_c: f64, low_c: f64, high_c: f64 },
    /// The average of a soak point was disturbed too often.
    Disturbed { step: usize, times: u32, why: Disturbance },
    /// The temperature of the part hardly changed.
    Span { span_c: f64, least_c: f64 },
    /// The uncertainty of BTC is above the limit.
    Uncertain { u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// The record does not determine a curve.
    NoCurve(ThermalError),
    /// The slow base motion is larger than the limit.
    BaseMotion { hz: f64, size_dps: f64, limit_dps: f64 },
    /// The part was not at rest for too great a share of the time.
    Restless { share: f64, limit: f64 },
}

rows!(match ChamberRefusal as Display {
    Self::Frozen { at_s, for_s } => Row {
        code: "frozen",
        text: format_args!(
            "the part is frozen: at {at_s:.1} s its readings have not changed for {for_s:.1} s. Check supply and \
             wiring, which cold and heat strain too"
        ),
    },
    Self::NoTemperature { step, after_s, wrong_edge } => Row {
        code: "no-temperature",
        text: format_args!(
            "step {step}: no temperature of the part was read within {after_s:.0} s{}. {}",
            because_of(wrong_edge),
            if wrong_edge {
                "Use the other edge (edge=rising or edge=falling in the device's address)"
            } else {
                "Read the temperature more often"
            }
        ),
    },
    Self::OutOfRange { step, after_s } => Row {
        code: "out-of-range",
        text: format_args!(
            "step {step}: no rate within {after_s:.0} s, but readings out of range: the part turns, or its supply or \
             wiring is wrong. Keep it still"
        ),
    },
    Self::Silent { step, for_s } => Row {
        code: "silent",
        text: format_args!("step {step}: no reading for {for_s:.0} s. Check cable and connectors"),
    },
    Self::Lost { lost, samples, limit } => Row {
        code: "lost-samples",
        text: format_args!(
            "{lost} of {} samples were lost, above the limit of {:.2} %. Read less often, or shorten the cable",
            lost + samples,
            limit * 100.0
        ),
    },
    Self::NotSettled { step, set_c, temp_c, drift_c_per_min, most_c_per_min, air_c } => Row {
        code: "not-settled",
        text: format_args!(
            "step {step}: the part has not settled at {set_c:.1} °C in time. It is at {temp_c:.2} °C and drifts by \
             {drift_c_per_min:+.3} °C/min (limit {most_c_per_min:.3}): {}",
            advice(set_c, air_c)
        ),
    },
    Self::NotReached { step, set_c, air_c, after_s } => Row {
        code: "not-reached",
        text: format_args!(
            "step {step}: {after_s:.0} s after the chamber was set to {set_c:.1} °C its air is still at {air_c:.1} \
             °C. Close its door, and check that it is on and can reach the set point"
        ),
    },
    Self::Overshoot { step, air_c, low_c, high_c } => Row {
        code: "overshoot",
        text: format_args!(
            "step {step}: the air is at {air_c:.1} °C, beyond the {low_c:.1} to {high_c:.1} °C of the plan, which \
             may harm the part. Check the chamber's control, or allow more (overshoot_c in the plan)"
        ),
    },
    Self::BeyondPart { step, air_c, low_c, high_c } => Row {
        code: "beyond-limits",
        text: format_args!(
            "step {step}: the air is at {air_c:.1} °C, and the part bears {low_c:.1} to {high_c:.1} °C only. Look at \
             the chamber now: its sensor or control has failed, or it was that hot or cold before"
        ),
    },
    Self::Disturbed { step, times, why } => Row {
        code: "disturbed",
        text: format_args!(
            "{} of step {step} was disturbed {times} times. The last time {why}",
            ChamberState::Average
        ),
    },
    Self::Span { span_c, least_c } => Row {
        code: "small-span",
        text: format_args!(
            "the part's temperature changed by only {span_c:.1} °C, and its own warmth explains up to \
             {least_c:.0} °C. Check that the chamber is on, and that the part is in it"
        ),
    },
    Self::Uncertain { u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: "uncertain",
        text: format_args!(
            "the standard uncertainty of BTC would be {u_btc_dps_per_c:.4} °/s/°C, above the limit of \
             {wanted_dps_per_c}. Plan for a wider span, or for more time"
        ),
    },
    Self::NoCurve(ThermalError::TooFew { blocks, needed }) => Row {
        code: "no-curve",
        text: format_args!(
            "the part was at rest for {blocks} means, and a bias over temperature needs at least {needed}. Fix the \
             part, or plan for longer"
        ),
    },
    Self::NoCurve(ThermalError::Degenerate) => Row {
        code: "no-curve",
        text: format_args!("no bias over temperature explains the rate. Check that the part was at rest"),
    },
    Self::BaseMotion { hz, size_dps, limit_dps } =>
        Row { code: "swaying", text: format_args!("{}", Refusal::BaseMotion { hz, size_dps, limit_dps }) },
    Self::Restless { share, limit } => Row {
        code: "restless",
        text: format_args!(
            "the part was not at rest for {:.0} % of the time, above the limit of {:.0} %. Fix it to the chamber's \
             floor on something that damps the fan, and read it more often if noise folds in",
            share * 100.0,
            limit * 100.0
        ),
    },
});

impl core::error::Error for ChamberRefusal {}

/// A disturbance that spoils the average of a soak point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum Disturbance {
    /// The temperature left the soak point.
    Temperature { moved_c: f64, limit_c: f64 },
    /// The part moved, or the rate was noisier than the part's own noise explains.
    Motion { axis: usize },
    /// Fewer than 80 % of the seconds of the average have readings.
    Gaps,
    /// The rate was beyond the range.
    OutOfRange,
}

impl fmt::Display for Disturbance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Temperature { moved_c, limit_c } => write!(
                f,
                "the part's temperature moved by {moved_c:+.2} °C, above the limit of {limit_c:.2} °C: was the door \
                 opened?"
            ),
            Self::Motion { axis } => {
                write!(f, "axis {} was not at rest: does the chamber or its fan shake the part?", axis + 1)
            }
            Self::Gaps => f.write_str("less than 80 % of it was read"),
            Self::OutOfRange => f.write_str("the rate was beyond the range"),
        }
    }
}

/// Advice for a part that does not settle, from the set point and the air of the chamber.
fn advice(set_c: f64, air_c: Option<f64>) -> String {
    match air_c {
        Some(air_c) if (air_c - set_c).abs() > REACHED_C => format!(
            "the chamber's air is only at {air_c:.1} °C, so close its door, and check that it is on and can reach \
             {set_c:.1} °C"
        ),
        Some(air_c) => format!(
            "the chamber's air is at {air_c:.1} °C, so shield the part from its fan, or allow more \
             (drift_c_per_min, settle_timeout_s in the plan)"
        ),
        None => format!(
            "check that the chamber is at {set_c:.1} °C and its door is closed, or allow more (drift_c_per_min, \
             settle_timeout_s in the plan)"
        ),
    }
}
