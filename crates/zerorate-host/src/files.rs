//! Captures and logs on disk.

use std::fs::File;
use std::path::Path;
use zerorate::Part;
use zerorate_data::capture::CaptureReader;
use zerorate_data::column::ColumnOptions;
use zerorate_data::{CaptureError, Input, LogError, RowReader};

/// Opens a file to be read.
///
/// # Errors
/// Why that cannot be.
pub fn open(path: &Path) -> Result<Input, CaptureError> {
    let file = File::open(path).map_err(|error| CaptureError::io("read", path, error))?;
    Ok(file.into())
}

/// Opens a capture, in any of its forms.
///
/// # Errors
/// Why that cannot be, or what is wrong with its description.
pub fn capture(path: &Path) -> Result<CaptureReader, CaptureError> {
    CaptureReader::open(path, open(path)?)
}

/// Opens a capture, or a log of the part that is given (docs/formats/part.md).
///
/// # Errors
/// Why that cannot be, or what is wrong with it.
pub fn rows(path: &Path, part: Option<&Part>) -> Result<RowReader, LogError> {
    RowReader::open(path, open(path)?, part, &ColumnOptions::default())
}
