//! `zerorate.calibrate`: calibrates a sensor by AN-1042 or another method.

use crate::calibration::Calibration;
use crate::device::{Device, DeviceOptions, Duration, argument, in_words, sink, text};
use crate::log::named;
use crate::worker::{Reporter, supervised};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pythonize::pythonize;
use serde_json::Value;
use std::path::PathBuf;
use zerorate::calibration::Notes;
use zerorate::{Method, Plan, Progress, Setting, SettingNames};
use zerorate_host::Stop;
use zerorate_jobs::JobWarning;
use zerorate_jobs::calibrate::{Files, OutputOptions, Watch, prepare, settle_s};
use zerorate_jobs::output::Outputs;
use zerorate_view::Seconds;

/// The arguments of ``zerorate.calibrate``. None stands for the default of a setting of the plan, or for any other
/// argument that was not given.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct CalibrateOptions {
    method: String,
    target_dph: Option<f64>,
    average: Option<Duration>,
    warmup: Option<Duration>,
    settle: Option<Duration>,
    offset: Option<Duration>,
    max_lost: Option<f64>,
    max_u_btc: Option<f64>,
    earth_dps: Option<f64>,
    assume_linear: bool,
    serial: Option<String>,
    supply_note: Option<String>,
    ambient_note: Option<String>,
    operator: Option<String>,
    log: Option<PathBuf>,
    output: Option<PathBuf>,
    force: bool,
}

impl CalibrateOptions {
    fn plan(&self, is_recorded: bool) -> PyResult<Plan> {
        let method = named("method", &self.method, Method::ALL, Method::name)?;
        if self.target_dph.is_some() && method == Method::An1042 {
            return Err(PyValueError::new_err("target_dph is for method='warmup' or 'cycle'"));
        }
        let usual = Plan::default();
        let time = |given: &Option<Duration>, setting, usual_s| {
            given.as_ref().map_or(Ok(usual_s), |of| of.s(argument(setting)).map(|Seconds(seconds)| seconds))
        };
        Ok(Plan {
            method,
            target_dps: self.target_dph.map(|dph| dph / 3600.0),
            average_s: time(&self.average, Setting::Average, usual.average_s)?,
            warmup_s: time(&self.warmup, Setting::WarmUp, usual.warmup_s)?,
            settle_s: time(&self.settle, Setting::Settle, settle_s(method, is_recorded))?,
            offset_s: time(&self.offset, Setting::Offset, usual.offset_s)?,
            max_lost: self.max_lost.unwrap_or(usual.max_lost),
            max_u_btc_dps_per_c: self.max_u_btc.unwrap_or(usual.max_u_btc_dps_per_c),
            earth_dps: self.earth_dps,
            assume_linear: self.assume_linear,
            ..usual
        })
    }
}

/// Passes progress and warnings of the procedure on to Python.
struct Caller(Reporter);

impl Watch for Caller {
    fn see(&mut self, progress: &Progress) -> bool {
        self.0.show(progress.state.to_string(), progress.elapsed_s, progress.total_s);
        true
    }

    fn warn(&mut self, warning: JobWarning) {
        self.0.warn(text(warning));
    }

    fn names(&self) -> SettingNames {
        argument
    }
}

/// Runs the procedure on a device. Returns the object that ``zerorate calibrate --json`` prints, and the calibration.
///
/// Other threads run meanwhile. Ctrl-C ends the procedure. Messages of the device become warnings. ``progress`` is
/// called with the step in words, the elapsed seconds and the total seconds.
#[pyfunction]
pub fn calibrate<'py>(
    py: Python<'py>,
    device: DeviceOptions,
    options: CalibrateOptions,
    progress: Option<Bound<'py, PyAny>>,
) -> PyResult<(Bound<'py, PyAny>, Calibration)> {
    let device = device.checked()?;
    let plan = options.plan(device.spec.file().is_some())?;
    let work = move |stop: &Stop, reporter: Reporter| run(&device, plan, options, stop, reporter);
    let (report, calibration) = supervised(py, progress.as_ref(), work)?;
    Ok((pythonize(py, &report)?, Calibration::of(calibration)))
}

fn run(
    device: &Device,
    plan: Plan,
    options: CalibrateOptions,
    stop: &Stop,
    reporter: Reporter,
) -> anyhow::Result<(Value, zerorate::Calibration)> {
    let CalibrateOptions { output, log, serial, supply_note, ambient_note, operator, force, .. } = options;
    let notes = Notes { supply: supply_note, ambient: ambient_note, operator, host: None };
    let mut outputs = Outputs::new(force);
    let setup = device.setup(&mut outputs)?;
    let files = Files::claim(outputs, OutputOptions { output, saves: false, log, serial, notes })?;
    let acquisition = device.open(setup, stop, sink(&reporter))?;
    let done = prepare(acquisition, plan, files, argument)?.run(&mut Caller(reporter))?;
    done.delivery.map_err(|failure| failure.error(""))?;
    Ok((in_words(serde_json::to_value(&done.report)?), done.calibration))
}
