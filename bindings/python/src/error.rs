//! Converts errors of the Rust crates to exceptions of Python.

use pyo3::exceptions::{
    PyFileExistsError, PyFileNotFoundError, PyIsADirectoryError, PyOSError, PyPermissionError, PyValueError,
};
use pyo3::prelude::*;
use std::error::Error;
use std::io::{self, ErrorKind};
use zerorate_host::{Cause, DeviceError};
use zerorate_input::InputError;
use zerorate_jobs::output::{OutputError, could_be_forced, is_refusal};
use zerorate_logs::LogError;
use zerorate_record::CaptureError;

pyo3::import_exception!(zerorate._errors, ZerorateError);
pyo3::import_exception!(zerorate._errors, Refused);

/// The exception for an error: [`Refused`], [`ZerorateError`] for a device, an `OSError` for an error of the system,
/// otherwise a `ValueError`. The text is the same as on the command line, but names arguments.
pub fn exception(error: &anyhow::Error) -> PyErr {
    let text = joined(&format!("{error:#}"));
    if error.is::<zerorate_jobs::CodedRefusal>() || matches!(error.downcast_ref(), Some(LogError::Refused(..))) {
        return Refused::new_err(text);
    }
    if is_refusal(error) {
        let remedy = if could_be_forced(error) { ", or give force=True" } else { "" };
        return PyFileExistsError::new_err(text + remedy);
    }
    if error.chain().any(is_folder) {
        return PyIsADirectoryError::new_err(text);
    }
    if let Some(OutputError::NoFolder { .. }) = error.chain().find_map(|cause| cause.downcast_ref()) {
        return PyFileNotFoundError::new_err(text);
    }
    match error.chain().find_map(|cause| cause.downcast_ref()).map(DeviceError::cause) {
        Some(Cause::Refused(_)) => return Refused::new_err(text),
        // a recording that is read in place of a device fails like any other file
        None | Some(Cause::Request | Cause::File) => {}
        Some(_) => return ZerorateError::new_err(text),
    }
    match error.chain().find_map(|cause| cause.downcast_ref::<io::Error>()).map(io::Error::kind) {
        None => PyValueError::new_err(text),
        Some(ErrorKind::NotFound) => PyFileNotFoundError::new_err(text),
        Some(ErrorKind::AlreadyExists) => PyFileExistsError::new_err(text),
        Some(ErrorKind::PermissionDenied) => PyPermissionError::new_err(text),
        Some(_) => PyOSError::new_err(text),
    }
}

/// True if a folder was given where a file is wanted, to read or to write.
fn is_folder(cause: &(dyn Error + 'static)) -> bool {
    let log = cause
        .downcast_ref()
        .is_some_and(|error| matches!(error, LogError::File(InputError::NotALog { path, .. }) if path.is_dir()));
    let capture = cause
        .downcast_ref()
        .is_some_and(|error| matches!(error, CaptureError::NotACapture { path, .. } if path.is_dir()));
    log || capture || matches!(cause.downcast_ref(), Some(OutputError::Folder { .. }))
}

/// Joins arguments and their values as Python writes them: `divider=4` for `divider= 4` and for `divider= is 4`.
pub fn joined(text: &str) -> String {
    let mut parts = text.split('=');
    let mut written = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let is_number = |value: &&str| value.starts_with(|c: char| c.is_ascii_digit() || c == '-');
        let value = part.strip_prefix(" is ").or_else(|| part.strip_prefix(' ')).filter(is_number);
        let is_argument = written.ends_with(|c: char| c.is_ascii_lowercase());
        written.push('=');
        written.push_str(value.filter(|_| is_argument).unwrap_or(part));
    }
    written
}
