//! Why a measurement in a chamber ends without a result.

use super::procedure::ChamberState;
use crate::notice::because_of;
use crate::thermal::ThermalError;
use core::fmt;
use zerorate_allan::codes;

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

codes!(ChamberRefusal {
    Frozen => "frozen",
    NoTemperature => "no-temperature",
    Silent => "silent",
    Lost => "lost-samples",
    NotSettled => "not-settled",
    NotReached => "not-reached",
    Overshoot => "overshoot",
    BeyondPart => "beyond-limits",
    Disturbed => "disturbed",
    Span => "small-span",
    Uncertain => "uncertain",
    NoCurve => "no-curve",
    Restless => "restless",
});

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

impl fmt::Display for ChamberRefusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Frozen { at_s, for_s } => write!(
                f,
                "the part is frozen: at {at_s:.1} s its readings have not changed for {for_s:.1} s, so it measures \
                 nothing. Check supply and wiring, which cold and heat try as well"
            ),
            Self::NoTemperature { step, after_s, wrong_edge } => write!(
                f,
                "step {step}: no temperature of the part within {after_s:.0} s{}, so nothing tells when it has \
                 settled. {}",
                because_of(wrong_edge),
                if wrong_edge {
                    "Listen to the other edge of data ready (edge=rising or edge=falling in the device's address)"
                } else {
                    "Read the temperature more often"
                }
            ),
            Self::Silent { step, for_s } => {
                write!(f, "step {step}: no reading for {for_s:.0} s. Check cable and connectors")
            }
            Self::Lost { lost, samples, limit } => write!(
                f,
                "{lost} of {} samples were lost, and {:.2} % is the most. Read less often, or shorten the cable",
                lost + samples,
                limit * 100.0
            ),
            Self::NotSettled { step, set_c, temp_c, drift_c_per_min, most_c_per_min, air_c } => write!(
                f,
                "step {step}: at the set point of {set_c:.1} °C the part is at {temp_c:.2} °C and drifts by \
                 {drift_c_per_min:+.3} °C/min, where {most_c_per_min:.3} is the most: it has not settled there in \
                 time. {}",
                Air(set_c, air_c)
            ),
            Self::NotReached { step, set_c, air_c, after_s } => write!(
                f,
                "step {step}: {after_s:.0} s after the set point was {set_c:.1} °C the air is at {air_c:.1} °C: the \
                 chamber does not get there. Close its door, and check that it is on and can reach that"
            ),
            Self::Overshoot { step, air_c, low_c, high_c } => write!(
                f,
                "step {step}: the air is at {air_c:.1} °C, beyond the {low_c:.1} to {high_c:.1} °C of the plan, and \
                 may harm the part. Check the chamber's control, or allow more (overshoot_c in the plan)"
            ),
            Self::BeyondPart { step, air_c, low_c, high_c } => write!(
                f,
                "step {step}: the air is at {air_c:.1} °C, and the part may be at {low_c:.1} to {high_c:.1} °C only. \
                 Look at the chamber now: its sensor or its control has failed, or it was that hot or cold before"
            ),
            Self::Disturbed { step, times, why } => {
                write!(f, "{} of step {step} was disturbed {times} times; at last, {why}", ChamberState::Average)
            }
            Self::Span { span_c, least_c } => write!(
                f,
                "the part's temperature changed by {span_c:.1} °C in all, and {least_c:.0} °C is the least that tells \
                 more than its own warmth does: check that the chamber is on, and that the part is in it"
            ),
            Self::Uncertain { u_btc_dps_per_c, wanted_dps_per_c } => write!(
                f,
                "BTC would have a standard uncertainty of {u_btc_dps_per_c:.4} °/s/°C, and {wanted_dps_per_c} is the \
                 most: plan for a wider span, or for more time"
            ),
            Self::NoCurve(ThermalError::TooFew { blocks, needed }) => write!(
                f,
                "the part was at rest for {blocks} means, and {needed} are the fewest that give a bias over \
                 temperature: fix the part, or plan for longer"
            ),
            Self::NoCurve(ThermalError::Degenerate) => {
                f.write_str("no bias over temperature explains the rate: check that the part was at rest")
            }
            Self::Restless { share, limit } => write!(
                f,
                "the rate was not that of a part at rest in {:.0} % of the time, and {:.0} % is the most: fix the \
                 part to the chamber's floor, on something that damps its fan; and read it more often, if it is read \
                 so seldom that its noise folds in",
                share * 100.0,
                limit * 100.0
            ),
        }
    }
}

impl core::error::Error for ChamberRefusal {}
