//! Checks of a record in memory, which no reader of logs has seen.

use crate::column_checks::ColumnChecks;
use crate::series::Series;
use crate::unsigned;
use crate::warning::LogWarning;
use std::path::Path;
use zerorate_allan::Input;

/// Checks the samples of a record. Returns the record with the sign of its codes, if
/// they were written without one, and the warnings. `path` and `name` name the record in messages.
#[must_use]
pub fn check_record(input: &Input<'_>, path: &Path, name: &str) -> (Option<Series>, Vec<LogWarning>) {
    let unwrapped = unsigned::unwrapped(input);
    let signed = unwrapped.as_ref().map_or(*input, |(series, _)| series.input(&[]));
    let (mut warnings, _) = ColumnChecks::of(&signed).finish(path, name);
    let unsigned = |(series, bits)| {
        warnings
            .insert(0, LogWarning::CodesUnsigned { path: path.display().to_string(), column: name.to_owned(), bits });
        series
    };
    (unwrapped.map(unsigned), warnings)
}
