//! Calibrations and what they do to a rate.

use crate::error::exception;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use zerorate::{Calibration, Correction};
use zerorate_cli::api;

/// Reads a calibration file out of its text. Returns it as JSON, its id, and what there is to know of it.
///
/// Raises ValueError with the line that is wrong.
#[pyfunction]
pub fn parse_calibration(text: &str) -> PyResult<(String, String, Vec<String>)> {
    let (calibration, warnings) = parse(text)?;
    let json = serde_json::to_string(&calibration).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok((json, calibration.id(), warnings))
}

/// Writes the text of a calibration file to ``path``: whole, onto the disk, and over another file only with ``force``.
///
/// Raises FileExistsError where it would overwrite one, OSError where it cannot be written.
#[pyfunction]
pub fn save_calibration(path: PathBuf, text: &str, force: bool) -> PyResult<()> {
    api::save_calibration(&path, text, force).map_err(|error| exception(&error))
}

/// What to say where temperatures from ``low_c`` to ``high_c`` leave the span of the calibration in ``text``.
#[pyfunction]
pub fn extrapolation(text: &str, low_c: f64, high_c: f64) -> PyResult<Option<String>> {
    Ok(api::extrapolation(&parse(text)?.0, low_c, high_c))
}

fn parse(text: &str) -> PyResult<(Calibration, Vec<String>)> {
    let (calibration, warnings) =
        Calibration::parse(text).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok((calibration, warnings.iter().map(ToString::to_string).collect()))
}

/// RATE + PBC + (TEMP − T3) · BTC (F-50) for each pair of a rate, °/s, and the temperature that was read with it, °C.
///
/// Raises ValueError if the arrays differ in length.
#[pyfunction]
pub fn correct<'py>(
    py: Python<'py>,
    rate_dps: PyReadonlyArray1<'py, f64>,
    temp_c: PyReadonlyArray1<'py, f64>,
    pbc_dps: f64,
    btc_dps_per_c: f64,
    t3_c: f64,
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let correction = Correction { pbc_dps, btc_dps_per_c, t3_c };
    let (rates, temps) = (rate_dps.as_slice()?, temp_c.as_slice()?);
    if rates.len() != temps.len() {
        let why = format!("{} rates and {} temperatures: give a temperature for each rate", rates.len(), temps.len());
        return Err(PyValueError::new_err(why));
    }
    let apply = || rates.iter().zip(temps).map(|(rate, temp)| correction.apply(*rate, *temp)).collect();
    Ok(PyArray1::from_vec(py, py.detach(apply)))
}
