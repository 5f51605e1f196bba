//! Allan deviations for `zerorate.allan` and `zerorate.allantools_compat`.

use crate::record::Record;
use crate::settling::{self, Settling};
use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyNone, PyTuple, PyType};
use pythonize::pythonize;
use std::fmt::Display;
use zerorate_allan::{
    AllanWarning, Analysis, AnalysisError, Fit, FitOptions, FittedRecord, Gap, Input, Options, Prediction,
    Preparation, Stat, Taus, deviations as of_input,
};
use zerorate_imu::{CleanedReport, DetrendReport, FitReport};

/// The noise model of a record in the core's form, for the files that are made from it.
#[pyclass(module = "zerorate._zerorate", frozen)]
pub struct Model {
    pub fit: Fit,
    pub rate_hz: f64,
}

#[pymethods]
impl Model {
    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }

    /// Pickles the model as `None`. Another process gets the numbers of a result, but not its model.
    fn __reduce__<'py>(&self, py: Python<'py>) -> (Bound<'py, PyType>, Bound<'py, PyTuple>) {
        (PyNone::get(py).get_type(), PyTuple::empty(py))
    }
}

type Column<'py, T> = Bound<'py, PyArray1<T>>;

#[derive(FromPyObject)]
pub enum Times {
    Named(String),
    Seconds(Vec<f64>),
}

impl Times {
    fn taus(self) -> PyResult<Taus> {
        match self {
            Self::Named(name) => name.parse().map_err(refused),
            Self::Seconds(times) => match times.iter().find(|time| !(time.is_finite() && **time > 0.0)) {
                Some(time) => {
                    Err(PyValueError::new_err(format!("taus: no averaging time is {time} s; give positive seconds")))
                }
                None => Ok(Taus::List(times)),
            },
        }
    }
}

/// Computes the deviation with its limits at each averaging time, and fits a noise model.
///
/// ``asked`` is (remove glitches, remove steps, highest frequency of the model in Hz or None); None fits no model.
/// ``scaled`` is (scale, unit): the record times the scale has the unit, which warnings name.
/// ``settling`` has the temperature and the options ``detrend`` and ``skip``. Messages call the record ``name``.
/// Other threads run meanwhile.
///
/// Raises ValueError for arguments with which nothing can be computed.
#[pyfunction]
#[expect(clippy::too_many_arguments, reason = "the keywords of zerorate.allan")]
pub fn analyse<'py>(
    py: Python<'py>,
    name: &str,
    record: Record<'py>,
    phase: bool,
    gaps: Vec<(usize, u64)>,
    rate_hz: f64,
    stat: &str,
    taus: Times,
    confidence: f64,
    scaled: (f64, String),
    asked: Option<(bool, bool, Option<f64>)>,
    settling: Option<Settling<'py>>,
) -> PyResult<Bound<'py, PyDict>> {
    let (scale, unit) = scaled;
    let gaps: Vec<Gap> = gaps.into_iter().map(|(at, missing)| Gap { at, missing }).collect();
    let settled = settling.map(|of| of.apply(py, &record, &gaps, rate_hz, scale)).transpose()?;
    let (rest, settled, skipped_s) = settled.map_or_else(
        || (None, Preparation::default(), 0.0),
        |(rest, settled, skipped_s)| (Some(rest), settled, skipped_s),
    );
    let whole = record.input(phase, &gaps)?;
    let input = rest.as_ref().map_or(whole, |rest| settling::input(rest, phase));
    let options = Options { stat: stat.parse().map_err(refused)?, taus: taus.taus()?, confidence, scale };
    let asked = asked.map(|(cut_glitches, remove_steps, max_freq_hz)| FitOptions {
        scale: 1.0,
        cut_glitches,
        remove_steps,
        max_freq_hz,
    });
    let found = py.detach(|| {
        let analysed = FittedRecord::new(input, rate_hz, scale, asked, &settled);
        Ok((analysed.deviations(&options)?, analysed.into_fit(), settling::frozen(input, rate_hz, name)))
    });
    let (analysis, fit, frozen) = found.map_err(|error: AnalysisError| refused(error))?;
    let Preparation { detrended, follows } = settled;
    let text = |warning: &AllanWarning| settling::text(warning, &unit);
    let result = PyDict::new(py);
    columns(&result, &analysis)?;
    result.set_item("skipped_s", skipped_s)?;
    let detrended = detrended.map(|detrended| pythonize(py, &DetrendReport::new(&detrended, None))).transpose()?;
    result.set_item("detrended", detrended)?;
    let follows = follows.filter(|_| !matches!(fit, Some(Ok(_))));
    result.set_item("warnings", frozen.into_iter().chain(follows.iter().map(text)).collect::<Vec<_>>())?;
    match fit {
        Some(Ok(fit)) => {
            expected(&result, &analysis, &fit)?;
            result.set_item("fit", pythonize(py, &FitReport::new(Some(&fit), None))?)?;
            result.set_item("fit_warnings", fit.warnings.iter().map(text).collect::<Vec<_>>())?;
            result.set_item("cleaned", pythonize(py, &CleanedReport::new(&fit.cleaned))?)?;
            result.set_item("core", Model { fit, rate_hz })?;
        }
        Some(Err(error)) => result.set_item("no_fit", error.to_string())?,
        None => {}
    }
    Ok(result)
}

