//! Axes of one log that jump together.

use super::record::Record;
use serde::Serialize;
use zerorate::allan::{self, Fit, motion};

/// A moment at which several axes jump.
#[derive(Serialize)]
pub struct Motion {
    at_s: f64,
    axes: Vec<String>,
}

/// Those of the axes of one log.
pub fn of(axes: &[Record]) -> Vec<Motion> {
    let fitted: Vec<(&Record, &Fit)> = axes.iter().filter_map(|axis| Some((axis, axis.model()?))).collect();
    let fits: Vec<&Fit> = fitted.iter().map(|(_, fit)| *fit).collect();
    let name = |i: usize| fitted[i].0.column.clone();
    let named =
        |motion: allan::Motion| Motion { at_s: motion.at_s, axes: motion.axes.into_iter().map(name).collect() };
    motion(&fits).into_iter().map(named).collect()
}

/// A line for all of them.
pub fn line(axes: &[Record]) -> Option<String> {
    let moments = of(axes);
    let moment = |Motion { at_s, axes }: &Motion| format!("{at_s:.1} s ({})", axes.join(", "));
    let all: Vec<String> = moments.iter().map(moment).collect();
    (!all.is_empty()).then(|| {
        format!(
            "motion: several axes jump together at {}: the sensor moved, which is no noise of it; record where \
             nothing moves, or cut the log there",
            all.join(", ")
        )
    })
}
