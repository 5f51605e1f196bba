//! Columns of logs, and of tables in memory, which are read by the same rules.

use crate::error::{exception, joined};
use arrow_array::{ArrayRef, DurationNanosecondArray, Float64Array, Int32Array, NullArray, RecordBatch};
use arrow_schema::{Field, Schema};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;
use zerorate_allan::SettingName;
use zerorate_imu::{Axes, ImuOptions, KindOptions};
use zerorate_jobs::code_scales::{CodeOptions, CodeScales, concerns};
use zerorate_jobs::output::Outputs;
use zerorate_jobs::tempcal::UnitLog;
use zerorate_jobs::{catalogue, temperature};
use zerorate_logs::{
    Column, ColumnOptions, ColumnSelection, Cut, Decimal, LogWarning, Names, Quantity, Series, Setting,
    TEMPERATURE_NAMES, TimeUnit, Unit,
};

/// A log or a table in memory, as Python gives it.
#[derive(FromPyObject)]
pub enum Source<'py> {
    /// A table: its name in messages, and its columns.
    Table(String, Vec<(String, Cells<'py>)>),
    /// The path of a log.
    File(PathBuf),
}

/// A column of a table. Times are counted in ns.
#[derive(FromPyObject)]
pub enum Cells<'py> {
    Codes(PyReadonlyArray1<'py, i32>),
    Numbers(PyReadonlyArray1<'py, f64>),
    Times(PyReadonlyArray1<'py, i64>),
    /// A column without numbers: its number of rows.
    Other(usize),
}

/// The fields of [`ColumnOptions`] as Python has them.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct Options {
    topic: Option<String>,
    r#where: Option<String>,
    time_column: Option<String>,
    time_unit: Option<String>,
    rate_hz: Option<f64>,
    unit: Option<String>,
    scale: Option<f64>,
    increments: Option<bool>,
    force_unit: bool,
    decimal: Option<String>,
    raw: Option<String>,
    max_bad: Option<f64>,
    skip: Option<String>,
    until: Option<String>,
}

/// Columns, unit and scale of a kind of axis, as the caller gives them.
pub type OfKind = (Vec<String>, Option<String>, Option<f64>);

/// The part, and the full scales of gyroscope and accelerometer, as the caller gives them for integer codes.
pub type OfCodes = (Option<String>, Option<f64>, Option<f64>);

/// The axes, each as a dictionary; the topic of a bag; the warnings about the log.
type AxesOfLog<'py> = (Vec<Bound<'py, PyDict>>, Option<String>, Vec<String>);

/// The name of a setting as an argument in Python, for messages.
pub fn argument(setting: Setting) -> SettingName {
    let name = SettingName { suffix: "=", ..SettingName::text(setting.word()) };
    match setting {
        Setting::Rate => SettingName { suffix: "_hz=", ..name },
        Setting::Horizon => SettingName { suffix: "_s=", ..name },
        Setting::ForceUnit => SettingName { prefix: "give ", suffix: "=True", ..name },
        Setting::Detrend => SettingName { suffix: "=1", ..name },
        Setting::AsFitted | Setting::Increments => SettingName { suffix: "=True", ..name },
        Setting::NoIncrements => SettingName::text("increments=False"),
        Setting::TempColumn => SettingName::text("temp_c="),
        Setting::Combine | Setting::Format => setting.name(),
        _ => name,
    }
}

/// Reads the named columns of a log, all columns with ``every``, or the only column with ``None``. Returns a
/// dictionary for each column.
///
/// ``points`` asks for a number for each sample, even if the log has codes.
#[pyfunction]
pub fn read_columns<'py>(
    py: Python<'py>,
    source: Source<'py>,
    names: Option<Vec<String>>,
    every: bool,
    points: bool,
    options: Options,
) -> PyResult<Vec<Bound<'py, PyDict>>> {
    let (options, given) = (options.checked()?, options.unit()?);
    let wanted = match &names {
        None if every => ColumnSelection::All,
        None => ColumnSelection::One(None),
        Some(names) => ColumnSelection::Listed(names),
    };
    let log = opened(source)?;
    let columns = py.detach(|| log.columns(wanted, &options)).map_err(|error| exception(&error.into()))?;
    columns.into_iter().map(|column| described(py, log.path(), column, given, points)).collect()
}

/// Reads the temperature of each sample, °C, and returns it with the name of its column; ``None`` if there is none.
///
/// The temperature is the column ``name``. Without a name, it is the first column found of those in `temperatures`.
#[pyfunction]
pub fn read_temperature<'py>(
    py: Python<'py>,
    source: Source<'py>,
    name: Option<&str>,
    options: Options,
) -> PyResult<Option<(String, Bound<'py, PyArray1<f64>>)>> {
    // warnings about the unit of the other columns do not apply to the temperature
    let options = ColumnOptions { unit: None, scale: None, ..options.checked()? };
    let log = opened(source)?;
    let column = match &log {
        UnitLog::Table(..) => {
            let read = |name: &str| log.columns(ColumnSelection::Listed(&[name.to_owned()]), &options).ok()?.pop();
            name.map_or_else(|| TEMPERATURE_NAMES.into_iter().find_map(read), read)
        }
        UnitLog::File(path) => py.detach(|| temperature::of_log(path, name, &options)),
    };
    let Some(column) = column else { return Ok(None) };
    let mut temps_c = column.points(log.path()).map_err(|error| exception(&error.into()))?;
    temps_c.iter_mut().for_each(|temp_c| *temp_c *= column.scale);
    Ok(Some((column.name, PyArray1::from_vec(py, temps_c))))
}

