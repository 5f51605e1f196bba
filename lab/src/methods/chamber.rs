//! The estimate of `zerorate chamber` on the profile of F-57, from means over 1 s. The state machine of the
//! measurement is left out.

use super::comparison::MethodResult;
use super::unit::{MEAN_S, Recording};
use zerorate::Part;
use zerorate::chamber::Record;

const MAX_ORDER: usize = 3;
const MEANS_PER_S: usize = (1.0 / MEAN_S) as usize;

pub fn fit(recording: &Recording) -> Option<MethodResult> {
    let seconds: Vec<_> = recording.averages(MEANS_PER_S).collect();
    let record = Record {
        start_s: seconds.iter().map(|second| second.start_s).collect(),
        temp_c: seconds.iter().map(|second| second.temp_c).collect(),
        rates_dps: vec![seconds.iter().map(|second| second.rate_dps).collect()],
        at_rest: vec![true; seconds.len()],
        ..Record::default()
    };
    let outcome = record.outcomes(&Part::ADIS16130, None, MAX_ORDER).ok()?.pop()?;
    Some(outcome.curve.into())
}
