//! The options for the temperature and the beginning of a record, as in `zerorate allan`.

use crate::error::{exception, joined};
use crate::log::{argument, texts};
use crate::record::Record;
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::Path;
use zerorate_allan::{AllanWarning, Gap, Input, Preparation};
use zerorate_logs::{self as logs, Column, Names, Series};

/// The name of a record in memory, for messages.
const RECORD: &str = "the record";

/// The temperature of a record, and the options ``detrend`` and ``skip``.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Settling<'py> {
    /// Temperature of each sample, °C; NaN where it is missing.
    temps_c: Option<PyReadonlyArray1<'py, f64>>,
    detrend: Option<usize>,
    skip: String,
}

impl Settling<'_> {
    /// Applies the options to a record. Returns the rest of the record, the result of detrending, and the length of
    /// the skipped beginning, s.
    pub fn apply(
        &self,
        py: Python<'_>,
        record: &Record<'_>,
        gaps: &[Gap],
        rate_hz: f64,
        scale: f64,
    ) -> PyResult<(Column, Preparation, f64)> {
        let series = match record {
            Record::Codes(codes) => Series::Codes(codes.as_slice()?.to_vec()),
            Record::Numbers(numbers) => Series::Numbers(numbers.as_slice()?.to_vec()),
        };
        let mut rate = Column::new("the rate", series, rate_hz);
        (rate.gaps, rate.scale) = (gaps.to_vec(), scale);
        let temps_c = self.temps_c.as_ref().map(|temps_c| temps_c.as_slice().map(<[f64]>::to_vec)).transpose()?;
        let temperature = temps_c.map(|temps_c| Column::new("the temperature", Series::Numbers(temps_c), rate_hz));
        let skip: zerorate_view::Seconds =
            self.skip.parse().map_err(|why| PyValueError::new_err(format!("skip={}: {why}", self.skip)))?;
        let samples = (skip.0 * rate_hz).round() as u64;
        if samples > 0 && samples >= rate.series.len() as u64 + rate.missing() {
            let why = format!("skip= leaves nothing of {} samples at {rate_hz} Hz", rate.series.len());
            return Err(PyValueError::new_err(why));
        }
        rate.skip(samples);
        let settling = zerorate_imu::Detrending { order: self.detrend, names: Names(argument) };
        let settled = py.detach(|| settling.apply(&mut rate, Path::new(RECORD), temperature.as_ref()));
        Ok((rate, settled.map_err(|why| exception(&why.into()))?, samples as f64 / rate_hz))
    }
}

/// The rest of a record as the core takes it, without a copy.
pub fn input(column: &Column, phase: bool) -> Input<'_> {
    match column.input() {
        Input::Rate(numbers) if phase => Input::Phase(numbers),
        input => input,
    }
}

/// Checks the values of a record that no reader of logs has seen. Returns the record with the sign of its codes, if it
/// was lost, and the warnings.
#[pyfunction]
pub fn check_record<'py>(
    py: Python<'py>,
    name: &str,
    record: Record<'py>,
) -> PyResult<(Option<Bound<'py, PyAny>>, Vec<String>)> {
    let (signed, warnings) = logs::check_record(&record.input(false, &[])?, Path::new(RECORD), name);
    let signed = signed.map(|signed| match signed {
        Series::Codes(codes) => PyArray1::from_vec(py, codes).into_any(),
        Series::Numbers(numbers) => PyArray1::from_vec(py, numbers).into_any(),
    });
    Ok((signed, texts(&warnings)))
}

pub fn frozen(input: Input<'_>, rate_hz: f64, name: &str) -> Option<String> {
    match logs::stopped(input, rate_hz, Path::new(RECORD), name) {
        Ok(note) => note.map(|note| note.to_string()),
        // the command line refuses a log that never changes; a record in memory has deviations of 0
        Err(error) => Some(format!("frozen: {error}")),
    }
}

/// Formats a warning as `code: text`. The text names the arguments of Python that remedy the problem.
pub fn text(warning: &AllanWarning, unit: &str) -> String {
    joined(&zerorate_imu::coded(warning, Some(unit), Names(argument)))
}
