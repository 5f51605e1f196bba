//! Errors as exceptions.

use pyo3::create_exception;
use pyo3::exceptions::{PyFileExistsError, PyFileNotFoundError, PyOSError, PyPermissionError, PyValueError};
use pyo3::prelude::*;
use std::io::{self, ErrorKind};
use zerorate_jobs::output::{could_be_forced, is_refusal};
use zerorate_logs::LogError;

create_exception!(
    _zerorate,
    Refused,
    PyValueError,
    "The measurement was refused: there are numbers, but they must not become a calibration. The text says why and \
     what to do."
);

/// The exception for an error: [`Refused`], an `OSError` for an error of the system, otherwise a `ValueError`. The
/// text is the same as on the command line, but names arguments.
pub fn exception(error: &anyhow::Error) -> PyErr {
    let text = joined(&format!("{error:#}"));
    if error.is::<zerorate_jobs::CodedRefusal>() || matches!(error.downcast_ref(), Some(LogError::Refused(..))) {
        return Refused::new_err(text);
    }
    if is_refusal(error) {
        let remedy = if could_be_forced(error) { ", or give force=True" } else { "" };
        return PyFileExistsError::new_err(text + remedy);
    }
    match error.chain().find_map(|cause| cause.downcast_ref::<io::Error>()).map(io::Error::kind) {
        None => PyValueError::new_err(text),
        Some(ErrorKind::NotFound) => PyFileNotFoundError::new_err(text),
        Some(ErrorKind::AlreadyExists) => PyFileExistsError::new_err(text),
        Some(ErrorKind::PermissionDenied) => PyPermissionError::new_err(text),
        Some(_) => PyOSError::new_err(text),
    }
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
