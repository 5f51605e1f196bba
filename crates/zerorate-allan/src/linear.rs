//! Small square matrices (at most some hundred rows) and the Cholesky factors of positive definite ones.

use alloc::vec::Vec;

/// A square matrix, row by row.
#[cfg(feature = "std")]
#[derive(Clone, Debug)]
pub(super) struct Square {
    pub(super) n: usize,
    pub(super) cells: Vec<f64>,
}

#[cfg(feature = "std")]
impl Square {
    pub(super) fn from_fn(n: usize, mut cell: impl FnMut(usize, usize) -> f64) -> Self {
        let cells = (0..n * n).map(|i| cell(i / n, i % n)).collect();
        Self { n, cells }
    }

    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        self.cells[row * self.n + column]
    }

    /// The Cholesky factor; `None` if the matrix is not positive definite.
    pub(super) fn cholesky(&self) -> Option<Cholesky> {
        Cholesky::new((0..self.n).map(|i| self.cells[i * self.n..=i * self.n + i].to_vec()).collect(), 0.0)
    }

    pub(super) fn determinant(mut self) -> f64 {
        let n = self.n;
        let mut determinant = 1.0;
        for column in 0..n {
            let size = |row: &usize| libm::fabs(self.at(*row, column));
            let pivot = (column..n).max_by(|a, b| size(a).total_cmp(&size(b))).unwrap_or(column);
            if self.at(pivot, column) == 0.0 {
                return 0.0;
            }
            if pivot != column {
                (0..n).for_each(|k| self.cells.swap(pivot * n + k, column * n + k));
                determinant = -determinant;
            }
            determinant *= self.at(column, column);
            for row in column + 1..n {
                let factor = self.at(row, column) / self.at(column, column);
                (column..n).for_each(|k| self.cells[row * n + k] -= factor * self.at(column, k));
            }
        }
        determinant
    }
}

/// The Cholesky factor L of a positive definite matrix L·Lᵀ, as the rows of its lower triangle.
#[derive(Clone, Debug)]
pub struct Cholesky(Vec<Vec<f64>>);

impl Cholesky {
    /// Factors the matrix from the rows of its lower triangle. `None` if a pivot is not above `least_pivot` times its
    /// diagonal element: the matrix is not positive definite, or nearly singular.
    #[must_use]
    pub fn new(mut rows: Vec<Vec<f64>>, least_pivot: f64) -> Option<Self> {
        for i in 0..rows.len() {
            let (above, rest) = rows.split_at_mut(i);
            let row = &mut rest[0];
            for (j, other) in above.iter().enumerate() {
                row[j] = (row[j] - dot(&row[..j], &other[..j])) / other[j];
            }
            let (full, pivot) = (row[i], row[i] - dot(&row[..i], &row[..i]));
            if pivot.is_nan() || pivot <= least_pivot * full {
                return None;
            }
            row[i] = libm::sqrt(pivot);
        }
        Some(Self(rows))
    }

    /// ln of the determinant of the matrix.
    #[must_use]
    pub fn ln_determinant(&self) -> f64 {
        self.0.iter().enumerate().map(|(i, row)| 2.0 * libm::log(row[i])).sum()
    }

    /// L⁻¹·b, which has unit covariance where b has the covariance of the matrix.
    #[must_use]
    pub fn whiten(&self, b: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut white = Vec::with_capacity(self.0.len());
        for (row, value) in self.0.iter().zip(b) {
            let i = white.len();
            white.push((value - dot(&row[..i], &white)) / row[i]);
        }
        white
    }

    /// The solution x of L·Lᵀ·x = b.
    #[must_use]
    pub fn solve(&self, b: impl IntoIterator<Item = f64>) -> Vec<f64> {
        let mut x = self.whiten(b);
        for i in (0..x.len()).rev() {
            let below: f64 = (i + 1..x.len()).map(|k| self.0[k][i] * x[k]).sum();
            x[i] = (x[i] - below) / self.0[i][i];
        }
        x
    }
}

/// The scalar product a·b.
#[must_use]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// Removes the projection on the unit vector `unit` from `column`.
pub fn take_out(column: &mut [f64], unit: &[f64]) {
    let share = dot(column, unit);
    column.iter_mut().zip(unit).for_each(|(value, unit)| *value -= share * unit);
}
