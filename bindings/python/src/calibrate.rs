//! The procedure of AN-1042.

use crate::calibration::Calibration;
use crate::error::{exception, joined};
use pyo3::exceptions::{PyUserWarning, PyValueError};
use pyo3::prelude::*;
use pythonize::pythonize;
use serde_json::Value;
use std::ffi::CString;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};
use zerorate::calibration::Notes;
use zerorate::{Method, Plan, Progress, Setting, SettingNames};
use zerorate_allan::SettingName;
use zerorate_host::{DeviceSpec, Pace, Sampling, Setup, SourceWarning, Stop};
use zerorate_jobs::calibrate::{Files, OutputOptions, Watch, prepare, settle_s};
use zerorate_jobs::output::Outputs;
use zerorate_jobs::{Acquisition, JobWarning};
use zerorate_view::Seconds;

/// A duration: seconds, or a text such as ``"10m"``.
#[derive(FromPyObject)]
enum Duration {
    Seconds(f64),
    Text(String),
}

/// The arguments of ``zerorate.calibrate``. None means the default of the procedure.
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
    every_temp: Option<i64>,
    divider: Option<i64>,
    serial: Option<String>,
    supply_note: Option<String>,
    ambient_note: Option<String>,
    operator: Option<String>,
    log: Option<PathBuf>,
    output: Option<PathBuf>,
    force: bool,
}

impl CalibrateOptions {
    fn plan(&self) -> PyResult<Plan> {
        let method = Method::ALL.into_iter().find(|method| method.name() == self.method).ok_or_else(|| {
            let names = Method::ALL.map(|method| format!("'{}'", method.name())).join(", ");
            PyValueError::new_err(format!("method='{}': give {names}", self.method))
        })?;
        let usual = Plan::default();
        let time = |given: &Option<Duration>, setting, usual_s| given.as_ref().map_or(Ok(usual_s), |of| of.s(setting));
        Ok(Plan {
            method,
            target_dps: self.target_dph.map(|dph| dph / 3600.0),
            average_s: time(&self.average, Setting::Average, usual.average_s)?,
            warmup_s: time(&self.warmup, Setting::WarmUp, usual.warmup_s)?,
            settle_s: time(&self.settle, Setting::Settle, settle_s(method, false))?,
            offset_s: time(&self.offset, Setting::Offset, usual.offset_s)?,
            max_lost: self.max_lost.unwrap_or(usual.max_lost),
            max_u_btc_dps_per_c: self.max_u_btc.unwrap_or(usual.max_u_btc_dps_per_c),
            earth_dps: self.earth_dps,
            assume_linear: self.assume_linear,
            ..usual
        })
    }

    fn sampling(&self) -> PyResult<Sampling> {
        let every = |setting, given: Option<i64>| {
            let number = given.map(|number| u16::try_from(number).ok().filter(|number| *number > 0).ok_or(number));
            let range = |number| {
                PyValueError::new_err(format!("{}{number}: give a number from 1 to {}", argument(setting), u16::MAX))
            };
            number.transpose().map_err(range)
        };
        let every_temp = every(Setting::EveryTemp, self.every_temp)?;
        Ok(Sampling { every_temp, divider: every(Setting::Divider, self.divider)? })
    }
}

impl Duration {
    fn s(&self, setting: Setting) -> PyResult<f64> {
        let text = match self {
            Self::Seconds(seconds) => seconds.to_string(),
            Self::Text(text) => text.clone(),
        };
        let wrong = |why| PyValueError::new_err(format!("{}{text}: {why}", argument(setting)));
        text.parse().map(|Seconds(seconds)| seconds).map_err(wrong)
    }
}

/// The name of a setting in ``zerorate.calibrate``.
fn argument(setting: Setting) -> SettingName {
    let suffix = if setting == Setting::AssumeLinear { "=True" } else { "=" };
    match setting {
        Setting::FinalTemperature | Setting::Edge | Setting::Device | Setting::SelfTest => setting.name(),
        other => SettingName { suffix, ..SettingName::text(other.word()) },
    }
}

/// The warnings of the device so far.
#[derive(Clone, Default)]
struct WarningLog(Arc<Mutex<Vec<JobWarning>>>);

impl WarningLog {
    fn push(&self, warning: JobWarning) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).push(warning);
    }

    fn take(&self) -> Vec<JobWarning> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// The Python caller, who watches the procedure.
struct Caller {
    signal: PyResult<()>,
    warnings: WarningLog,
}

impl Watch for Caller {
    fn see(&mut self, _: &Progress) -> bool {
        self.signal = Python::attach(|py| py.check_signals());
        self.signal.is_ok()
    }

    fn warn(&mut self, warning: JobWarning) {
        self.warnings.push(warning);
    }

    fn names(&self) -> SettingNames {
        argument
    }
}

/// Runs the procedure on a device. Returns the object that ``zerorate calibrate --json`` prints, and the calibration.
///
/// Other threads run meanwhile. Ctrl-C ends it. Messages of the device become warnings.
#[pyfunction]
pub fn calibrate<'py>(
    py: Python<'py>,
    device: &str,
    options: CalibrateOptions,
) -> PyResult<(Bound<'py, PyAny>, Calibration)> {
    let device: DeviceSpec = device.parse().map_err(PyValueError::new_err)?;
    let (plan, sampling) = (options.plan()?, options.sampling()?);
    let (done, signal, warnings) = py.detach(|| {
        let warnings = WarningLog::default();
        let mut caller = Caller { signal: Ok(()), warnings: warnings.clone() };
        let done = run(&device, plan, sampling, options, &mut caller);
        let warnings = warnings.take();
        (done, caller.signal, warnings)
    });
    signal?;
    for warning in warnings {
        let text = CString::new(joined(&warning.coded(argument).to_string()).replace('\0', " "))?;
        PyErr::warn(py, &py.get_type::<PyUserWarning>(), &text, 1)?;
    }
    let (report, calibration) = done.map_err(|error| exception(&error))?;
    Ok((pythonize(py, &report)?, Calibration::of(calibration)))
}

fn run(
    device: &DeviceSpec,
    plan: Plan,
    sampling: Sampling,
    options: CalibrateOptions,
    caller: &mut Caller,
) -> anyhow::Result<(Value, zerorate::Calibration)> {
    let CalibrateOptions { output, log, serial, supply_note, ambient_note, operator, force, .. } = options;
    let notes = Notes { supply: supply_note, ambient: ambient_note, operator, host: None };
    let files = Files::claim(Outputs::new(force), OutputOptions { output, saves: false, log, serial, notes })?;
    let warnings = caller.warnings.clone();
    let tell = Box::new(move |warning: &SourceWarning| warnings.push(JobWarning::Source(warning.clone())));
    let setup = Setup { sampling, names: argument, ..Setup::default() };
    let acquisition = Acquisition::open(device, setup, Pace::Free, &Stop::default(), tell)?;
    let done = prepare(acquisition, plan, files, argument)?.run(caller)?;
    done.delivery.map_err(|failure| failure.error(""))?;
    let mut report = serde_json::to_value(&done.report)?;
    for key in ["warnings", "remarks"] {
        for warning in report.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten() {
            if let Value::String(text) = warning {
                *text = joined(text);
            }
        }
    }
    Ok((report, done.calibration))
}
