//! Scores of one fitted coefficient over many simulated records. Shares are in %.

use super::scenario::{Bounds, Scenario};
use zerorate_allan::Coefficient;

/// Errors relative to the truth, %, or absolute if the truth is zero.
pub struct Error {
    truth: f64,
    rms: f64,
    mean: f64,
}

impl Error {
    pub fn of(values: &[f64], truth: f64) -> Self {
        let errors = || values.iter().map(|value| if truth > 0.0 { 100.0 * (value / truth - 1.0) } else { *value });
        let n = values.len() as f64;
        let rms = (errors().map(|error| error * error).sum::<f64>() / n).sqrt();
        Self { truth, rms, mean: errors().sum::<f64>() / n }
    }
}

impl std::fmt::Display for Error {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { truth, rms, mean } = self;
        match *truth > 0.0 {
            true => write!(f, "truth {truth:.3e}, rms error {rms:.3} %, mean {mean:+.3} %"),
            false => write!(f, "truth 0, rms {rms:.2e}, mean {mean:.2e}"),
        }
    }
}

pub struct Score {
    error: Error,
    inside: f64,
    above: f64,
    below: f64,
    identified: f64,
    records: usize,
}

/// Allowed deviation in standard deviations: chance exceeds it in one of a hundred rows.
const CHANCE: f64 = 2.58;

/// Allowed error of a share over this many records, %.
pub fn scatter(share: f64, records: usize) -> f64 {
    CHANCE * (share * (100.0 - share) / records.max(1) as f64).sqrt()
}

/// Factor by which chance may enlarge the rms error of this many records.
fn rms_scatter(records: usize) -> f64 {
    1.0 + CHANCE / (2.0 * records.max(1) as f64).sqrt()
}

/// The share of items for which `holds` is true, %.
pub fn share<T>(all: &[T], holds: impl Fn(&T) -> bool) -> f64 {
    100.0 * all.iter().filter(|one| holds(one)).count() as f64 / all.len().max(1) as f64
}

pub fn judge(column: &[Coefficient], truth: f64) -> Score {
    Score {
        error: Error::of(&column.iter().map(|c| c.value).collect::<Vec<_>>(), truth),
        inside: share(column, |c| c.lo <= truth && truth <= c.hi),
        above: share(column, |c| c.lo > truth),
        below: share(column, |c| c.hi < truth),
        identified: share(column, |c| c.identified),
        records: column.len(),
    }
}

impl std::fmt::Display for Score {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { error, inside, above, below, identified, .. } = self;
        write!(
            f,
            "{error}; interval holds in {inside:.1} % (too high {above:.1}, too low {below:.1}), identified \
             {identified:.1} %"
        )
    }
}

impl Score {
    pub fn misses<'a>(&'a self, scenario: &'a Scenario, which: usize) -> impl Iterator<Item = String> + 'a {
        let Bounds { coverage, rms, identified, .. } = &scenario.bounds;
        // if the truth is zero, an interval can miss the truth on one side only
        let most = if self.error.truth > 0.0 { coverage.1 } else { 100.0 };
        let covers = self.inside >= coverage.0 - scatter(coverage.0, self.records)
            && self.inside <= most + scatter(most, self.records);
        let seen = identified.get(which).is_none_or(|least| self.identified >= *least);
        [
            (!covers, format!("interval holds in {:.1} %, not {} to {most} %", self.inside, coverage.0)),
            (
                self.error.truth > 0.0 && self.error.rms > rms[which] * rms_scatter(self.records),
                format!("rms error {:.3} % above {} %", self.error.rms, rms[which]),
            ),
            (!seen, format!("identified in {:.1} % only", self.identified)),
        ]
        .into_iter()
        .filter_map(|(missed, text)| missed.then_some(text))
    }
}
