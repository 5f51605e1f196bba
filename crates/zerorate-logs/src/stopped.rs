//! A sensor that stopped while it was recorded.

use super::{LogError, Result};
use crate::warning::LogWarning;
use std::path::Path;
use zerorate_allan::Input;

/// A column that changes more often than not, and then no more for so many samples, has stopped.
const STOPPED_SAMPLES: usize = 1000;

/// The warning about the column `name` of a log where it stops changing: a log of another part need not have stopped
/// with it. `path` names the log in messages.
///
/// # Errors
/// Refuses a column of one value all along: a dead sensor, not noise.
pub fn stopped(input: Input<'_>, rate_hz: f64, path: &Path, name: &str) -> Result<Option<LogWarning>> {
    let (changes, total, gaps) = match input {
        Input::Codes { codes, gaps } => (Changes::of(codes.iter().map(|code| f64::from(*code))), codes.len(), gaps),
        Input::Rate(numbers) | Input::Phase(numbers) => (Changes::of(numbers.iter().copied()), numbers.len(), &[][..]),
    };
    let Changes { len, count, longest: Run { start, len: same, samples } } = changes;
    if count == 0 {
        let what = format!("{}: all {len} samples of column {} are the same", path.display(), name);
        let why = "a dead or frozen sensor, and no noise that could be analysed";
        return Err(LogError::Refused("frozen", format!("{what}: {why}")));
    }
    let is_frozen = same >= STOPPED_SAMPLES && count * 2 > len - same;
    let is_last = start + samples == total;
    // among codes what is missing stands beside them
    let lost: u64 = gaps.iter().filter(|gap| gap.at <= start).map(|gap| gap.missing).sum();
    let from_s = (start as u64 + lost) as f64 / rate_hz;
    let (path, column) = (path.display().to_string(), name.to_owned());
    Ok(is_frozen.then_some(match is_last {
        true => LogWarning::Stopped { path, column, same, len },
        false => LogWarning::Hung { path, column, same, len, from_s },
    }))
}

/// Samples of one value, one after the other.
#[derive(Clone, Copy, Default)]
struct Run {
    /// Index of the first stopped sample.
    start: usize,
    /// The number of stopped samples.
    len: usize,
    /// The same, with the missing samples between and behind them.
    samples: usize,
}

/// The changes of a column.
#[derive(Default)]
struct Changes {
    /// Samples that are there.
    len: usize,
    /// Changes from one to the next.
    count: usize,
    /// The longest stretch without a change.
    longest: Run,
}

impl Changes {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        let (mut all, mut run, mut before) = (Self::default(), Run::default(), None);
        for (index, value) in values.enumerate() {
            if value.is_nan() {
                run.samples += 1;
            } else {
                all.len += 1;
                if before.is_some_and(|before| before != value) {
                    all.count += 1;
                    run = Run { start: index, ..Run::default() };
                }
                before = Some(value);
                run = Run { len: run.len + 1, samples: run.samples + 1, ..run };
            }
            if run.len >= all.longest.len {
                all.longest = run;
            }
        }
        all
    }
}
