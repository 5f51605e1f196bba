//! What is to be said of readings that are not to be believed.

use crate::note::Note;
use zerorate::health::{Frozen, Health};
use zerorate::{Tally, Warning};

/// What was found of a run of samples. `start_ns` is the time of its first sample.
pub fn warnings(health: &Health, tally: &Tally, start_ns: u64) -> Vec<Note> {
    of_axes([("", health)], tally, start_ns)
}

/// The same of each axis of a part, by its name; where there is one, it is not named.
pub fn of_axes<'a>(axes: impl IntoIterator<Item = (&'a str, &'a Health)>, tally: &Tally, start_ns: u64) -> Vec<Note> {
    let axes: Vec<(&str, &Health)> = axes.into_iter().collect();
    let several = axes.len() > 1;
    let named = |(axis, health): (&str, &Health)| {
        let name = if several { format!("axis {axis}: ") } else { String::new() };
        let found = of_readings(health, tally.samples, start_ns);
        found.into_iter().map(move |note| Note { text: format!("{name}{}", note.text), ..note })
    };
    axes.into_iter().flat_map(named).chain(of_edges(tally)).collect()
}

fn of_readings(health: &Health, samples: u64, start_ns: u64) -> Vec<Note> {
    let marks = health.marks();
    let impossible = Warning::Impossible { count: marks.spoilt(), fraction: marks.spoilt() as f64 / samples as f64 };
    let found = [
        health.frozen_at_end().map(|frozen| Note::new("frozen", frozen_text(&frozen, start_ns))),
        (marks.spoilt() > 0).then(|| Note::new(impossible.code(), impossible.to_string())),
        (marks.out_of_range > 0).then(|| {
            let text = format!(
                "{} readings are beyond the range of the part: it turns, its supply is wrong, or the line carries \
                 errors; they are not to be used",
                marks.out_of_range
            );
            Note::new("out-of-range", text)
        }),
        (2 * marks.unjudged > samples).then(|| {
            let text = if health.can_judge() {
                "the readings are too far apart to tell impossible ones from motion (bit errors would pass); use a \
                 smaller divider"
            } else {
                "too little is known of the part (its range, bandwidth and noise) to tell impossible readings from \
                 motion (bit errors would pass); state them in the file of the part"
            };
            Note::new("unjudged", text.to_owned())
        }),
    ];
    found.into_iter().flatten().collect()
}

fn of_edges(tally: &Tally) -> Option<Note> {
    tally.data_ready_stutters().then(|| {
        let text = format!(
            "in {} of {} gaps no edge of data ready came: its line (ADIS16130: RDY, pin 10) stutters, or the host was \
             deaf to it for that long; check its wire, its level and its pull-up, and only then what else the host \
             does",
            tally.silent_gaps, tally.gaps
        );
        Note::new("data-ready-stutters", text)
    })
}

/// Since when which readings do not change, and what to do.
pub fn frozen_text(frozen: &Frozen, start_ns: u64) -> String {
    let since_s = frozen.since_ns.saturating_sub(start_ns) as f64 * 1e-9;
    let what = if frozen.both { "the readings have" } else { "the rate has" };
    format!(
        "{what} not changed since {since_s:.1} s, while noise changes every reading: the part is frozen; reset it and \
         check its data line and its supply (ADIS16130: SDO is pin 12, the supply pins 11, 13, 15)"
    )
}
