//! The twin: its name as a device, and its keys.

use adis16130_twin::{KEYS, Key, Spec};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The name of a twin as a device: ``twin:KEY=VALUE,…``.
///
/// Raises ValueError for a key or a value that the twin does not have.
#[pyfunction]
pub fn twin_device(keys: &str) -> PyResult<String> {
    Spec::parse_keys(keys).map_err(|error| PyValueError::new_err(error.to_string()))?;
    Ok(format!("twin:{keys}"))
}

/// The keys of a twin: name, default and allowed values in words, and description.
#[pyfunction]
pub fn twin_keys() -> Vec<(&'static str, &'static str, String, &'static str)> {
    KEYS.iter().map(|key| (key.name, key.default, Key::allowed(key), key.help)).collect()
}
