//! Least squares under the part's own noise: a record is whitened by its covariance, and after that every deviation
//! counts the same.

use alloc::vec::Vec;

/// The Cholesky factor of a covariance matrix: rows of its lower triangle.
#[derive(Clone, Debug)]
pub(crate) struct Whitener {
    rows: Vec<Vec<f64>>,
}

impl Whitener {
    /// From the lower triangle of a covariance matrix; none where that is not positive definite.
    pub(crate) fn new(mut rows: Vec<Vec<f64>>) -> Option<Self> {
        for i in 0..rows.len() {
            let (above, rest) = rows.split_at_mut(i);
            let row = &mut rest[0];
            for (j, other) in above.iter().enumerate() {
                row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
            }
            let (full, pivot) = (row[i], row[i] - dot(&row[..i], &row[..i]));
            if pivot.is_nan() || pivot <= 1e-12 * full {
                return None;
            }
            row[i] = libm::sqrt(pivot);
        }
        Some(Self { rows })
    }

    /// What has unit covariance where `values` have the matrix's.
    pub(crate) fn whiten(&self, values: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut white = Vec::with_capacity(self.rows.len());
        for (row, value) in self.rows.iter().zip(values) {
            let i = white.len();
            white.push((value - dot(&row[..i], &white)) / row[i]);
        }
        white
    }

    /// The solution x of C x = `values`, C being the covariance matrix.
    pub(crate) fn solve(&self, values: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut solution = self.whiten(values);
        for i in (0..solution.len()).rev() {
            let below: f64 = (i + 1..solution.len()).map(|k| self.rows[k][i] * solution[k]).sum();
            solution[i] = (solution[i] - below) / self.rows[i][i];
        }
        solution
    }

    /// Logarithm of the determinant of the covariance matrix.
    pub(crate) fn log_determinant(&self) -> f64 {
        self.rows.iter().enumerate().map(|(i, row)| 2.0 * libm::log(row[i])).sum()
    }
}

/// Coefficients of whitened columns, and how well they are known.
pub(crate) struct Fit {
    pub(crate) coefficients: Vec<f64>,
    information: Whitener,
}

impl Fit {
    /// The coefficients that leave least of `values`; none where the columns depend on each other.
    pub(crate) fn new(columns: &[Vec<f64>], values: &[f64]) -> Option<Self> {
        let products =
            |(i, column): (usize, &Vec<f64>)| columns[..=i].iter().map(|other| dot(column, other)).collect();
        let information = Whitener::new(columns.iter().enumerate().map(products).collect())?;
        let coefficients = information.solve(columns.iter().map(|column| dot(column, values)));
        Some(Self { coefficients, information })
    }

    /// Variance of a sum of the coefficients with these weights.
    pub(crate) fn variance(&self, weights: &[f64]) -> f64 {
        let white = self.information.whiten(weights.iter().copied());
        dot(&white, &white)
    }
}

/// Takes out of `column` what the unit vector `unit` explains.
pub(crate) fn take_out(column: &mut [f64], unit: &[f64]) {
    let share = dot(column, unit);
    column.iter_mut().zip(unit).for_each(|(value, unit)| *value -= share * unit);
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
