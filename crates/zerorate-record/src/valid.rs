//! Warnings about invalid readings.

use crate::warning::CaptureWarning;
use zerorate::health::{Frozen, Health};
use zerorate::{Tally, Warning};

/// The warnings about the readings of each axis. If there are several axes, each warning names its axis. `start_ns` is
/// the time of the first sample.
pub fn of_axes<'a>(
    axes: impl IntoIterator<Item = (&'a str, &'a Health)>,
    tally: &Tally,
    start_ns: u64,
) -> Vec<CaptureWarning> {
    let axes: Vec<_> = axes.into_iter().collect();
    let several = axes.len() > 1;
    let named = |(axis, health): (&'a str, &'a Health)| {
        let of_axis = move |warning| match several {
            true => CaptureWarning::OfAxis { axis: axis.to_owned(), warning: Box::new(warning) },
            false => warning,
        };
        of_readings(health, tally.samples, start_ns).into_iter().map(of_axis)
    };
    axes.into_iter().flat_map(named).chain(of_edges(tally)).collect()
}

fn of_readings(health: &Health, samples: u64, start_ns: u64) -> Vec<CaptureWarning> {
    let counts = health.fault_counts();
    let impossible = Warning::Impossible { count: counts.faulty(), fraction: counts.faulty() as f64 / samples as f64 };
    let found = [
        health.frozen_at_end().map(|frozen| CaptureWarning::Frozen(frozen_text(&frozen, start_ns))),
        (counts.faulty() > 0).then_some(CaptureWarning::Impossible(impossible)),
        (counts.out_of_range > 0).then_some(CaptureWarning::OutOfRange(counts.out_of_range)),
        (2 * counts.unjudged > samples).then(|| CaptureWarning::Unjudged { can_judge: health.can_judge() }),
    ];
    found.into_iter().flatten().collect()
}

fn of_edges(tally: &Tally) -> Option<CaptureWarning> {
    let Tally { silent_gaps, gaps, .. } = *tally;
    tally.data_ready_stutters().then_some(CaptureWarning::DataReadyStutters { silent_gaps, gaps })
}

/// The text about frozen readings: which of them no longer change, since when, and what to do.
pub fn frozen_text(frozen: &Frozen, start_ns: u64) -> String {
    let since_s = frozen.since_ns.saturating_sub(start_ns) as f64 * 1e-9;
    let what = if frozen.both { "the readings have" } else { "the rate has" };
    format!("{what} not changed since {since_s:.1} s; reset the part, check its data line and supply")
}
