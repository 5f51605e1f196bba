//! Detects a sensor that stopped while it was recorded.

use super::block::{Block, WINDOW};
use crate::error::{LogError, Result};
use crate::warning::LogWarning;
use std::ops::RangeInclusive;
use std::path::Path;
use zerorate_allan::Gap;

/// A column has stopped if it stays the same for a thousandth of its samples, within these limits, and changes more
/// often than not in all others.
const STOPPED_SAMPLES: RangeInclusive<usize> = 2 * WINDOW..=1000;

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Run {
    /// Index of the first sample; missing samples count.
    start: usize,
    /// Number of samples, without missing ones.
    len: usize,
    /// Number of samples, including missing ones between and behind them.
    samples: usize,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Changes {
    /// Number of samples that are not missing.
    len: usize,
    /// Number of all samples, including NaN.
    total: usize,
    /// Number of changes from one sample to the next.
    count: usize,
    /// The last sample that is not missing.
    before: Option<f64>,
    run: Run,
    /// The last of the longest runs without a change. Runs that are too short to hold a whole window are left out.
    longest: Run,
}

impl Changes {
    pub fn feed(&mut self, block: &Block<'_>) {
        match &block.facts {
            // a stop lasts for a whole window at least
            Some(facts) if facts.ranges.iter().all(|range| *range > 0.0) => self.take(block, facts.changes),
            _ => block.samples.iter().for_each(|sample| self.push(*sample)),
        }
    }

    /// The number of missing samples of a column of numbers, which are NaN. Those of integer codes are in the gaps.
    pub fn missing(&self) -> usize {
        self.total - self.len
    }

    /// Adds a block that changes in each window: no sample in it is missing, nor the sample before it.
    fn take(&mut self, block: &Block<'_>, changes: usize) {
        let len = block.len();
        let is_change = |(before, sample): (f64, f64)| before != sample;
        let first = block.pairs().position(is_change).unwrap_or_default();
        let last = block.pairs().rposition(is_change).unwrap_or_default();
        self.grow(first);
        self.run = Run { start: self.total + last, ..Run::default() };
        self.grow(len - last);
        self.before = block.pairs().next_back().map(|(_, sample)| sample);
        (self.len, self.total, self.count) = (self.len + len, self.total + len, self.count + changes);
    }

    fn push(&mut self, sample: f64) {
        if sample.is_nan() {
            self.run.samples += 1;
            self.grow(0);
        } else {
            self.len += 1;
            if self.before != Some(sample) {
                self.count += usize::from(self.before.is_some());
                self.run = Run { start: self.total, ..Run::default() };
            }
            self.before = Some(sample);
            self.grow(1);
        }
        self.total += 1;
    }

    fn grow(&mut self, samples: usize) {
        self.run.len += samples;
        self.run.samples += samples;
        if self.run.len >= self.longest.len {
            self.longest = self.run;
        }
    }

    /// The warning if the column `name` of the log at `path` stops changing. `gaps` are the gaps among codes.
    ///
    /// # Errors
    /// Returns [`LogError::Refused`] if the column never changes.
    pub fn stopped(&self, gaps: &[Gap], rate_hz: f64, path: &Path, name: &str) -> Result<Option<LogWarning>> {
        let &Self { len, total, count, longest: Run { start, len: same, samples }, .. } = self;
        if count == 0 {
            let what = format!("{}: all {len} samples of column {} are the same", path.display(), name);
            let why = "a dead or frozen sensor, and no noise that could be analysed";
            return Err(LogError::Refused("frozen", format!("{what}: {why}")));
        }
        let (least, most) = STOPPED_SAMPLES.into_inner();
        let is_frozen = same >= (len / 1000).clamp(least, most) && count * 2 > len - same;
        let is_last = start + samples == total;
        // missing samples among codes are listed in the gaps
        let lost: u64 = gaps.iter().filter(|gap| gap.at <= start).map(|gap| gap.missing).sum();
        let from_s = (start as u64 + lost) as f64 / rate_hz;
        let (path, column) = (path.display().to_string(), name.to_owned());
        Ok(is_frozen.then_some(match is_last {
            true => LogWarning::Stopped { path, column, same, len },
            false => LogWarning::Hung { path, column, same, len, from_s },
        }))
    }
}
