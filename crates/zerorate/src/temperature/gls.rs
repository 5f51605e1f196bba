//! Least squares under the part's own noise: a record is whitened by its covariance, so that all deviations weigh
//! the same.

use alloc::vec::Vec;
use zerorate_allan::linear::Cholesky;
pub(crate) use zerorate_allan::linear::{dot, take_out};

/// Share of its diagonal element below which a pivot counts as rounding error.
const LEAST_PIVOT: f64 = 1e-12;

/// Factors a covariance matrix, given by the rows of its lower triangle. `None` if it is not positive definite.
pub(crate) fn whitener(rows: Vec<Vec<f64>>) -> Option<Cholesky> {
    Cholesky::new(rows, LEAST_PIVOT)
}

/// Coefficients of whitened columns, and their uncertainty.
pub(crate) struct Fit {
    pub(crate) coefficients: Vec<f64>,
    information: Cholesky,
}

impl Fit {
    /// Finds the least-squares coefficients of `values`. `None` if the columns depend on each other.
    pub(crate) fn new(columns: &[Vec<f64>], values: &[f64]) -> Option<Self> {
        let products =
            |(i, column): (usize, &Vec<f64>)| columns[..=i].iter().map(|other| dot(column, other)).collect();
        let information = whitener(columns.iter().enumerate().map(products).collect())?;
        let coefficients = information.solve(columns.iter().map(|column| dot(column, values)));
        Some(Self { coefficients, information })
    }

    /// Variance of a sum of the coefficients with these weights.
    pub(crate) fn variance(&self, weights: &[f64]) -> f64 {
        let white = self.information.whiten(weights.iter().copied());
        dot(&white, &white)
    }
}
