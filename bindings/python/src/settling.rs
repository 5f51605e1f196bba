//! The temperature of a record, and its beginning: as `zerorate allan` does it.

use crate::error::exception;
use crate::log::argument;
use crate::record::Record;
use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::Path;
use zerorate_allan::{AllanWarning, Detrended, Gap, Input, Settled};
use zerorate_logs::{self as logs, Column, Names, Series};

/// What messages call a record in memory.
const RECORD: &str = "the record";

/// What is known of the temperature of a record, and what is done about it and about its beginning.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Settling<'py> {
    /// For each sample, °C; NaN where it is missing.
    temps_c: Option<PyReadonlyArray1<'py, f64>>,
    detrend: Option<usize>,
    skip: String,
}

impl Settling<'_> {
    /// Does it to a record. Returns what is left, and what came of it.
    pub fn apply(
        &self,
        py: Python<'_>,
        record: &Record<'_>,
        gaps: &[Gap],
        rate_hz: f64,
        scale: f64,
    ) -> PyResult<(Column, Settled)> {
        let series = match record {
            Record::Codes(codes) => Series::Codes(codes.as_slice()?.to_vec()),
            Record::Numbers(numbers) => Series::Numbers(numbers.as_slice()?.to_vec()),
        };
        let mut rate = Column { gaps: gaps.to_vec(), scale, ..named("the rate", series, rate_hz) };
        let temps_c = self.temps_c.as_ref().map(|temps_c| temps_c.as_slice().map(<[f64]>::to_vec)).transpose()?;
        let temperature = temps_c.map(|temps_c| named("the temperature", Series::Numbers(temps_c), rate_hz));
        let skip: zerorate_view::Seconds =
            self.skip.parse().map_err(|why| PyValueError::new_err(format!("skip={}: {why}", self.skip)))?;
        let settling = logs::Settling { skip_s: skip.0, order: self.detrend, names: Names(argument) };
        let settled = py.detach(|| settling.apply(&mut rate, Path::new(RECORD), temperature.as_ref()));
        Ok((rate, settled.map_err(|why| exception(&why.into()))?))
    }
}

fn named(name: &str, series: Series, rate_hz: f64) -> Column {
    let (gaps, warnings) = (Vec::new(), Vec::new());
    Column { name: name.to_owned(), series, gaps, rate_hz, quantity: None, scale: 1.0, warnings }
}

/// What is left of a record as the core takes it, in place.
pub fn input(column: &Column, phase: bool) -> Input<'_> {
    match column.input() {
        Input::Rate(numbers) if phase => Input::Phase(numbers),
        input => input,
    }
}

/// What is to be said of a record that stops changing.
pub fn frozen(input: Input<'_>, rate_hz: f64, name: &str) -> Option<String> {
    match logs::stopped(input, rate_hz, Path::new(RECORD), name) {
        Ok(note) => note.map(|note| note.to_string()),
        // a log that never changes is refused by the command line; what is in memory has its deviations, which are 0
        Err(error) => Some(format!("frozen: {error}")),
    }
}

/// A warning, with the arguments that help.
pub fn text(warning: &AllanWarning) -> String {
    let help = match warning {
        AllanWarning::FollowsTemperature { .. } => " (detrend=1, skip=\"45m\")",
        _ => "",
    };
    format!("{}: {warning}{help}", warning.code())
}

/// The polynomial that was taken out.
pub fn dict<'py>(py: Python<'py>, detrended: &Detrended) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    result.set_item("order", detrended.lost_dof)?;
    result.set_item("coefficients", &detrended.coefficients)?;
    result.set_item("mean_c", detrended.mean_c)?;
    result.set_item("explained", detrended.explained)?;
    result.set_item("lost_dof", detrended.lost_dof)?;
    result.set_item("walk_kept", detrended.walk_kept())?;
    Ok(result)
}
