//! Noise analysis of columns of logs.

use crate::temperature;
use anyhow::Result;
use std::path::{Path, PathBuf};
use zerorate_host::files;
use zerorate_imu::{AnalysisOptions, Record, RecordError, implausible_rates, increments};
use zerorate_logs::{Column, ColumnOptions, ColumnSelection, LogWarning};

/// The columns of logs to analyse, and the options of the analysis.
pub struct AllanOptions {
    /// The columns of each log.
    pub columns: Columns,
    /// Facts that the logs do not state, such as unit and sampling rate.
    pub log: ColumnOptions,
    /// The temperature column; `None` looks for a column with a usual name.
    pub temperature: Option<String>,
    /// The analysis options, the same for each column.
    pub analysis: AnalysisOptions,
}

/// Selects columns of a log.
pub enum Columns {
    /// The column that [`AllanOptions::log`] names, or else the rate of a capture, or the only column of a log.
    Single,
    /// The columns with these names.
    Listed(Vec<String>),
    /// All numeric columns that change.
    All,
}

/// Analyses the selected columns of each log, in one pass over each log.
///
/// # Errors
/// Returns an error if a log cannot be read or lacks a required temperature, or a column cannot be analysed.
pub fn allan(logs: &[PathBuf], options: &AllanOptions) -> Result<Vec<Record>> {
    let wanted = match &options.columns {
        Columns::Single => ColumnSelection::One(options.log.column.as_deref()),
        Columns::Listed(names) => ColumnSelection::Listed(names),
        Columns::All => ColumnSelection::All,
    };
    let mut records = Vec::new();
    for log in logs {
        let (mut columns, found) = zerorate_logs::read_with_temperature(log, files::log(log)?, wanted, &options.log)?;
        if let Columns::All = options.columns {
            leave_out_constants(log, &mut columns);
        }
        if !options.analysis.is_phase {
            increments::ask(log, &columns.iter().collect::<Vec<_>>(), &options.log)?;
            let doubts = implausible_rates(log, &columns, &options.log);
            if let Some(first) = columns.first_mut() {
                first.warnings.extend(doubts);
            }
        }
        let named = options.temperature.as_deref();
        let temperature = temperature::required(log, named, found, &options.analysis.detrending, &options.log)?;
        records.extend(analysed(log, columns, temperature, &options.analysis)?);
    }
    Ok(records)
}

/// Leaves out the columns that never change, such as flags, unless none changes.
fn leave_out_constants(log: &Path, columns: &mut Vec<Column>) {
    let is_constant = |column: &Column| column.stopped(log).is_err();
    let names: Vec<&str> = columns.iter().filter(|column| is_constant(column)).map(|column| &*column.name).collect();
    if names.is_empty() || names.len() == columns.len() {
        return;
    }
    let (path, names) = (log.display().to_string(), names.join(", "));
    columns.retain(|column| !is_constant(column));
    columns[0].warnings.push(LogWarning::ConstantsLeftOut { path, names });
}

pub(crate) fn analysed(
    log: &Path,
    columns: Vec<Column>,
    temperature: Option<Column>,
    options: &AnalysisOptions,
) -> Result<Vec<Record>> {
    // An angle (an integrated rate) does not follow the temperature; only the rate does.
    let temperature = temperature.as_ref().filter(|_| !options.is_phase);
    columns.into_iter().map(|column| Record::of(column, log, options, temperature).map_err(failed)).collect()
}

/// Unwraps the errors of logs, so that front ends can distinguish them from errors of the analysis.
fn failed(error: RecordError) -> anyhow::Error {
    match error {
        RecordError::Log(error) => error.into(),
        error => error.into(),
    }
}
