//! Recordings of raw codes.

use crate::device::{DeviceOptions, Duration, argument, in_words, sink};
use crate::worker::{Reporter, supervised};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pythonize::pythonize;
use std::path::PathBuf;
use zerorate::calibration::Notes;
use zerorate_host::Stop;
use zerorate_jobs::output::Outputs;
use zerorate_jobs::record::{Length, RecordOptions, RecordProgress, record};
use zerorate_record::Format;

/// The arguments of ``zerorate.capture``.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct CaptureOptions {
    output: PathBuf,
    duration: Duration,
    samples: Option<u64>,
    serial: Option<String>,
    supply_note: Option<String>,
    ambient_note: Option<String>,
    operator: Option<String>,
    force: bool,
}

impl CaptureOptions {
    fn record(self) -> PyResult<RecordOptions> {
        let length = match (self.samples, self.duration.s("duration=")?.nanos()) {
            (Some(0), _) => return Err(PyValueError::new_err("samples=0: give a number above zero")),
            (None, 0) => return Err(PyValueError::new_err("duration=0: give a time above zero")),
            (Some(samples), _) => Length::Samples(samples),
            (None, time_ns) => Length::Time(time_ns),
        };
        Ok(RecordOptions {
            format: Format::choose(None, &self.output).map_err(|error| PyValueError::new_err(error.to_string()))?,
            output: self.output,
            length,
            serial: self.serial,
            notes: Notes { supply: self.supply_note, ambient: self.ambient_note, operator: self.operator, host: None },
        })
    }
}

/// Records raw codes. Returns the object that ``zerorate capture --json`` prints.
///
/// Other threads run meanwhile. Ctrl-C ends the recording early, with a complete file. ``progress`` is called as by
/// `calibrate`.
#[pyfunction]
pub fn capture<'py>(
    py: Python<'py>,
    device: DeviceOptions,
    options: CaptureOptions,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<Bound<'py, PyAny>> {
    let (device, force) = (device.checked()?, options.force);
    let options = options.record()?;
    let total = options.length.total();
    let work = move |stop: &Stop, reporter: Reporter| {
        let mut outputs = Outputs::new(force);
        let setup = device.setup(&mut outputs)?;
        let mut acquisition = device.open(setup, stop, sink(&reporter))?;
        let mut show = |RecordProgress { done, .. }| reporter.show("recording".to_owned(), done, total);
        let report = record(&mut acquisition, &mut outputs, &options, argument, &mut show)?;
        report.refuse_frozen()?;
        Ok(in_words(serde_json::to_value(&report)?))
    };
    Ok(pythonize(py, &supervised(py, progress.as_ref(), work)?)?)
}
