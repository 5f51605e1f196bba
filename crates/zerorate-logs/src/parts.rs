//! Reads a log in several consecutive files: a bag of ROS 2 that was split.

use crate::choice::ColumnSelection;
use crate::column::Column;
use crate::error::{LogError, Result};
use crate::options::ColumnOptions;
use crate::query::ColumnQuery;
use crate::raw_columns::{Clock, RawColumns};
use crate::read::find;
use crate::warning::LogWarning;
use std::path::{Path, PathBuf};
use zerorate_input::{Input, InputError};

/// The files of a log.
#[derive(Debug, Default)]
pub struct Parts {
    /// The files with their names, in order.
    pub files: Vec<(PathBuf, Input)>,
    /// The number of messages of each topic in all files, as the description of the bag states.
    pub messages: Vec<(String, u64)>,
}

impl Parts {
    /// These files from their start, to be read once more. Do not read the original and the clone at the same time:
    /// they share one position in each file.
    ///
    /// # Errors
    /// Returns an error if a file cannot be opened again or rewound.
    pub fn try_clone(&self) -> Result<Self> {
        let again = |(path, input): &(PathBuf, Input)| match input.rewound() {
            Ok(input) => Ok((path.clone(), input)),
            Err(error) => Err(InputError::io("read", path, error)),
        };
        let files = self.files.iter().map(again).collect::<Result<_, InputError>>()?;
        Ok(Self { files, messages: self.messages.clone() })
    }
}

impl From<Vec<(PathBuf, Input)>> for Parts {
    fn from(files: Vec<(PathBuf, Input)>) -> Self {
        Self { files, messages: Vec::new() }
    }
}

/// Reads the wanted columns of a log in several files. `path` names the log in messages.
pub fn read_parts(
    path: &Path,
    parts: impl Into<Parts>,
    wanted: ColumnSelection<'_>,
    args: &ColumnOptions,
) -> Result<Vec<Column>> {
    found(path, parts.into(), &ColumnQuery::of(wanted, args))?.finish(path, args)
}

/// Reads columns as [`read_parts`] does. If the log does not state the rate, also returns the question for it.
pub fn read_without_rate(
    path: &Path,
    parts: impl Into<Parts>,
    wanted: ColumnSelection<'_>,
    args: &ColumnOptions,
) -> Result<(Vec<Column>, Option<LogError>)> {
    found(path, parts.into(), &ColumnQuery::of(wanted, args))?.finish_without_rate(path, args)
}

/// Reads the wanted columns and, if the log is a capture and no unit or scale is given, its temperature in the same
/// pass.
pub fn read_with_temperature(
    path: &Path,
    parts: impl Into<Parts>,
    wanted: ColumnSelection<'_>,
    args: &ColumnOptions,
) -> Result<(Vec<Column>, Option<Column>)> {
    // a given unit or scale would be applied to the temperature, too
    let with_temperature = args.unit.is_none() && args.scale.is_none();
    let found = found(path, parts.into(), &ColumnQuery { wanted, args, with_temperature })?;
    let is_there = found.columns.last().is_some_and(|column| column.is_beside);
    let mut columns = found.finish(path, args)?;
    let temperature = if is_there { columns.pop() } else { None };
    Ok((columns, temperature))
}

fn found(path: &Path, parts: Parts, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Parts { files, messages } = parts;
    let mut all: Option<RawColumns> = None;
    for (part, input) in files {
        let found = find(&part, input, asked)?;
        match &mut all {
            None => all = Some(found),
            Some(all) => all.append(&part, found)?,
        }
    }
    let mut all = all.ok_or_else(|| LogError::Ask(format!("{} has no file with a log", path.display())))?;
    all.hold_against(path, &messages);
    Ok(all)
}

impl RawColumns {
    /// Warns if the topic that was read has another number of messages than its bag states.
    fn hold_against(&mut self, path: &Path, stated: &[(String, u64)]) {
        let Some(column) = self.columns.first() else { return };
        let is_read = |topic: &str| column.name.strip_prefix(topic).is_some_and(|rest| rest.starts_with('.'));
        let found = column.values.rows();
        let differs = stated.iter().find(|(topic, stated)| is_read(topic) && *stated != found);
        self.warnings.extend(differs.map(|(topic, stated)| LogWarning::miscounted(path, topic, *stated, found)));
    }

    /// Appends the rows of the next file of the same log.
    fn append(&mut self, part: &Path, next: Self) -> Result<()> {
        let names = |found: &Self| found.columns.iter().map(|column| column.name.clone()).collect::<Vec<_>>();
        let (mine, others) = (names(self), names(&next));
        if mine != others {
            let why = format!("it has {} where the file before has {}", others.join(", "), mine.join(", "));
            return Err(LogError::Ask(format!("{}: {why}", part.display())));
        }
        for (column, next) in self.columns.iter_mut().zip(next.columns) {
            let are_codes = column.values.are_codes() && next.values.are_codes();
            column.values.extend_cells(&next.values.into_rows(), are_codes);
        }
        if let (Clock::Column(_, times), Clock::Column(_, next)) = (&mut self.clock, next.clock) {
            times.append(&next);
        }
        self.warnings.extend(next.warnings);
        Ok(())
    }
}
