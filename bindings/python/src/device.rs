//! Opens the device that the arguments of Python describe.

use crate::error::joined;
use crate::worker::Reporter;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use serde_json::Value;
use std::path::PathBuf;
use zerorate::{Part, Setting};
use zerorate_allan::SettingName;
use zerorate_host::{DeviceSpec, Pace, Sampling, Setup, SourceWarning, Stop};
use zerorate_jobs::output::Outputs;
use zerorate_jobs::{Acquisition, InvalidOptions, JobWarning, catalogue};
use zerorate_view::Seconds;

/// The arguments that say which device is read, and how.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct DeviceOptions {
    device: String,
    part: Option<PathBuf>,
    every_temp: Option<i64>,
    divider: Option<i64>,
    realtime: bool,
}

/// A device with checked options, which can be opened.
pub struct Device {
    pub spec: DeviceSpec,
    part: Option<PathBuf>,
    sampling: Sampling,
    pace: Pace,
}

impl DeviceOptions {
    /// Checks the options. Raises ValueError if one is invalid.
    pub fn checked(self) -> PyResult<Device> {
        let every = |setting, given: Option<i64>| {
            let number = given.map(|number| u16::try_from(number).ok().filter(|number| *number > 0).ok_or(number));
            let range = |number| {
                PyValueError::new_err(format!("{}{number}: give a number from 1 to {}", argument(setting), u16::MAX))
            };
            number.transpose().map_err(range)
        };
        let wrong = |why| PyValueError::new_err(format!("the device '{}': {why}", self.device));
        Ok(Device {
            spec: self.device.parse().map_err(wrong)?,
            part: self.part,
            sampling: Sampling {
                every_temp: every(Setting::EveryTemp, self.every_temp)?,
                divider: every(Setting::Divider, self.divider)?,
            },
            pace: if self.realtime { Pace::RealTime } else { Pace::Free },
        })
    }
}

impl Device {
    /// The settings for reading the device. Returns an error if an output is the recording that is replayed.
    pub fn setup(&self, outputs: &mut Outputs) -> anyhow::Result<Setup> {
        self.spec.file().map_or(Ok(()), |file| outputs.reads(file))?;
        Ok(Setup { sampling: self.sampling, part: self.part(outputs)?, names: argument, ambient: None })
    }

    pub fn open(
        &self,
        setup: Setup,
        stop: &Stop,
        mut warn: impl FnMut(String) + 'static,
    ) -> anyhow::Result<Acquisition> {
        let told = Box::new(move |warning: &SourceWarning| warn(text(JobWarning::Source(warning.clone()))));
        Acquisition::open(&self.spec, setup, self.pace, stop, told)
    }

    fn part(&self, outputs: &mut Outputs) -> anyhow::Result<Option<Part>> {
        let Some(named) = &self.part else { return Ok(None) };
        let wrong = |why: String| InvalidOptions(format!("part={}: {why}", named.display()));
        let (text, range_dps) = catalogue::named(named, outputs).map_err(|error| match error.downcast() {
            Ok(InvalidOptions(why)) => wrong(why).into(),
            Err(other) => other,
        })?;
        Ok(Some(Part::parse_at(&text, range_dps).map_err(|error| wrong(error.to_string()))?))
    }
}

/// The name of a setting in the functions that read a device.
pub fn argument(setting: Setting) -> SettingName {
    let suffix = if setting == Setting::AssumeLinear { "=True" } else { "=" };
    match setting {
        Setting::FinalTemperature | Setting::Edge | Setting::Device | Setting::SelfTest => setting.name(),
        other => SettingName { suffix, ..SettingName::text(other.word()) },
    }
}

/// Rewrites the arguments in the report's warnings and remarks as Python writes them.
pub fn in_words(mut report: Value) -> Value {
    for key in ["warnings", "remarks"] {
        for warning in report.get_mut(key).and_then(Value::as_array_mut).into_iter().flatten() {
            if let Value::String(text) = warning {
                *text = joined(text);
            }
        }
    }
    report
}

/// A warning as Python shows it: ``code: text``.
pub fn text(warning: JobWarning) -> String {
    joined(&warning.coded(argument).to_string())
}

pub fn sink(reporter: &Reporter) -> impl FnMut(String) + use<> {
    let reporter = reporter.clone();
    move |text| reporter.warn(text)
}

/// A duration: seconds, or a text such as ``"10m"``.
#[derive(FromPyObject)]
pub enum Duration {
    Seconds(f64),
    Text(String),
}

impl Duration {
    /// Converts the argument ``name`` to seconds. Raises ValueError if it is not a duration.
    pub fn s(&self, name: impl std::fmt::Display) -> PyResult<Seconds> {
        let text = match self {
            Self::Seconds(seconds) => seconds.to_string(),
            Self::Text(text) => text.clone(),
        };
        text.parse().map_err(|why| PyValueError::new_err(format!("{name}{text}: {why}")))
    }
}
