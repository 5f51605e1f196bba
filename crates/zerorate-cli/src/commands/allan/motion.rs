//! Axes of one log to which something happens at once.

use serde::Serialize;
use zerorate_allan::{self as allan, Fit, MotionKind, motion};
use zerorate_jobs::analysis::Record;

/// A moment at which several axes jump, or have a glitch.
#[derive(Serialize)]
pub struct Motion {
    at_s: f64,
    axes: Vec<String>,
    kind: Kind,
}

#[derive(Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Jump,
    Knock,
}

/// Those of the axes of one log.
pub fn of(axes: &[Record]) -> Vec<Motion> {
    let fitted: Vec<(&Record, &Fit)> = axes.iter().filter_map(|axis| Some((axis, axis.model()?))).collect();
    let fits: Vec<&Fit> = fitted.iter().map(|(_, fit)| *fit).collect();
    let name = |i: usize| fitted[i].0.column.clone();
    let named = |motion: allan::Motion| Motion {
        at_s: motion.at_s,
        axes: motion.axes.into_iter().map(name).collect(),
        kind: match motion.kind {
            MotionKind::Jump => Kind::Jump,
            MotionKind::Knock => Kind::Knock,
        },
    };
    motion(&fits).into_iter().map(named).collect()
}

/// Moments that a line names.
const NAMED: usize = 6;

/// A line for the jumps, and one for the knocks.
pub fn lines(axes: &[Record]) -> Vec<String> {
    let all = of(axes);
    let line = |kind, what: &str, meaning: &str| {
        let moments: Vec<String> = all.iter().filter(|motion| motion.kind == kind).map(Motion::text).collect();
        let named = moments[..moments.len().min(NAMED)].join(", ");
        let more = moments.len().saturating_sub(NAMED);
        let more = if more > 0 { format!(" and {more} times more") } else { String::new() };
        (!moments.is_empty()).then(|| format!("motion: several axes {what} together at {named}{more}: {meaning}"))
    };
    let jumps = line(
        Kind::Jump,
        "jump",
        "the sensor moved, which is no noise of it; record where nothing moves, or cut the log there",
    );
    let knocks = line(
        Kind::Knock,
        "have a glitch",
        "a knock, or a sample of all that broke; keep the sensor from being touched",
    );
    jumps.into_iter().chain(knocks).collect()
}

impl Motion {
    fn text(&self) -> String {
        format!("{:.1} s ({})", self.at_s, self.axes.join(", "))
    }
}
