//! The compiled part of `zerorate.Calibration`.

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pythonize::pythonize;
use serde_json::{Value, json};
use zerorate::Scale;
use zerorate::calibration::CalibratedAxis;
use zerorate_view::report::calibration_picture;

/// Keys of the file that `fields` leaves out: they belong to an axis, or have another name in Python.
const OF_AXES: [&str; 7] = ["axis", "temperature", "correction", "measured", "uncertainty", "curve", "noise"];

/// A calibration and the text of its file.
#[pyclass(frozen, module = "zerorate._zerorate")]
pub struct Calibration {
    pub known: zerorate::Calibration,
    #[pyo3(get)]
    text: String,
    /// Warnings about the file.
    #[pyo3(get)]
    notes: Vec<String>,
}

impl Calibration {
    pub fn of(known: zerorate::Calibration) -> Self {
        Self { text: known.to_toml(), known, notes: Vec::new() }
    }
}

#[pymethods]
impl Calibration {
    /// Reads a calibration from the text of its file.
    ///
    /// Raises ValueError if the text is not a valid calibration. The error names the wrong line.
    #[new]
    fn new(text: String) -> PyResult<Self> {
        let parsed = zerorate::Calibration::parse(&text);
        let (known, warnings) = parsed.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(Self { known, text, notes: warnings.iter().map(ToString::to_string).collect() })
    }

    /// Short identifier of the calibration: 12 hexadecimal digits.
    #[getter]
    fn id(&self) -> String {
        self.known.id()
    }

    /// The fields of the file as arguments of the data classes. They are the same for all schemas of the file.
    #[getter]
    fn fields<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let mut fields =
            serde_json::to_value(&self.known).map_err(|error| PyValueError::new_err(error.to_string()))?;
        if let Some(fields) = fields.as_object_mut() {
            fields.retain(|key, _| !OF_AXES.contains(&key.as_str()));
            fields.insert("temp".to_owned(), self.known.temp.as_ref().map_or(Value::Null, scale));
            fields.insert("axes".to_owned(), self.known.axes.iter().map(axis).collect());
        }
        Ok(pythonize(py, &fields)?)
    }

    /// The warning if the temperatures ``low_c`` to ``high_c`` leave the span of the calibration, else None.
    fn extrapolation(&self, low_c: f64, high_c: f64) -> Option<String> {
        let warning = self.known.validity.and_then(|validity| validity.warning(low_c, high_c));
        warning.map(|warning| warning.to_string())
    }

    /// The correction of each axis over temperature, as SVG.
    fn pictures(&self) -> Vec<String> {
        let axes = self.known.axes.iter();
        axes.map(|axis| calibration_picture(&self.known, axis)).collect()
    }
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
