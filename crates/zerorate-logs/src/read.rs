//! Reads columns of a log in any supported format.

use crate::choice::ColumnSelection;
use crate::column::Column;
use crate::error::{LogError, Result};
use crate::forms::{Content, Form};
use crate::open::{self, Log};
use crate::options::ColumnOptions;
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
use crate::{raw, tabular, text, wide};
use arrow_array::RecordBatch;
use arrow_ipc::writer::StreamWriter;
use arrow_schema::ArrowError;
use std::path::Path;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::table::{DESCRIPTION, DescribedTable, Source, describes_itself};
use zerorate_input::{Input, InputError, Opened, open_table};

/// Reads a column of a log in any supported format, compressed or not; `path` names the log in messages.
///
/// # Errors
/// Returns an error if the file cannot be read, says too little about the column, or holds numbers that are refused.
pub fn read(path: &Path, input: Input, args: &ColumnOptions) -> Result<Column> {
    let columns = read_all(path, input, ColumnSelection::One(args.column.as_deref()), args)?;
    columns.into_iter().next().ok_or_else(|| LogError::Ask(format!("{} has no column", path.display())))
}

/// Reads the `wanted` columns together and ignores `args.column`. All columns have the same rate. The first column
/// carries the warnings about the whole file.
///
/// # Errors
/// Returns the same errors as [`read`].
pub fn read_all(path: &Path, input: Input, wanted: ColumnSelection<'_>, args: &ColumnOptions) -> Result<Vec<Column>> {
    find(path, input, &ColumnQuery::of(wanted, args))?.finish(path, args)
}

/// Reads columns of a table in memory; `path` names the table in messages.
///
/// # Errors
/// Returns the same errors as [`read`].
pub fn read_table(
    path: &Path,
    table: &RecordBatch,
    wanted: ColumnSelection<'_>,
    args: &ColumnOptions,
) -> Result<Vec<Column>> {
    let room = MemoryBudget::of(table.get_array_memory_size() as u64);
    let query = ColumnQuery::of(wanted, args);
    if let Some(open) = args.described.filter(|_| describes_itself(table.schema_ref())) {
        let stream = arrow_stream(table).map_err(|error| InputError::arrow("read", path, error))?;
        if let Some(described) = open(path, Source::File(stream.into()))? {
            return tabular::read_described(path, described, room, &query)?.finish(path, args);
        }
    }
    let mut columns = tabular::TableColumns::start(path, &table.schema(), room, &query, None)?;
    columns.take(table)?;
    columns.finish(None)?.finish(path, args)
}

fn arrow_stream(table: &RecordBatch) -> Result<Vec<u8>, ArrowError> {
    let mut writer = StreamWriter::try_new(Vec::new(), table.schema_ref())?;
    writer.write(table)?;
    writer.into_inner()
}

/// Reads the wanted columns, before units and times are applied.
pub fn find(path: &Path, input: Input, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let log = open::open(path, input)?;
    match asked.args.raw {
        Some(raw) => raw::read(log, raw, asked),
        None => found(log, asked),
    }
}

fn found(mut log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let form = Form::of(&log)?;
    if form.is_none() {
        log.input = wide::narrowed(log.path, log.input, &log.start, log.room)?;
    }
    let may_describe_itself = form.is_none_or(|form| form.content == Content::DescribedTable && form.reader.is_ok());
    if let Some(table) = described(&log, may_describe_itself, asked)? {
        return tabular::read_described(log.path, table, log.room, asked);
    }
    if asked.args.only.is_some() && form.is_some_and(|form| form.content == Content::Messages) {
        return Err(asked.args.only_of_tables(log.path));
    }
    match form.map(|form| form.reader) {
        Some(Ok(read)) => read(log, asked),
        Some(Err(missing)) => Err(InputError::not_built_in(log.path, missing).into()),
        None => match open_table(log.path, log.input)? {
            Opened::Table(source) => tabular::read(log.path, source, log.room, asked),
            Opened::Other(input) => text::read(log.path, input, log.room, asked),
        },
    }
}

/// The log as a table that describes itself; `None` for other logs.
fn described(log: &Log<'_>, is_possible: bool, asked: &ColumnQuery<'_>) -> Result<Option<Box<dyn DescribedTable>>> {
    let Some(open) = asked.args.described.filter(|_| is_possible) else {
        let describes_itself = log.start.starts_with(format!("# {DESCRIPTION}").as_bytes());
        return if describes_itself { Err(tabular::needs_reader(log.path)) } else { Ok(None) };
    };
    let input = log.input.try_clone().map_err(|error| InputError::io("read", log.path, error))?;
    Ok(open(log.path, Source::File(input))?)
}
