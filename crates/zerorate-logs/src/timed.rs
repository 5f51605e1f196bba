//! Reads columns of a log together with the time of each row.

use crate::choice::{ColumnSelection, ColumnSpec};
use crate::clock::TimeBase;
use crate::error::{LogError, Result};
use crate::options::ColumnOptions;
use crate::query::ColumnQuery;
use crate::rate_question::no_rate;
use crate::raw_columns::{Clock, RawColumn, RawColumns};
use crate::read::find;
use crate::warning::LogWarning;
use std::path::Path;
use zerorate_allan::Gap;
use zerorate_input::{Input, Quantity};

/// Columns as they are in a log, with the time of each row: no unit is applied, and nothing is filled in.
pub struct TimedColumns {
    /// The columns, in the order in which they were asked for.
    pub columns: Vec<TimedColumn>,
    /// The time of each row, ns, by the clock of the log, or since the first row if a rate is given or such times do
    /// not fit a `u64`. The times increase.
    pub t_ns: Vec<u64>,
    /// Samples that are missing between rows.
    pub gaps: Vec<Gap>,
    /// Warnings about the whole log.
    pub warnings: Vec<LogWarning>,
}

/// A column of [`TimedColumns`].
pub struct TimedColumn {
    /// The name of the column, or its number if the log does not name it.
    pub name: String,
    /// The value of each row, NaN for an empty row.
    pub values: Vec<f64>,
    /// The quantity, and the size of a step of 1 in the unit of results, if the format of the log states them.
    pub stated: Option<(Quantity, f64)>,
    /// Warnings about this column alone.
    pub warnings: Vec<LogWarning>,
}

/// Reads the columns that `specs` describe; `path` names the file in messages. If neither time column nor rate is
/// given, the time is another column whose name or type states a time, as in `t_ns`.
///
/// # Errors
/// Returns an error if the file cannot be read, it lacks a column or the time, or its times do not increase.
pub fn read_timed(path: &Path, input: Input, specs: &[ColumnSpec], args: &ColumnOptions) -> Result<TimedColumns> {
    let mut found = find(path, input, &ColumnQuery::of(ColumnSelection::Described(specs), args))?;
    found.repair_times(path, args)?;
    let RawColumns { columns, clock, warnings, .. } = found;
    let columns = columns.into_iter().map(|column| {
        let RawColumn { name, values, stated, warnings, .. } = column;
        TimedColumn { name, values: values.into_rows(), stated, warnings }
    });
    let columns: Vec<TimedColumn> = columns.collect();
    let rows = columns.first().map_or(0, |column| column.values.len());
    let (t_ns, gaps) = times(path, clock, rows, args)?;
    Ok(TimedColumns { columns, t_ns, gaps, warnings })
}

fn times(path: &Path, clock: Clock, rows: usize, args: &ColumnOptions) -> Result<(Vec<u64>, Vec<Gap>)> {
    let silent = |rate_hz: f64| (0..rows).map(|row| (row as f64 * 1e9 / rate_hz).round() as u64).collect();
    let (t_ns, gaps): (Vec<u64>, Vec<Gap>) = match (args.rate, clock) {
        (Some(rate_hz), _) => (silent(rate_hz), Vec::new()),
        (None, clock) => match (clock.time_base(path, args)?, clock) {
            (Some((unit, TimeBase { gaps, .. })), Clock::Column(_, times)) => (times.nanoseconds(unit), gaps),
            _ => return Err(no_rate(path, &[], &[], args.names)),
        },
    };
    if t_ns.windows(2).any(|pair| pair[1] <= pair[0]) {
        let why = "its rows are less than a nanosecond apart; is it the rate, and the unit of the time?";
        return Err(LogError::Refused("times-disordered", format!("{}: {why}", path.display())));
    }
    Ok((t_ns, gaps))
}