/// Adds the model's deviations and its bands for this record and for another one (NaN where the model predicts
/// nothing). Adds nothing for statistics that the model does not cover.
fn expected(result: &Bound<'_, PyDict>, analysis: &Analysis, fit: &Fit) -> PyResult<()> {
    let py = result.py();
    let points: Option<Vec<Prediction>> = analysis.points.iter().map(|point| fit.expected(analysis, point)).collect();
    let Some(points) = points else { return Ok(()) };
    result.set_item("model", PyArray1::from_iter(py, points.iter().map(|point| point.dev)))?;
    result.set_item("model_lo", PyArray1::from_iter(py, points.iter().map(|point| point.lo)))?;
    result.set_item("model_hi", PyArray1::from_iter(py, points.iter().map(|point| point.hi)))?;
    let is_covered = analysis.stat == Stat::Oadev;
    let predicted: Vec<Option<Prediction>> =
        analysis.points.iter().map(|point| fit.predicted(point.m, analysis.samples).filter(|_| is_covered)).collect();
    let limits = |of: fn(Prediction) -> f64| predicted.iter().map(move |band| band.map_or(f64::NAN, of));
    result.set_item("predicted_lo", PyArray1::from_iter(py, limits(|band| band.lo)))?;
    result.set_item("predicted_hi", PyArray1::from_iter(py, limits(|band| band.hi)))
}

fn columns(result: &Bound<'_, PyDict>, analysis: &Analysis) -> PyResult<()> {
    let py = result.py();
    let points = &analysis.points;
    result.set_item("tau_s", PyArray1::from_iter(py, points.iter().map(|point| point.tau_s)))?;
    result.set_item("m", PyArray1::from_iter(py, points.iter().map(|point| point.m as i64)))?;
    result.set_item("dev", PyArray1::from_iter(py, points.iter().map(|point| point.dev)))?;
    result.set_item("lo", PyArray1::from_iter(py, points.iter().map(|point| point.lo)))?;
    result.set_item("hi", PyArray1::from_iter(py, points.iter().map(|point| point.hi)))?;
    result.set_item("edf", PyArray1::from_iter(py, points.iter().map(|point| point.edf)))?;
    result.set_item("alpha", PyArray1::from_iter(py, points.iter().map(|point| i64::from(point.alpha))))?;
    result.set_item("n", PyArray1::from_iter(py, points.iter().map(|point| point.n as i64)))?;
    result.set_item("stat", analysis.stat.name())?;
    result.set_item("rate_hz", analysis.rate_hz)?;
    result.set_item("samples", analysis.samples)?;
    result.set_item("missing", analysis.missing)?;
    let unavailable: Vec<(f64, String)> =
        analysis.unavailable.iter().map(|point| (point.tau_s, point.reason.to_string())).collect();
    result.set_item("unavailable", unavailable)
}

/// Computes deviations and their numbers of terms for averages of ``m`` samples; NaN and 0 if there is no deviation.
#[pyfunction]
pub fn deviations<'py>(
    py: Python<'py>,
    numbers: PyReadonlyArray1<'py, f64>,
    phase: bool,
    rate_hz: f64,
    stat: &str,
    m: Vec<u64>,
) -> PyResult<(Column<'py, f64>, Column<'py, i64>)> {
    let (stat, numbers) = (stat.parse().map_err(refused)?, numbers.as_slice()?);
    let input = if phase { Input::Phase(numbers) } else { Input::Rate(numbers) };
    let found = py.detach(|| of_input(&input, rate_hz, stat, &m));
    let (dev, n) = found.iter().map(|found| found.map_or((f64::NAN, 0), |found| (found.dev, found.n as i64))).unzip();
    Ok((PyArray1::from_vec(py, dev), PyArray1::from_vec(py, n)))
}

/// All statistics: the name that selects each, and its title.
#[pyfunction]
pub fn statistics() -> Vec<(&'static str, &'static str)> {
    Stat::ALL.into_iter().map(|stat| (stat.name(), stat.title())).collect()
}

fn refused(why: impl Display) -> PyErr {
    PyValueError::new_err(why.to_string())
}
