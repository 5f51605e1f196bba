//! Files for the filters that take the noise of an IMU.

use crate::allan::Model;
use crate::error::exception;
use crate::log::{argument, label};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use std::path::PathBuf;
use zerorate_jobs::output::Outputs;
use zerorate_logs::imu::{Axis, Choice, Combine, Format, Kind, Numbers, doubt};
use zerorate_logs::{Names, TimeUnit, Unit};

/// Name, unit and model of an axis.
type Modelled<'py> = (String, String, PyRef<'py, Model>);

/// The text of the file for `format`, and why it is no result if it is none.
///
/// Raises ValueError for an unknown format, and for a number of axes that it cannot take.
#[pyfunction]
pub fn imu_file(
    format: &str,
    axes: Vec<Modelled<'_>>,
    log: String,
    topic: Option<String>,
    combine: &str,
    inflate: f64,
    force: bool,
) -> PyResult<(String, Vec<String>)> {
    let format = named("format", format, Format::ALL, Format::name)?;
    let combine = named("combine", combine, [Combine::Worst, Combine::Mean], Combine::name)?;
    if !(inflate > 0.0 && inflate.is_finite()) {
        return Err(PyValueError::new_err(format!("inflate={inflate}: give a number above zero")));
    }
    let doubts: Vec<String> =
        axes.iter().filter_map(|(name, _, model)| Some(format!("{name}: {}", doubt(&model.fit)?))).collect();
    if !doubts.is_empty() && !force {
        return Ok((String::new(), doubts));
    }
    let axes: Vec<Axis<'_>> = axes.iter().map(axis).collect::<PyResult<_>>()?;
    check(format, &axes)?;
    let choice = Choice { log, topic, combine, inflate, doubts: doubts.clone(), names: Names(argument) };
    Ok((format.text(&Numbers::new(choice, &axes)), doubts))
}

/// What a unit is of, as a kind of axis; nothing for another unit.
#[pyfunction]
pub fn unit_kind(unit: &str) -> Option<&'static str> {
    Some(Kind::of(unit.parse::<Unit>().ok()?.quantity())?.name())
}

/// The unit that the name of a column states.
#[pyfunction]
pub fn column_unit(name: &str) -> Option<&'static str> {
    Unit::of_column(name).map(label)
}

/// Whether the name of a column states a unit of time.
#[pyfunction]
pub fn is_time(name: &str) -> bool {
    Unit::of_column(name).is_none() && TimeUnit::of_column(name).is_some()
}

/// Writes a text to ``path``: whole, onto the disk, and over another file only with ``force``.
///
/// Raises FileExistsError where it would overwrite one, OSError where it cannot be written.
#[pyfunction]
pub fn save_text(path: PathBuf, text: &str, force: bool) -> PyResult<()> {
    let save = || -> anyhow::Result<()> { Ok(Outputs::new(force).derived(&path)?.fill(text.as_bytes())?) };
    save().map_err(|error| exception(&error))
}

fn axis<'a>((name, unit, model): &'a Modelled<'_>) -> PyResult<Axis<'a>> {
    let unit: Unit = unit.parse().map_err(PyValueError::new_err)?;
    let kind = Kind::of(unit.quantity()).ok_or_else(|| PyValueError::new_err(format!("{unit} is of no axis")))?;
    let si = match kind {
        Kind::Gyroscope => unit.in_results().to_radians(),
        Kind::Accelerometer => unit.in_results(),
    };
    Ok(Axis { name, kind, rate_hz: model.rate_hz, fit: &model.fit, si })
}

/// What takes a number by axis needs three of a kind.
fn check(format: Format, axes: &[Axis<'_>]) -> PyResult<()> {
    for kind in Kind::ALL {
        let count = axes.iter().filter(|axis| axis.kind == kind).count();
        if format.is_by_axis() && !matches!(count, 0 | 3) {
            let (name, format) = (kind.name(), format.name());
            return Err(PyValueError::new_err(format!(
                "there are {count} axes of the {name}, and format='{format}' takes three; choose another"
            )));
        }
    }
    Ok(())
}

/// One of several by its name.
fn named<T: Copy, const N: usize>(what: &str, name: &str, all: [T; N], of: fn(T) -> &'static str) -> PyResult<T> {
    let names = || all.map(|one| format!("'{}'", of(one))).join(", ");
    let found = all.into_iter().find(|one| of(*one) == name);
    found.ok_or_else(|| PyValueError::new_err(format!("{what}='{name}': give {}", names())))
}
