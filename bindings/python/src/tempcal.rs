//! The bias over temperature of the axes in logs of one unit.

use crate::calibration::Calibration;
use crate::error::{exception, joined};
use crate::log::{OfCodes, OfKind, Options, Source, argument, code_options, imu_options, opened};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use zerorate_allan::SettingName;
use zerorate_jobs::tempcal::{Tempcal, TempcalOptions, UnitLog, tempcal as found};
use zerorate_logs::{Names, Setting};
use zerorate_view::tempcal::{AxisCurve, Points, ardupilot, px4};

/// The name of the part in the calibration, the same as in `zerorate tempcal`.
const PART: &str = "gyroscope";

/// Fits the bias over temperature of all axes. Returns a dictionary: ``axes``, ``warnings``, and the files
/// ``calibration``, ``px4`` and ``ardupilot``. Each file is a pair of the file and the reason why it cannot be made;
/// one of the two is None.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the keywords of zerorate.tempcal")]
pub fn tempcal<'py>(
    py: Python<'py>,
    sources: Vec<Source<'py>>,
    names: Option<Vec<String>>,
    gyro: OfKind,
    accel: OfKind,
    codes: OfCodes,
    temp_column: Option<String>,
    reference_c: Option<f64>,
    max_u_dps: Option<f64>,
    serial: Option<String>,
    options: Options,
) -> PyResult<Bound<'py, PyDict>> {
    let mut axes = imu_options(names, gyro, accel, &options)?;
    axes.log.names = Names(name);
    let options =
        TempcalOptions { axes, codes: code_options(codes)?, temperature: temp_column, reference_c, max_u_dps };
    let logs = sources.into_iter().map(opened).collect::<PyResult<Vec<UnitLog>>>()?;
    let found = py.detach(|| found(&logs, &options)).map_err(|error| exception(&error))?;
    let result = PyDict::new(py);
    let axes = found.axes.iter().zip(&found.points).map(|(curve, points)| axis(py, curve, points));
    result.set_item("axes", axes.collect::<PyResult<Vec<_>>>()?)?;
    result.set_item("warnings", found.notes.iter().map(|note| joined(note)).collect::<Vec<_>>())?;
    result.set_item("calibration", calibration(&found, serial, &logs))?;
    let texts = [("px4", px4(&found.axes)), ("ardupilot", ardupilot(&found.axes))];
    for (format, text) in texts {
        result.set_item(format, made(text.map_err(|why| why.0)))?;
    }
    Ok(result)
}

/// The name of a setting as an argument of `zerorate.tempcal`, for messages.
fn name(setting: Setting) -> SettingName {
    match setting {
        Setting::TempColumn => SettingName::text("temp_column="),
        other => argument(other),
    }
}

fn calibration(found: &Tempcal, serial: Option<String>, logs: &[UnitLog]) -> (Option<Calibration>, Option<String>) {
    let calibration = found.calibration(PART, serial, logs).map(Calibration::of);
    made(calibration.map_err(|error| joined(&format!("{error:#}"))))
}

fn made<T>(result: Result<T, String>) -> (Option<T>, Option<String>) {
    match result {
        Ok(made) => (Some(made), None),
        Err(why) => (None, Some(why)),
    }
}

/// The dictionary of an axis: the keys of `zerorate tempcal --json`, with the curve and the means as arrays.
fn axis<'py>(py: Python<'py>, axis: &AxisCurve, points: &Points) -> PyResult<Bound<'py, PyAny>> {
    let result = pythonize(py, axis)?;
    let values: Vec<(f64, f64, f64)> = axis.curve.iter().map(|point| point.values()).collect();
    let curve = PyDict::new(py);
    curve.set_item("temp_c", PyArray1::from_iter(py, values.iter().map(|(temp_c, ..)| *temp_c)))?;
    curve.set_item("bias", PyArray1::from_iter(py, values.iter().map(|(_, bias, _)| *bias)))?;
    curve.set_item("u", PyArray1::from_iter(py, values.iter().map(|(.., u)| *u)))?;
    result.set_item("curve", curve)?;
    let means = PyDict::new(py);
    means.set_item("at_s", PyArray1::from_iter(py, points.all.iter().map(|point| point.at_s)))?;
    means.set_item("temp_c", PyArray1::from_iter(py, points.all.iter().map(|point| point.temp_c)))?;
    means.set_item("bias", PyArray1::from_iter(py, points.all.iter().map(|point| point.value)))?;
    means.set_item("left", PyArray1::from_iter(py, points.all.iter().map(|point| point.left)))?;
    means.set_item("is_warming", PyArray1::from_iter(py, points.all.iter().map(|point| point.is_warming)))?;
    result.set_item("means", means)?;
    Ok(result)
}
