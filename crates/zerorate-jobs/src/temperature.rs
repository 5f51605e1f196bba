//! Finds the temperature column of a log.

use crate::InvalidOptions;
use std::path::Path;
use zerorate_host::files;
use zerorate_imu::Detrending;
use zerorate_logs::{Column, ColumnOptions, ColumnSelection, Setting, TEMPERATURE_NAMES};

/// The temperature of the log at `path`: the column `name` or, if that is `None`, a column with a usual name. `None`
/// if there is no such column, or if it cannot be read. The unit and scale in `options` are for other columns and do
/// not apply to the temperature.
#[must_use]
pub fn of_log(path: &Path, name: Option<&str>, options: &ColumnOptions) -> Option<Column> {
    let options = ColumnOptions { column: None, unit: None, scale: None, ..options.clone() };
    let bytes = files::open(path).ok();
    zerorate_logs::temperature(name, bytes, |names| {
        zerorate_logs::read_parts(path, files::log(path)?, ColumnSelection::Listed(names), &options)
    })
}

/// Like [`of_log`], but without a `name` uses a temperature that was already `found`. Checks that a needed one exists.
///
/// # Errors
/// Returns an error if the log has no temperature, but a column was named or `detrending` fits a polynomial over it.
pub fn required(
    path: &Path,
    name: Option<&str>,
    found: Option<Column>,
    detrending: &Detrending,
    options: &ColumnOptions,
) -> Result<Option<Column>, InvalidOptions> {
    let column = found.filter(|_| name.is_none()).or_else(|| of_log(path, name, options));
    let [by_name, detrend] = [Setting::TempColumn, Setting::Detrend].map(|setting| detrending.names.of(setting));
    let file = path.display();
    match (&column, name) {
        (None, Some(name)) => Err(InvalidOptions(format!("{by_name}: {file} has no column {name:?} of numbers"))),
        (None, None) if detrending.order.is_some() => {
            let names = TEMPERATURE_NAMES.join(", ");
            Err(InvalidOptions(format!("{detrend}: {file} has no column {names}; name it by {by_name}")))
        }
        _ => Ok(column),
    }
}
