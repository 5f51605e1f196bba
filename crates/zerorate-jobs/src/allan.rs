//! The noise of columns of logs.

use crate::temperature;
use anyhow::Result;
use std::path::{Path, PathBuf};
use zerorate_host::files;
use zerorate_imu::{AnalysisOptions, Record, RecordError, increments};
use zerorate_logs::{Column, ColumnOptions, ColumnSelection};

/// The columns of logs to analyse, and the options of the analysis.
pub struct AllanOptions {
    /// The columns of each log.
    pub columns: Columns,
    /// Facts that the logs do not state.
    pub log: ColumnOptions,
    /// The column with the temperature; none: one by the usual names.
    pub temperature: Option<String>,
    /// The options of the analysis of each.
    pub analysis: AnalysisOptions,
}

/// Columns of a log.
pub enum Columns {
    /// The one that its options name, or the only one.
    Single,
    /// The columns with these names.
    Listed(Vec<String>),
    /// All columns of numbers.
    All,
}

/// Analyses columns of each of these logs, one pass over each.
///
/// # Errors
/// Returns an error if a log cannot be read, or a column cannot be analysed.
pub fn allan(logs: &[PathBuf], options: &AllanOptions) -> Result<Vec<Record>> {
    let wanted = match &options.columns {
        Columns::Single => ColumnSelection::One(options.log.column.as_deref()),
        Columns::Listed(names) => ColumnSelection::Listed(names),
        Columns::All => ColumnSelection::All,
    };
    let mut records = Vec::new();
    for log in logs {
        let (columns, found) = zerorate_logs::read_with_temperature(log, files::log(log)?, wanted, &options.log)?;
        if !options.analysis.is_phase {
            increments::ask(log, &columns.iter().collect::<Vec<_>>(), &options.log)?;
        }
        let named = options.temperature.as_deref();
        let temperature = temperature::required(log, named, found, &options.analysis.detrending, &options.log)?;
        records.extend(analysed(log, columns, temperature, &options.analysis)?);
    }
    Ok(records)
}

/// Analyses columns of a log that were read, with its temperature.
pub(crate) fn analysed(
    log: &Path,
    columns: Vec<Column>,
    temperature: Option<Column>,
    options: &AnalysisOptions,
) -> Result<Vec<Record>> {
    // the integral of a rate does not follow it
    let temperature = temperature.as_ref().filter(|_| !options.is_phase);
    columns.into_iter().map(|column| Record::of(column, log, options, temperature).map_err(failed)).collect()
}

/// Sorts failures into the kinds that front ends tell apart.
fn failed(error: RecordError) -> anyhow::Error {
    match error {
        RecordError::Log(error) => error.into(),
        error => error.into(),
    }
}
