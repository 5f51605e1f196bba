//! Checks of the samples of a column in one pass: samples at a limit, steps that hide the noise, samples that were not
//! measured, and a sensor that stopped.
//!
//! Each check is fed the same [`Block`]s. The facts of a block are computed once, so that a check reads single samples
//! only where the facts do not suffice. For plain noise the facts mostly suffice.

mod block;
pub mod clipped;
pub mod coarse;
pub mod resampled;
mod stopped;
mod zeros;

use crate::error::Result;
use crate::warning::LogWarning;
use block::{Block, for_each_block};
use clipped::Clipped;
use coarse::Coarse;
use resampled::Resampled;
use std::path::Path;
use stopped::Changes;
use zerorate_allan::Input;
use zeros::Zeros;

/// The warning if the column `name` of a log stops changing. `path` names the log in messages.
///
/// # Errors
/// Returns [`LogError::Refused`](crate::LogError::Refused) if the column never changes: a dead sensor, not noise.
pub fn stopped(input: Input<'_>, rate_hz: f64, path: &Path, name: &str) -> Result<Option<LogWarning>> {
    let gaps = if let Input::Codes { gaps, .. } = input { gaps } else { &[] };
    ColumnFacts::of(&input).changes.stopped(gaps, rate_hz, path, name)
}

#[derive(Default)]
pub struct ColumnChecks {
    clipped: Clipped,
    coarse: Coarse,
    resampled: Resampled,
    zeros: Zeros,
    facts: ColumnFacts,
}

/// Facts about the samples that are needed after the checks.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ColumnFacts {
    pub changes: Changes,
    /// The sum of the samples that are finite.
    sum: f64,
    finite: u64,
}

impl ColumnChecks {
    pub fn of(input: &Input<'_>) -> Self {
        let mut checks = Self { zeros: Zeros::among(input.len()), ..Self::default() };
        for_each_block(input, |block| checks.feed(block));
        checks
    }

    fn feed(&mut self, block: &Block<'_>) {
        self.facts.feed(block);
        self.clipped.feed(block);
        self.coarse.feed(block);
        self.resampled.feed(block);
        self.zeros.feed(block);
    }

    pub fn finish(self, path: &Path, name: &str) -> (Vec<LogWarning>, ColumnFacts) {
        let Self { clipped, coarse, resampled, zeros, facts } = self;
        let (path, column) = (|| path.display().to_string(), || name.to_owned());
        let resampled = resampled.text().map(|how| LogWarning::Resampled { path: path(), column: column(), how });
        let marked = clipped.text().or_else(|| zeros.text());
        let clipped = marked.map(|how| LogWarning::Clipped { path: path(), column: column(), how });
        let coarse = coarse.text().map(|how| LogWarning::CoarseCodes { path: path(), column: column(), how });
        (resampled.into_iter().chain(clipped).chain(coarse).collect(), facts)
    }
}

impl ColumnFacts {
    pub fn of(input: &Input<'_>) -> Self {
        let mut facts = Self::default();
        for_each_block(input, |block| facts.feed(block));
        facts
    }

    /// The mean of the finite samples; not finite if there is none.
    pub fn mean(&self) -> f64 {
        self.sum / self.finite as f64
    }

    fn feed(&mut self, block: &Block<'_>) {
        self.changes.feed(block);
        let (sum, finite) = match &block.facts {
            Some(facts) => (facts.sum, block.len()),
            None => {
                let finite = || block.samples.iter().filter(|sample| sample.is_finite());
                (finite().sum(), finite().count())
            }
        };
        self.sum += sum;
        self.finite += finite as u64;
    }
}

#[cfg(test)]
mod tests;
