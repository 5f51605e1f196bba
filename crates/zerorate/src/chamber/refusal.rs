//! Why a measurement in a chamber ends without a result.

use super::procedure::ChamberState;
use crate::notice::because_of;
use crate::thermal::ThermalError;
use core::fmt;
use zerorate_allan::{Says, rows};

/// The measurement must not become a calibration. Steps count from 1. `Display` says what was seen, why it matters and
/// what to do.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum ChamberRefusal {
    /// The part stopped converting.
    Frozen { at_s: f64, for_s: f64 },
    /// Nothing tells the temperature of the part.
    NoTemperature { step: usize, after_s: f64, wrong_edge: bool },
    /// No reading came for so long.
    Silent { step: usize, for_s: f64 },
    /// More samples were lost than may be.
    Lost { lost: u64, samples: u64, limit: f64 },
    /// The part's temperature never came to rest near the set point. `air_c` is what the chamber said last.
    NotSettled { step: usize, set_c: f64, temp_c: f64, drift_c_per_min: f64, most_c_per_min: f64, air_c: Option<f64> },
    /// The air is far from the set point for too long.
    NotReached { step: usize, set_c: f64, air_c: f64, after_s: f64 },
    /// The air went where the plan never goes.
    Overshoot { step: usize, air_c: f64, low_c: f64, high_c: f64 },
    /// The air is where the part may not be.
    BeyondPart { step: usize, air_c: f64, low_c: f64, high_c: f64 },
    /// Again and again something happened while a soak point was averaged.
    Disturbed { step: usize, times: u32, why: Disturbance },
    /// The temperature hardly changed.
    Span { span_c: f64, least_c: f64 },
    /// The slope at the end is not known well enough.
    Uncertain { u_btc_dps_per_c: f64, wanted_dps_per_c: f64 },
    /// The record gives no curve.
    NoCurve(ThermalError),
    /// The rate was at no rest for too great a share of the time.
    Restless { share: f64, limit: f64 },
}

rows!(match ChamberRefusal {
    Self::Frozen { at_s, for_s } => Row {
        code: "frozen",
        text: format_args!(
            "the part is frozen: at {at_s:.1} s its readings have not changed for {for_s:.1} s, so it measures \
             nothing. Check supply and wiring, which cold and heat try as well"
        ),
    },
    Self::NoTemperature { step, after_s, wrong_edge } => Row {
        code: "no-temperature",
        text: format_args!(
            "step {step}: no temperature of the part within {after_s:.0} s{}, so nothing tells when it has \
             settled. {}",
            because_of(wrong_edge),
            if wrong_edge {
                "Listen to the other edge of data ready (edge=rising or edge=falling in the device's address)"
            } else {
                "Read the temperature more often"
            }
        ),
    },
    Self::Silent { step, for_s } => Row {
        code: "silent",
        text: format_args!("step {step}: no reading for {for_s:.0} s. Check cable and connectors"),
        says: Says::Refusal,
        by: &["chamber"],
        seen: "No reading came for a long time.",
        matters: "The part or its cable failed, perhaps by cold or heat.",
        remedy: "Check cable and connectors. Finished steps are kept: the same command goes on after them.",
    },
    Self::Lost { lost, samples, limit } => Row {
        code: "lost-samples",
        text: format_args!(
            "{lost} of {} samples were lost, and {:.2} % is the most. Read less often, or shorten the cable",
            lost + samples,
            limit * 100.0
        ),
    },
    Self::NotSettled { step, set_c, temp_c, drift_c_per_min, most_c_per_min, air_c } => Row {
        code: "not-settled",
        text: format_args!(
            "step {step}: at the set point of {set_c:.1} °C the part is at {temp_c:.2} °C and drifts by \
             {drift_c_per_min:+.3} °C/min, where {most_c_per_min:.3} is the most: it has not settled there in \
             time. {}",
            Air(set_c, air_c)
        ),
        says: Says::Refusal,
        by: &["chamber"],
        seen: "The part's temperature never came to rest near the set point.",
        matters: "The soak point would be an average over a drift.",
        remedy: "Close the door; check that the chamber reaches that temperature; shield the part from its fan; or \
            allow more in the plan (drift_c_per_min, settle_timeout_s).",
    },
    Self::NotReached { step, set_c, air_c, after_s } => Row {
        code: "not-reached",
        text: format_args!(
            "step {step}: {after_s:.0} s after the set point was {set_c:.1} °C the air is at {air_c:.1} °C: the \
             chamber does not get there. Close its door, and check that it is on and can reach that"
        ),
        says: Says::Refusal,
        by: &["chamber"],
        seen: "The air of the chamber is still far from its set point.",
        matters: "The plan cannot be carried out.",
        remedy: "Close the door, and check that the chamber is on and can reach that.",
    },
    Self::Overshoot { step, air_c, low_c, high_c } => Row {
        code: "overshoot",
        text: format_args!(
            "step {step}: the air is at {air_c:.1} °C, beyond the {low_c:.1} to {high_c:.1} °C of the plan, and may \
             harm the part. Check the chamber's control, or allow more (overshoot_c in the plan)"
        ),
        says: Says::Refusal,
        by: &["chamber"],
        seen: "The air went beyond every temperature of the plan.",
        matters: "It may harm the part, so the chamber was sent to a safe temperature.",
        remedy: "Check the chamber's control, or allow more in the plan (overshoot_c).",
    },
    Self::BeyondPart { step, air_c, low_c, high_c } => Row {
        code: "beyond-limits",
        text: format_args!(
            "step {step}: the air is at {air_c:.1} °C, and the part may be at {low_c:.1} to {high_c:.1} °C only. Look \
             at the chamber now: its sensor or its control has failed, or it was that hot or cold before"
        ),
        says: Says::Either,
        by: &["probe", "capture", "calibrate", "chamber", "stream"],
        seen: "The air is colder or warmer than the part may be; of a simulated part, it was asked to be.",
        matters: "A real part may be harmed, so its chamber was sent to a safe temperature. Of a simulated part \
            nobody knows what a real one would do there.",
        remedy: "Look at the chamber: its sensor, its control, and what it did before. Keep a simulated part within \
            the limits (operating_c in the file of a part).",
    },
    Self::Disturbed { step, times, why } => Row {
        code: "disturbed",
        text: format_args!("{} of step {step} was disturbed {times} times; at last, {why}", ChamberState::Average),
        says: Says::Refusal,
        by: &["chamber"],
        seen: "Again and again something happened while a soak point was averaged.",
        matters: "There is no quiet average of it.",
        remedy: "Keep the door closed; damp the fan; fix the part; read without losses.",
    },
    Self::Span { span_c, least_c } => Row {
        code: "small-span",
        text: format_args!(
            "the part's temperature changed by {span_c:.1} °C in all, and {least_c:.0} °C is the least that tells \
             more than its own warmth does: check that the chamber is on, and that the part is in it"
        ),
    },
    Self::Uncertain { u_btc_dps_per_c, wanted_dps_per_c } => Row {
        code: "uncertain",
        text: format_args!(
            "BTC would have a standard uncertainty of {u_btc_dps_per_c:.4} °/s/°C, and {wanted_dps_per_c} is the \
             most: plan for a wider span, or for more time"
        ),
        says: Says::Refusal,
        by: &["chamber"],
        seen: "BTC would be more uncertain than was asked for.",
        matters: "The result would not be what it was measured for.",
        remedy: "Plan for a wider span, or for more time; or accept more.",
        command: "zerorate chamber f57 -o unit.toml",
    },
    Self::NoCurve(ThermalError::TooFew { blocks, needed }) => Row {
        code: "no-curve",
        text: format_args!(
            "the part was at rest for {blocks} means, and {needed} are the fewest that give a bias over temperature: \
             fix the part, or plan for longer"
        ),
        says: Says::Refusal,
        by: &["chamber"],
        seen: "No bias over temperature explains the rate; or there was too little rest to find one.",
        matters: "There is nothing to correct with.",
        remedy: "Check that the part was at rest; plan for longer.",
    },
    Self::NoCurve(ThermalError::Degenerate) => Row {
        code: "no-curve",
        text: format_args!("no bias over temperature explains the rate: check that the part was at rest"),
    },
    Self::Restless { share, limit } => Row {
        code: "restless",
        text: format_args!(
            "the rate was not that of a part at rest in {:.0} % of the time, and {:.0} % is the most: fix the part to \
             the chamber's floor, on something that damps its fan; and read it more often, if it is read so seldom \
             that its noise folds in",
            share * 100.0,
            limit * 100.0
        ),
    },
});

