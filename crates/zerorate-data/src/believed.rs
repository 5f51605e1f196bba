//! What is to be said of readings that are not to be believed.

use zerorate::health::{Frozen, Health};
use zerorate::{Tally, Warning};

/// What was found of a run of samples, for scripts: `code: text`. `start_ns` is the time of its first sample.
pub fn warnings(health: &Health, tally: &Tally, start_ns: u64) -> Vec<String> {
    let (marks, samples) = (health.marks(), tally.samples);
    let impossible = Warning::Impossible { count: marks.spoilt(), fraction: marks.spoilt() as f64 / samples as f64 };
    let found = [
        health.frozen_at_end().map(|frozen| format!("frozen: {}", frozen_text(&frozen, start_ns))),
        (marks.spoilt() > 0).then(|| format!("{}: {impossible}", impossible.code())),
        (marks.out_of_range > 0).then(|| {
            format!(
                "out-of-range: {} readings are beyond the range (F-35): the part turns, its supply is wrong, or \
                the line carries errors; they are not to be used",
                marks.out_of_range
            )
        }),
        (2 * marks.unjudged > samples).then(|| {
            "unjudged: the readings are too far apart to tell impossible ones from motion (bit errors would pass); \
             use a smaller divider"
                .to_owned()
        }),
        tally.data_ready_stutters().then(|| {
            format!(
                "data-ready-stutters: in {} of {} gaps no edge of data ready came: RDY (pin 10) stutters, or the \
                host was deaf to it for that long; check its wire, its level and its pull-up, and only then what else \
                the host does",
                tally.silent_gaps, tally.gaps
            )
        }),
    ];
    found.into_iter().flatten().collect()
}

/// Since when which readings do not change, and what to do.
pub fn frozen_text(frozen: &Frozen, start_ns: u64) -> String {
    let since_s = frozen.since_ns.saturating_sub(start_ns) as f64 * 1e-9;
    let what = if frozen.both { "the readings have" } else { "the rate has" };
    format!(
        "{what} not changed since {since_s:.1} s, while noise changes every reading: the part is frozen; reset it and \
         check SDO (pin 12) and the supply (pins 11, 13, 15)"
    )
}
