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

/// The exception for an error: [`Refused`], an `OSError` where the system said no, else a `ValueError`. The text is
/// that of the command line.
pub fn exception(error: &anyhow::Error) -> PyErr {
    let text = format!("{error:#}");
    if error.is::<zerorate_jobs::Refused>() || matches!(error.downcast_ref(), Some(LogError::Refused(..))) {
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