/// The names of columns with a temperature.
#[pyfunction]
pub fn temperatures() -> Vec<&'static str> {
    TEMPERATURE_NAMES.to_vec()
}

/// Reads the axes of an IMU's log, or the named columns. Returns a dictionary for each, the topic of a bag, and the
/// warnings about the log.
#[pyfunction]
pub fn read_imu<'py>(
    py: Python<'py>,
    source: Source<'py>,
    names: Option<Vec<String>>,
    gyro: OfKind,
    accel: OfKind,
    codes: OfCodes,
    options: Options,
) -> PyResult<AxesOfLog<'py>> {
    let mut options = imu_options(names, gyro, accel, &options)?;
    let assumed = code_options(codes)?.apply(&mut options).map_err(|error| exception(&error.into()))?;
    let (gyro_unit, accel_unit) = (options.gyro.unit, options.accel.unit);
    let log = opened(source)?;
    let axes = py.detach(|| log.axes(&options)).map_err(|error| exception(&error.into()))?;
    let Axes { columns, topic, mut warnings, .. } = axes;
    warnings.extend(assumed.into_iter().filter(|(kind, _)| concerns(*kind, &columns)).map(|(_, said)| said));
    let of_kind = |column: &Column| match column.quantity {
        Some(Quantity::Acceleration) => accel_unit,
        _ => gyro_unit,
    };
    let columns = columns.into_iter().map(|column| {
        let given = of_kind(&column);
        described(py, log.path(), column, given, false)
    });
    Ok((columns.collect::<PyResult<_>>()?, topic, texts(&warnings)))
}

pub fn imu_options(
    columns: Option<Vec<String>>,
    gyro: OfKind,
    accel: OfKind,
    options: &Options,
) -> PyResult<ImuOptions> {
    let said = |kind: &str, (columns, unit, scale): OfKind| {
        let unit = parsed(&unit, &format!("{kind}_unit"))?;
        let scale = positive(scale, &format!("{kind}_scale"))?;
        Ok::<_, PyErr>(KindOptions { columns, unit, scale, codes: None })
    };
    let (gyro, accel, log) = (said("gyro", gyro)?, said("accel", accel)?, options.checked()?);
    Ok(ImuOptions { columns, gyro, accel, log, ..ImuOptions::default() })
}

pub fn code_options((part, gyro_range, accel_range): OfCodes) -> PyResult<CodeOptions> {
    let wrong = |why: String| refused("part", why);
    let read = |named: &String| {
        catalogue::named(Path::new(named), &mut Outputs::new(false)).map_err(|error| wrong(format!("{error:#}")))
    };
    let (text, range_dps) = part.as_ref().map(read).transpose()?.unzip();
    let (gyro_range, range_dps) = (positive(gyro_range, "gyro_range")?, range_dps.flatten());
    if gyro_range.is_some() && range_dps.is_some() {
        return Err(wrong("it states the full scale, and so does gyro_range=".to_owned()));
    }
    let scales = |text: String| CodeScales::parse(&text).map_err(|error| wrong(error.to_string()));
    Ok(CodeOptions {
        part: text.map(scales).transpose()?,
        gyro_range_dps: gyro_range.or(range_dps),
        accel_range_g: positive(accel_range, "accel_range")?,
    })
}

