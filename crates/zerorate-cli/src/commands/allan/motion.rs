//! Events that several axes of one log show at once.

use serde::Serialize;
use zerorate_allan::MotionKind;
use zerorate_imu::Record;
use zerorate_imu::{ImuWarning, Moment};

/// A moment at which several axes jump or have a glitch.
#[derive(Serialize)]
pub struct Motion {
    at_s: f64,
    axes: Vec<String>,
    kind: &'static str,
}

/// Finds the common events of the axes of one log.
pub fn of(axes: &[Record]) -> Vec<Motion> {
    let motion = |Moment { at_s, axes, kind }: Moment| Motion {
        at_s,
        axes,
        kind: match kind {
            MotionKind::Jump => "jump",
            MotionKind::Knock => "knock",
        },
    };
    Moment::all(&Record::models(axes)).into_iter().map(motion).collect()
}

/// Formats the jumps as one line and the knocks as another.
pub fn lines(axes: &[Record]) -> Vec<String> {
    ImuWarning::of_motion(&Record::models(axes)).iter().map(ImuWarning::coded).collect()
}