impl fmt::Display for ChamberRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.text(f)
    }
}

impl core::error::Error for ChamberRefusal {}

/// What spoils the average of a soak point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "the fields are the numbers that the text shows, with their units")]
pub enum Disturbance {
    /// The temperature left the soak point.
    Temperature { moved_c: f64, limit_c: f64 },
    /// The part moved, or its noise is not its own.
    Motion { axis: usize },
    /// Less than 80 % of the average was read.
    Gaps,
    /// The rate was beyond the range.
    OutOfRange,
}

impl fmt::Display for Disturbance {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Temperature { moved_c, limit_c } => write!(
                f,
                "the part's temperature moved by {moved_c:+.2} °C, and {limit_c:.2} °C is the most that an average \
                 may see: was the door opened?"
            ),
            Self::Motion { axis } => write!(
                f,
                "the rate of axis {} is not that of a part at rest: does the chamber shake it, or its fan?",
                axis + 1
            ),
            Self::Gaps => f.write_str("less than 80 % of it was read"),
            Self::OutOfRange => f.write_str("the rate was beyond the range"),
        }
    }
}

/// What an air that is not where it was sent says.
struct Air(f64, Option<f64>);

impl fmt::Display for Air {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self(set_c, Some(air_c)) if (air_c - set_c).abs() > super::procedure::REACHED_C => write!(
                f,
                "The chamber's air is at {air_c:.1} °C, so it is the chamber that does not get there: close its door, \
                 and check that it is on and can reach {set_c:.1} °C"
            ),
            Self(_, Some(air_c)) => write!(
                f,
                "The chamber's air is at {air_c:.1} °C: shield the part from its fan, or allow more \
                 (drift_c_per_min, settle_timeout_s in the plan)"
            ),
            Self(set_c, None) => write!(
                f,
                "Check that the chamber is at {set_c:.1} °C and its door is closed, or allow more (drift_c_per_min, \
                 settle_timeout_s in the plan)"
            ),
        }
    }
}
