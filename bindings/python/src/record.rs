//! A record of one axis, as Python gives it.

use numpy::PyReadonlyArray1;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use zerorate_allan::{Gap, Input};

/// A record: integer codes of a rate, or numbers.
#[derive(FromPyObject)]
pub enum Record<'py> {
    Codes(PyReadonlyArray1<'py, i32>),
    Numbers(PyReadonlyArray1<'py, f64>),
}

impl Record<'_> {
    /// The record as the core takes it, without a copy. `gaps` are the gaps in codes. Missing numbers are NaN.
    pub fn input<'a>(&'a self, phase: bool, gaps: &'a [Gap]) -> PyResult<Input<'a>> {
        Ok(match self {
            Self::Codes(_) if phase => return Err(PyValueError::new_err("give phase as floating-point numbers")),
            Self::Codes(codes) => Input::Codes { codes: codes.as_slice()?, gaps },
            Self::Numbers(numbers) if phase => Input::Phase(numbers.as_slice()?),
            Self::Numbers(numbers) => Input::Rate(numbers.as_slice()?),
        })
    }
}
