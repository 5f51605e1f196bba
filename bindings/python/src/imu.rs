//! Files for the filters that take the noise of an IMU.

use crate::allan::Model;
use crate::error::{Refused, exception};
use crate::log::{argument, label, named};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use zerorate_imu::{
    Axis, Combine, Format, ImuWarning, Kind, NoNoiseFile, NoiseFileOptions, Rejection, Rejections, Rule,
};
use zerorate_jobs::output::Outputs;
use zerorate_logs::{Names, TimeUnit, Unit};

/// Name, unit and model of an axis.
type AxisModel<'py> = (String, String, PyRef<'py, Model>);

/// The text of the file for ``format``, and the reasons against its numbers, if there are any.
///
/// Raises ValueError for an unknown format, and for a number of axes that it cannot take. Raises Refused if the
/// numbers are not a valid result, unless ``accept_rejected`` is given.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the keywords of Imu.to_yaml")]
pub fn imu_file(
    format: &str,
    axes: Vec<AxisModel<'_>>,
    log: String,
    topic: Option<String>,
    combine: &str,
    horizon_s: Option<f64>,
    as_fitted: bool,
    inflate: f64,
    accept_rejected: bool,
    warnings: Vec<String>,
) -> PyResult<(String, Vec<String>)> {
    let format = named("format", format, Format::ALL, Format::name)?;
    let combine = named("combine", combine, [Combine::Worst, Combine::Mean], Combine::name)?;
    let doubts = Rejections::about(axes.iter().map(|(name, _, model)| (name.as_str(), Rejection::about(&model.fit))));
    let axes: Vec<Axis<'_>> = axes.iter().map(axis).collect::<PyResult<_>>()?;
    let rule = if as_fitted { Rule::AsFitted } else { Rule::Covers(horizon_s) };
    let (names, warnings) = (Names(argument), NoiseFileOptions::mattering(warnings));
    let choice = NoiseFileOptions { log, topic, combine, rule, inflate, names, warnings };
    Ok((format.file(choice, &axes, &doubts, accept_rejected).map_err(no_file)?, doubts.texts()))
}

/// Warnings about events that happen to several axes at once.
#[pyfunction]
pub fn motion(axes: Vec<(String, PyRef<'_, Model>)>, skipped_s: f64) -> Vec<String> {
    let models: Vec<_> = axes.iter().map(|(name, model)| (name.as_str(), &model.fit)).collect();
    ImuWarning::of_motion(&models, &[], skipped_s, Names(argument)).iter().map(ImuWarning::coded).collect()
}

/// The kind of axis that a unit belongs to; None for other units.
#[pyfunction]
pub fn unit_kind(unit: &str) -> Option<&'static str> {
    Some(Kind::of(unit.parse::<Unit>().ok()?.quantity())?.name())
}

/// The unit that the name of a column states; None if it states none.
#[pyfunction]
pub fn column_unit(name: &str) -> Option<&'static str> {
    Unit::of_column(name).map(label)
}

/// True if the name of a column states a unit of time.
#[pyfunction]
pub fn is_time(name: &str) -> bool {
    Unit::of_column(name).is_none() && TimeUnit::of_column(name).is_some()
}

/// Writes a text to ``path``. The file appears only when it is complete on the disk, and replaces another only with
/// ``force``.
///
/// Raises FileExistsError if it would overwrite a file, and OSError if it cannot be written.
#[pyfunction]
pub fn save_text(path: PathBuf, text: &str, force: bool) -> PyResult<()> {
    let save = || -> anyhow::Result<()> { Ok(Outputs::new(force).derived(&path)?.fill(text.as_bytes())?) };
    save().map_err(|error| exception(&error))
}

fn axis<'a>((name, unit, model): &'a AxisModel<'_>) -> PyResult<Axis<'a>> {
    let unit: Unit = unit.parse().map_err(PyValueError::new_err)?;
    let kind =
        Kind::of(unit.quantity()).ok_or_else(|| PyValueError::new_err(format!("no axis has the unit {unit}")))?;
    Ok(Axis { name, kind, rate_hz: model.rate_hz, fit: &model.fit, scale: unit.in_results() })
}

fn no_file(why: NoNoiseFile) -> PyErr {
    match why {
        NoNoiseFile::Rejected(doubts) => Refused::new_err(doubts.to_string()),
        NoNoiseFile::Inflate(inflate) => PyValueError::new_err(format!("inflate={inflate}: give a number above zero")),
        NoNoiseFile::NotThree(kind, count, format) => {
            let (name, format) = (kind.name(), format.name());
            PyValueError::new_err(format!(
                "there are {count} axes of the {name}, and format='{format}' takes three; choose another"
            ))
        }
        why => PyValueError::new_err(why.to_string()),
    }
}
