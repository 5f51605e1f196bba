//! Captures and logs on disk.

use std::fs::File;
use std::path::Path;
use zerorate_data::capture::CaptureReader;
use zerorate_data::{CaptureError, Input};

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
