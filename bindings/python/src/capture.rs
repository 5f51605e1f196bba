//! Reads captures, and converts codes to °/s and °C.

use crate::error::exception;
use adis16130::Width;
use numpy::{Element, PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, ToPyArray};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};
use std::path::PathBuf;
use zerorate::{Axis, Part, Scale};
use zerorate_jobs::capture::{self, Recording};
use zerorate_record::CaptureWarning;

/// Reads a capture. Returns the fields of `zerorate.Capture`.
///
/// Raises ValueError if the file is not a capture or is damaged, and OSError if it cannot be read.
#[pyfunction]
pub fn read_capture(py: Python<'_>, path: PathBuf) -> PyResult<Bound<'_, PyDict>> {
    let recording = py.detach(|| capture::read_capture(&path)).map_err(|error| exception(&error))?;
    let capture = PyDict::new(py);
    capture.set_item("t_ns", recording.t_ns.to_pyarray(py))?;
    capture.set_item("edge_seq", recording.edge_seq.to_pyarray(py))?;
    set_axes(py, &capture, &recording)?;
    capture.set_item("lost", recording.lost.to_pyarray(py))?;
    let metadata = PyDict::new(py);
    recording.metadata.iter().try_for_each(|(key, value)| metadata.set_item(key, value))?;
    capture.set_item("metadata", metadata)?;
    capture.set_item("calibration_id", recording.calibration_id)?;
    let notes: Vec<String> = recording.notes.iter().map(CaptureWarning::coded).collect();
    capture.set_item("warning", (!notes.is_empty()).then(|| notes.join("; ")))?;
    Ok(capture)
}

/// The mark for a temperature that was not read, in parts other than the ADIS16130, for which −1 may be a code.
const NOT_READ: i64 = i64::MIN;

/// Adds the data of each axis. An ADIS16130 has columns in the type of its codes. Another part has tables with a
/// column for each axis, and the scales of its codes.
fn set_axes(py: Python<'_>, capture: &Bound<'_, PyDict>, recording: &Recording) -> PyResult<()> {
    let axes = &recording.axes;
    capture.set_item("axes", PyTuple::new(py, axes.iter().map(|axis| axis.name.as_str()))?)?;
    capture.set_item("width_bits", axes.first().map_or(0, |axis| axis.scale.width_bits))?;
    let temps = recording.temp_code.iter();
    if let ([axis], true) = (&axes[..], recording.part == Part::ADIS16130.name) {
        // codes have at most 24 bits, and the status has 8
        let codes = axis.codes.iter().map(|code| *code as u32);
        let status = recording.status.iter().map(|status| *status as i16);
        let temps = temps.map(|code| code.map_or(-1, |code| code as i32));
        capture.set_item("rate_code", PyArray1::from_iter(py, codes))?;
        capture.set_item("status", PyArray1::from_iter(py, status))?;
        capture.set_item("temp_code", PyArray1::from_iter(py, temps))?;
        return capture.set_item("flags", axis.flags.to_pyarray(py));
    }
    let codes: Vec<&[i64]> = axes.iter().map(|axis| &axis.codes[..]).collect();
    let flags: Vec<&[u8]> = axes.iter().map(|axis| &axis.flags[..]).collect();
    capture.set_item("rate_code", table(py, &codes, recording.t_ns.len())?)?;
    capture.set_item("flags", table(py, &flags, recording.t_ns.len())?)?;
    capture.set_item("status", recording.status.to_pyarray(py))?;
    capture.set_item("temp_code", PyArray1::from_iter(py, temps.map(|code| code.unwrap_or(NOT_READ))))?;
    let scales = axes.iter().map(|axis| (axis.scale.lsb_per_unit, axis.scale.zero_code));
    capture.set_item("rate_scales", PyTuple::new(py, scales.collect::<Vec<_>>())?)?;
    let temp = recording.temp.map(|temp| (temp.lsb_per_unit, temp.zero_code, temp.zero_value));
    capture.set_item("temp_scale", temp)
}

/// A table with a row for each sample and a column for each axis.
fn table<'py, T: Element + Copy>(py: Python<'py>, columns: &[&[T]], rows: usize) -> PyResult<Bound<'py, PyArray2<T>>> {
    let cells = (0..rows).flat_map(|row| columns.iter().map(move |column| column[row]));
    PyArray1::from_iter(py, cells).reshape([rows, columns.len()])
}

/// Converts rate codes of the ADIS16130 to °/s, without a correction (F-40).
#[pyfunction]
pub fn rate_dps<'py>(codes: PyReadonlyArray1<'py, u32>, width_bits: u32) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let width = width(width_bits)?;
    let rates: Vec<f64> = codes.as_slice()?.iter().map(|code| value(&Axis::ADIS16130.rate, *code, width)).collect();
    Ok(rates.to_pyarray(codes.py()))
}

/// Converts temperature codes of the ADIS16130 to °C (F-41). −1, which marks a missing temperature, gives NaN.
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

fn value(scale: &Scale, code: u32, width: Width) -> f64 {
    let scale = scale.without_low_bits(width.dropped_bits() as u8);
    scale.value(i64::from(code & width.max_code()) - scale.zero_code)
}

fn width(bits: u32) -> PyResult<Width> {
    [Width::Bits16, Width::Bits24]
        .into_iter()
        .find(|width| width.bits() == bits)
        .ok_or_else(|| PyValueError::new_err(format!("a code has 16 or 24 bits, not {bits}")))
}
