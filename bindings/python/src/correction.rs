//! Calibrations and what they do to a rate.

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::{Value, json};
use zerorate::calibration::CalibratedAxis;
use zerorate::{Calibration, Correction, Scale};

/// Keys of the file that belong to an axis, or are called otherwise in Python.
const OF_AXES: [&str; 7] = ["axis", "temperature", "correction", "measured", "uncertainty", "curve", "noise"];

/// Reads a calibration file out of its text. Returns it as JSON, in one form for both schemas, its id, and what there
/// is to know of it.
///
/// Raises ValueError with the line that is wrong.
#[pyfunction]
pub fn parse_calibration(text: &str) -> PyResult<(String, String, Vec<String>)> {
    let (calibration, warnings) = parse(text)?;
    let mut fields = serde_json::to_value(&calibration).map_err(|error| PyValueError::new_err(error.to_string()))?;
    if let Some(fields) = fields.as_object_mut() {
        fields.retain(|key, _| !OF_AXES.contains(&key.as_str()));
        fields.insert("temp".to_owned(), calibration.temp.as_ref().map_or(Value::Null, scale));
        fields.insert("axes".to_owned(), calibration.axes.iter().map(axis).collect());
    }
    Ok((fields.to_string(), calibration.id(), warnings))
}

fn axis(axis: &CalibratedAxis) -> Value {
    json!({
        "name": axis.name,
        "warnings": axis.warnings,
        "rate": axis.rate.as_ref().map(scale),
        "correction": axis.correction,
        "measured": axis.measured,
        "uncertainty": axis.uncertainty,
        "curve": axis.curve,
        "noise": axis.noise,
    })
}

fn scale(of: &Scale) -> Value {
    let Scale { lsb_per_unit, zero_code, zero_value, width_bits, signed } = of;
    json!({
        "lsb_per_unit": lsb_per_unit,
        "zero_code": zero_code,
        "zero_value": zero_value,
        "width_bits": width_bits,
        "signed": signed,
    })
}

/// What to say where temperatures from ``low_c`` to ``high_c`` leave the span of the calibration in ``text``.
#[pyfunction]
pub fn extrapolation(text: &str, low_c: f64, high_c: f64) -> PyResult<Option<String>> {
    let (calibration, _) = parse(text)?;
    let warning = calibration.validity.and_then(|validity| validity.warning(low_c, high_c));
    Ok(warning.map(|warning| warning.to_string()))
}

fn parse(text: &str) -> PyResult<(Calibration, Vec<String>)> {
    let (calibration, warnings) =
        Calibration::parse(text).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok((calibration, warnings.iter().map(ToString::to_string).collect()))
}

/// RATE + PBC + d · (BTC + d · (BTC2 + d · BTC3)) with d = TEMP − T3 (F-50 where the last two are zero) for each pair
/// of a rate, °/s, and the temperature that was read with it, °C; the five coefficients in the order of `Correction`.
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

/// Corrects a stream of rates with the temperature that was read last.
#[pyclass(module = "zerorate._zerorate")]
pub struct Corrector {
    inner: zerorate::Corrector<Vec<Correction>>,
}

#[pymethods]
impl Corrector {
    /// Of these axes of the calibration in ``text``.
    ///
    /// Raises ValueError for an axis that it does not have.
    #[new]
    fn new(text: &str, axes: Vec<String>) -> PyResult<Self> {
        let (calibration, _) = parse(text)?;
        let inner = calibration.corrector(&calibration.part, axes.iter().map(String::as_str));
        Ok(Self { inner: inner.map_err(|error| PyValueError::new_err(error.to_string()))? })
    }

    /// Corrects rates, °/s, of all axes for each time, one time after the other, with the temperatures, °C, that were
    /// read at these times; NaN is none. Returns the corrected rates, the temperatures used, and whether these lie
    /// outside the span.
    ///
    /// Raises ValueError if there is not a rate of each axis for each temperature.
    fn take<'py>(
        &mut self,
        py: Python<'py>,
        rates_dps: PyReadonlyArray1<'py, f64>,
        temps_c: PyReadonlyArray1<'py, f64>,
    ) -> PyResult<Taken<'py>> {
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

    /// What to say where a temperature left the span.
    fn warning(&self) -> Option<String> {
        self.inner.warning().map(|warning| warning.to_string())
    }
}

/// Corrected rates, the temperatures used, and whether they lie outside the span.
type Taken<'py> = (Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>);
