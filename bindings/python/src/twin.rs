//! The twin, and the procedure on it.

use crate::error::exception;
use adis16130_twin::{KEYS, Key, Spec};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use zerorate::Setting;
use zerorate_cli::api::{self, Calibrated};

/// The name of a twin as a device, ``twin:KEY=VALUE,…``.
///
/// Raises ValueError for a key or a value that the twin does not have.
#[pyfunction]
pub fn twin_device(keys: &str) -> PyResult<String> {
    Spec::parse_keys(keys).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(format!("twin:{keys}"))
}

/// The keys of a twin: name, default and allowed values in words, and what it is.
#[pyfunction]
pub fn twin_keys() -> Vec<(&'static str, &'static str, String, &'static str)> {
    KEYS.iter().map(|key| (key.name, key.default, Key::allowed(key), key.help)).collect()
}

/// What a setting is called in ``zerorate.calibrate``.
fn argument(setting: Setting) -> &'static str {
    match setting {
        Setting::Average => "average=",
        Setting::WarmUp => "warmup=",
        Setting::Settle => "settle=",
        Setting::Offset => "offset=",
        Setting::MaxLost => "max_lost=",
        Setting::MaxUBtc => "max_u_btc=",
        Setting::Earth => "earth_dps=",
        Setting::AssumeLinear => "assume_linear=True",
        Setting::EveryTemp => "every_temp=",
        Setting::Divider => "divider=",
        other => other.name(),
    }
}

/// Runs the procedure with the options of ``zerorate calibrate``. Returns its JSON report and the calibration file.
///
/// Other threads run meanwhile. Ctrl-C ends it.
#[pyfunction]
pub fn calibrate(py: Python<'_>, options: Vec<String>) -> PyResult<(String, String)> {
    let mut signal = Ok(());
    let done = py.detach(|| {
        api::calibrate(&options, argument, || {
            signal = Python::attach(|py| py.check_signals());
            signal.is_ok()
        })
    });
    signal?;
    let Calibrated { report_json, calibration_toml } = done.map_err(|error| exception(&error))?;
    Ok((report_json, calibration_toml))
}
