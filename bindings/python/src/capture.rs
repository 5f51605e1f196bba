//! Captures, and codes in units.

use crate::error::exception;
use adis16130::Width;
use numpy::{PyArray1, PyReadonlyArray1, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;
use zerorate::{Axis, Scale};
use zerorate_cli::api;

/// Reads a capture. Returns its columns, and its description under ``width_bits``, ``metadata``, ``calibration_id``
/// and ``warning``.
///
/// Raises ValueError for a file that is no whole capture, OSError for one that cannot be read.
#[pyfunction]
pub fn read_capture(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let recording = py.detach(|| api::read_capture(&path)).map_err(|error| exception(&error))?;
    let capture = PyDict::new(py);
    capture.set_item("t_ns", PyArray1::from_vec(py, recording.t_ns))?;
    capture.set_item("edge_seq", PyArray1::from_vec(py, recording.edge_seq))?;
    capture.set_item("rate_code", PyArray1::from_vec(py, recording.rate_code))?;
    capture.set_item("status", PyArray1::from_vec(py, recording.status))?;
    capture.set_item("temp_code", PyArray1::from_vec(py, recording.temp_code))?;
    capture.set_item("lost", PyArray1::from_vec(py, recording.lost))?;
    capture.set_item("flags", PyArray1::from_vec(py, recording.flags))?;
    capture.set_item("width_bits", recording.width_bits)?;
    let metadata = PyDict::new(py);
    recording.metadata.iter().try_for_each(|(key, value)| metadata.set_item(key, value))?;
    capture.set_item("metadata", metadata)?;
    capture.set_item("calibration_id", recording.calibration_id)?;
    capture.set_item("warning", recording.warning)?;
    Ok(capture)
}

/// Rate codes in °/s, before any correction (F-40).
#[pyfunction]
pub fn rate_dps<'py>(codes: PyReadonlyArray1<'py, u32>, width_bits: u32) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let width = width(width_bits)?;
    let rates: Vec<f64> = codes.as_slice()?.iter().map(|code| value(&Axis::ADIS16130.rate, *code, width)).collect();
    Ok(rates.to_pyarray(codes.py()))
}

/// Temperature codes in °C (F-41); NaN for −1, which stands for a temperature that was not read.
#[pyfunction]
pub fn temp_c<'py>(codes: PyReadonlyArray1<'py, i32>, width_bits: u32) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let width = width(width_bits)?;
    let in_c = |code: &i32| match u32::try_from(*code) {
        Ok(code) => value(&Axis::ADIS16130.temp, code, width),
        Err(_) => f64::NAN,
    };
    let temps: Vec<f64> = codes.as_slice()?.iter().map(in_c).collect();
    Ok(temps.to_pyarray(codes.py()))
}

/// F-43: a 16-bit code counts as 256 of 24 bits.
fn value(scale: &Scale, code: u32, width: Width) -> f64 {
    scale.value((i64::from(code & width.max_code()) << (scale.width_bits - width.bits() as u8)) - scale.zero_code)
}

fn width(bits: u32) -> PyResult<Width> {
    [Width::Bits16, Width::Bits24]
        .into_iter()
        .find(|width| width.bits() == bits)
        .ok_or_else(|| PyValueError::new_err(format!("a code has 16 or 24 bits, not {bits}")))
}