impl Options {
    fn checked(&self) -> PyResult<ColumnOptions> {
        let max_bad = self.max_bad;
        if let Some(share) = max_bad.filter(|share| !(0.0..1.0).contains(share)) {
            return Err(PyValueError::new_err(format!(
                "max_bad={share}: give a share from 0 to below 1, such as 0.05"
            )));
        }
        let time_unit = |word: &str| named("time_unit", word, TimeUnit::ALL, TimeUnit::name);
        let decimal = |word: &str| named("decimal", word, DECIMALS, |(word, _)| word).map(|(_, mark)| mark);
        Ok(ColumnOptions {
            column: None,
            topic: self.topic.clone(),
            only: parsed(&self.r#where, "where")?,
            time_column: self.time_column.clone(),
            cut: Cut { from: parsed(&self.skip, "skip")?, until: parsed(&self.until, "until")? },
            time_unit: self.time_unit.as_deref().map(time_unit).transpose()?,
            rate: positive(self.rate_hz, "rate_hz")?,
            unit: self.unit()?,
            scale: positive(self.scale, "scale")?,
            increments: self.increments,
            force_unit: self.force_unit,
            decimal: self.decimal.as_deref().map(decimal).transpose()?,
            raw: parsed(&self.raw, "raw")?,
            max_bad,
            described: Some(zerorate_record::open_described),
            names: Names(argument),
        })
    }

    fn unit(&self) -> PyResult<Option<Unit>> {
        parsed(&self.unit, "unit")
    }
}

fn refused(argument: &str, why: String) -> PyErr {
    PyValueError::new_err(format!("{argument}=: {why}"))
}

const DECIMALS: [(&str, Decimal); 4] =
    [(".", Decimal::Point), (",", Decimal::Comma), ("point", Decimal::Point), ("comma", Decimal::Comma)];

/// Finds the item of `all` with this name. The error lists all names.
pub fn named<T: Copy, const N: usize>(what: &str, name: &str, all: [T; N], of: fn(T) -> &'static str) -> PyResult<T> {
    let names = || all.map(|one| format!("'{}'", of(one))).join(", ");
    let found = all.into_iter().find(|one| of(*one) == name);
    found.ok_or_else(|| PyValueError::new_err(format!("{what}='{name}': give {}", names())))
}

fn parsed<T: FromStr<Err = String>>(text: &Option<String>, name: &str) -> PyResult<Option<T>> {
    text.as_deref().map(str::parse).transpose().map_err(|why| refused(name, why))
}

fn positive(number: Option<f64>, name: &str) -> PyResult<Option<f64>> {
    match number.filter(|number| !(*number > 0.0 && number.is_finite())) {
        Some(number) => Err(refused(name, format!("{number} is not a number above zero"))),
        None => Ok(number),
    }
}

/// The source, which can then be read without Python.
pub fn opened(source: Source<'_>) -> PyResult<UnitLog> {
    let (name, columns) = match source {
        Source::File(path) => return Ok(UnitLog::File(path)),
        Source::Table(name, columns) => (name, columns),
    };
    let arrays = columns.iter().map(|(_, cells)| cells.array()).collect::<PyResult<Vec<ArrayRef>>>()?;
    let field =
        |((name, _), array): (&(String, Cells<'_>), &ArrayRef)| Field::new(name, array.data_type().clone(), true);
    let fields: Vec<Field> = columns.iter().zip(&arrays).map(field).collect();
    let table = RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays);
    let table = table.map_err(|error| PyValueError::new_err(format!("{name}: {error}")))?;
    Ok(UnitLog::Table(name.into(), table))
}

impl Cells<'_> {
    fn array(&self) -> PyResult<ArrayRef> {
        Ok(match self {
            Self::Codes(codes) => Arc::new(Int32Array::from(codes.as_slice()?.to_vec())),
            Self::Numbers(numbers) => Arc::new(Float64Array::from(numbers.as_slice()?.to_vec())),
            Self::Times(times) => Arc::new(DurationNanosecondArray::from(times.as_slice()?.to_vec())),
            Self::Other(rows) => Arc::new(NullArray::new(*rows)),
        })
    }
}

pub fn texts(warnings: &[LogWarning]) -> Vec<String> {
    warnings.iter().map(|warning| joined(&warning.coded())).collect()
}

/// Describes a column for Python. Its numbers stay in the unit in which they came.
fn described<'py>(
    py: Python<'py>,
    path: &Path,
    column: Column,
    given: Option<Unit>,
    points: bool,
) -> PyResult<Bound<'py, PyDict>> {
    let result = PyDict::new(py);
    let unit = given.or_else(|| unit_of(&column));
    let (name, per_unit) = match unit {
        Some(unit) => (Some(label(unit)), unit.in_results()),
        None => (column.quantity.map(Quantity::unit), 1.0),
    };
    result.set_item("unit", name)?;
    result.set_item("scale", column.scale / per_unit)?;
    result.set_item("name", &column.name)?;
    result.set_item("rate_hz", column.rate_hz)?;
    result.set_item("skipped_s", column.skipped_s)?;
    result.set_item("gaps", column.gaps.iter().map(|gap| (gap.at, gap.missing)).collect::<Vec<_>>())?;
    result.set_item("warnings", texts(&column.warnings))?;
    match column.series {
        Series::Codes(codes) if !points => result.set_item("values", PyArray1::from_vec(py, codes))?,
        Series::Numbers(numbers) => result.set_item("values", PyArray1::from_vec(py, numbers))?,
        Series::Codes(_) => {
            let numbers = column.points(path).map_err(|error| exception(&error.into()))?;
            result.set_item("values", PyArray1::from_vec(py, numbers))?;
        }
    }
    Ok(result)
}

/// The name of a unit in results.
pub fn label(unit: Unit) -> &'static str {
    if unit == Unit::Dps { Quantity::AngularRate.unit() } else { unit.name() }
}

/// The unit of the numbers in the column: the one whose factor to the unit of results is the column's scale. None if
/// there is no such unit.
fn unit_of(column: &Column) -> Option<Unit> {
    let quantity = column.quantity?;
    Unit::ALL.into_iter().find(|unit| unit.quantity() == quantity && unit.in_results() == column.scale)
}
