//! The reader of each form of log.

use crate::arrow_file::ArrowFile;
use crate::choice::ColumnSelection;
use crate::column::Column;
use crate::error::{LogError, Result};
#[cfg(feature = "hdf5")]
use crate::hdf5;
#[cfg(feature = "matlab")]
use crate::mat;
#[cfg(feature = "mcap")]
use crate::mcap_bag;
#[cfg(feature = "numpy")]
use crate::npy;
#[cfg(feature = "npz")]
use crate::npz;
use crate::open::{self, Log, LogForm};
use crate::options::ColumnOptions;
#[cfg(feature = "parquet")]
use crate::parquet;
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
#[cfg(feature = "ros")]
use crate::rosbag;
#[cfg(feature = "sqlite")]
use crate::sqlite_bag;
use crate::{dataflash, raw, tabular, text, ulog, wide};
use arrow_array::RecordBatch;
use arrow_ipc::writer::StreamWriter;
use arrow_schema::ArrowError;
use std::path::Path;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::table::{DESCRIPTION, DescribedTable, Source, describes_itself};
use zerorate_input::{Input, InputError, Opened, open_table};

/// Reads a column of a log in any form, packed or not; `path` names it in messages.
///
/// # Errors
/// The file cannot be read, does not say enough about the column, or its numbers must not become a result.
pub fn read(path: &Path, input: Input, args: &ColumnOptions) -> Result<Column> {
    let columns = read_all(path, input, ColumnSelection::One(args.column.as_deref()), args)?;
    columns.into_iter().next().ok_or_else(|| LogError::Ask(format!("{} has no column", path.display())))
}

/// Reads the `wanted` columns in one pass over the file and ignores `args.column`. All have one rate. The first
/// carries the warnings about the file as a whole.
///
/// # Errors
/// The same errors as for [`read`].
pub fn read_all(path: &Path, input: Input, wanted: ColumnSelection<'_>, args: &ColumnOptions) -> Result<Vec<Column>> {
    find(path, input, &ColumnQuery::of(wanted, args))?.finish(path, args)
}

/// Reads columns of a table in memory; `path` is what messages call them.
///
/// # Errors
/// The same errors as for a file.
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

/// The table as the bytes of a file.
fn arrow_stream(table: &RecordBatch) -> Result<Vec<u8>, ArrowError> {
    let mut writer = StreamWriter::try_new(Vec::new(), table.schema_ref())?;
    writer.write(table)?;
    writer.into_inner()
}

/// The columns as they stand in the file.
pub fn find(path: &Path, input: Input, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let log = open::open(path, input)?;
    match asked.args.raw {
        Some(raw) => raw::read(log, raw, asked.args.names),
        None => found(log, asked),
    }
}

fn found(mut log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let form = log.form()?;
    if form == LogForm::Other {
        log.input = wide::narrowed(log.path, log.input, log.room)?;
    }
    if let Some(table) = described(&log, form, asked)? {
        return tabular::read_described(log.path, table, log.room, asked);
    }
    if asked.args.only.is_some() && !matches!(form, LogForm::Other | LogForm::ArrowFile | LogForm::Parquet) {
        return Err(asked.args.only_of_tables(log.path));
    }
    match (reader(form), form.missing()) {
        (Some(read), _) => read(log, asked),
        (None, Some(missing)) => Err(InputError::not_built_in(log.path, missing).into()),
        (None, None) => read_table_or_text(log, asked),
    }
}

/// The reader of a form that needs a reader of its own, where it is built in.
fn reader(form: LogForm) -> Option<fn(Log<'_>, &ColumnQuery<'_>) -> Result<RawColumns>> {
    match form {
        LogForm::ArrowFile => Some(read_arrow_file),
        LogForm::ULog => Some(ulog::read),
        LogForm::DataFlash => Some(dataflash::read),
        #[cfg(feature = "hdf5")]
        LogForm::Hdf5 => Some(hdf5::read),
        #[cfg(feature = "matlab")]
        LogForm::Mat => Some(mat::read),
        #[cfg(feature = "mcap")]
        LogForm::Mcap => Some(mcap_bag::read),
        #[cfg(feature = "numpy")]
        LogForm::Npy => Some(npy::read),
        #[cfg(feature = "npz")]
        LogForm::Npz => Some(npz::read),
        #[cfg(feature = "parquet")]
        LogForm::Parquet => Some(parquet::read),
        #[cfg(feature = "ros")]
        LogForm::RosBag => Some(rosbag::read),
        #[cfg(feature = "sqlite")]
        LogForm::Sqlite => Some(sqlite_bag::read),
        _ => None,
    }
}

fn read_arrow_file(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let source = ArrowFile::open(log.path, log.input, log.room)?;
    tabular::read(log.path, Box::new(source), log.room, asked)
}

fn read_table_or_text(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let path = log.path;
    match open_table(path, log.input)? {
        Opened::Table(source) => tabular::read(path, source, log.room, asked),
        Opened::Other(input) => text::read(path, input, log.room, asked),
    }
}

/// The log as a table that describes itself, if it is one.
fn described(log: &Log<'_>, form: LogForm, asked: &ColumnQuery<'_>) -> Result<Option<Box<dyn DescribedTable>>> {
    let is_possible = form == LogForm::Other || form == LogForm::Parquet && form.missing().is_none();
    let Some(open) = asked.args.described.filter(|_| is_possible) else {
        let describes_itself = log.start.starts_with(format!("# {DESCRIPTION}").as_bytes());
        return if describes_itself { Err(tabular::needs_reader(log.path)) } else { Ok(None) };
    };
    let input = log.input.try_clone().map_err(|error| InputError::io("read", log.path, error))?;
    Ok(open(log.path, Source::File(input))?)
}
