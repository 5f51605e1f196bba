//! Applies a calibration to rates.

use crate::calibration::Calibration;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use zerorate::Correction;

/// Corrects rates, °/s, with the temperatures that were read with them, °C: RATE + PBC + d · (BTC + d · (BTC2 + d ·
/// BTC3)) with d = TEMP − T3.
///
/// The five coefficients are in the order of `Correction`. If the last two are zero, this is F-50.
///
/// Raises ValueError if the arrays differ in length.
#[pyfunction]
pub fn correct<'py>(
    py: Python<'py>,
    rate_dps: PyReadonlyArray1<'py, f64>,
    temp_c: PyReadonlyArray1<'py, f64>,
    coefficients: (f64, f64, f64, f64, f64),
) -> PyResult<Bound<'py, PyArray1<f64>>> {
    let (pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3) = coefficients;
    let correction = Correction { pbc_dps, btc_dps_per_c, t3_c, btc2_dps_per_c2, btc3_dps_per_c3 };
    let (rates, temps) = (rate_dps.as_slice()?, temp_c.as_slice()?);
    if rates.len() != temps.len() {
        let why = format!("{} rates and {} temperatures: give a temperature for each rate", rates.len(), temps.len());
        return Err(PyValueError::new_err(why));
    }
    let apply = || rates.iter().zip(temps).map(|(rate, temp)| correction.apply(*rate, *temp)).collect();
    Ok(PyArray1::from_vec(py, py.detach(apply)))
}

/// Corrects a stream of rates with the last temperature that was read.
#[pyclass(module = "zerorate._zerorate")]
pub struct Corrector {
    inner: zerorate::Corrector<Vec<Correction>>,
}

#[pymethods]
impl Corrector {
    /// A corrector for these axes of the calibration.
    ///
    /// Raises ValueError for an axis that the calibration does not have.
    #[new]
    fn new(calibration: &Calibration, axes: Vec<String>) -> PyResult<Self> {
        let known = &calibration.known;
        let inner = known.corrector(&known.part, axes.iter().map(String::as_str));
        Ok(Self { inner: inner.map_err(|error| PyValueError::new_err(error.to_string()))? })
    }

    /// Corrects rates, °/s, with the temperatures, °C, that were read at the same times. NaN marks a missing value.
    ///
    /// The rates hold all axes for each time, one time after the other. Returns the corrected rates, the temperatures
    /// used, and whether these temperatures lie outside the span of the calibration.
    ///
    /// Raises ValueError if there is not a rate of each axis for each temperature.
    fn take<'py>(
        &mut self,
        py: Python<'py>,
        rates_dps: PyReadonlyArray1<'py, f64>,
        temps_c: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<CorrectedArrays<'py>> {
        let (rates, temps) = (rates_dps.as_slice()?, temps_c.as_slice()?);
        if rates.len() != temps.len() * self.inner.axes() {
            let why = format!("{} rates and {} temperatures of {} axes", rates.len(), temps.len(), self.inner.axes());
            return Err(PyValueError::new_err(why));
        }
        let there = |value: f64| Some(value).filter(|value| !value.is_nan());
        let mut corrected = Vec::with_capacity(rates.len());
        let (mut used, mut outside) = (Vec::with_capacity(temps.len()), Vec::with_capacity(temps.len()));
        for (row, temp) in rates.chunks(self.inner.axes().max(1)).zip(temps) {
            self.inner.read(there(*temp));
            let rate = |(axis, rate): (usize, &f64)| self.inner.correct(axis, there(*rate)).unwrap_or(f64::NAN);
            corrected.extend(row.iter().enumerate().map(rate));
            used.push(self.inner.temp_c().unwrap_or(f64::NAN));
            outside.push(self.inner.is_extrapolated());
        }
        Ok((PyArray1::from_vec(py, corrected), PyArray1::from_vec(py, used), PyArray1::from_vec(py, outside)))
    }

    /// The warning if a temperature left the span of the calibration; None if none did.
    fn warning(&self) -> Option<String> {
        self.inner.warning().map(|warning| warning.to_string())
    }
}

/// Corrected rates, the temperatures used, and whether these temperatures lie outside the span of the calibration.
type CorrectedArrays<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>);
