//! Cholesky factors of the small positive definite matrices of the fit (at most some 40 rows).

use alloc::vec;
use alloc::vec::Vec;

/// A square matrix, row by row.
#[derive(Clone, Debug)]
pub(super) struct Square {
    pub(super) n: usize,
    pub(super) cells: Vec<f64>,
}

impl Square {
    pub(super) fn from_fn(n: usize, mut cell: impl FnMut(usize, usize) -> f64) -> Self {
        let cells = (0..n * n).map(|i| cell(i / n, i % n)).collect();
        Self { n, cells }
    }

    pub(super) fn at(&self, row: usize, column: usize) -> f64 {
        self.cells[row * self.n + column]
    }

    /// By elimination with row pivots.
    #[cfg(feature = "std")]
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

/// L with L·Lᵀ = the matrix.
pub(super) struct Cholesky(Square);

impl Cholesky {
    /// None where the matrix is not positive definite.
    pub(super) fn new(matrix: &Square) -> Option<Self> {
        let n = matrix.n;
        let mut l = Square { n, cells: vec![0.0; n * n] };
        for row in 0..n {
            for column in 0..=row {
                let known: f64 = (0..column).map(|k| l.at(row, k) * l.at(column, k)).sum();
                let rest = matrix.at(row, column) - known;
                l.cells[row * n + column] = match row == column {
                    true if rest > 0.0 => libm::sqrt(rest),
                    true => return None,
                    false => rest / l.at(column, column),
                };
            }
        }
        Some(Self(l))
    }

    /// ln of the determinant of the matrix.
    #[cfg(feature = "std")]
    pub(super) fn ln_determinant(&self) -> f64 {
        (0..self.0.n).map(|i| 2.0 * libm::log(self.0.at(i, i))).sum()
    }

    /// L⁻¹·b
    pub(super) fn whiten(&self, mut b: Vec<f64>) -> Vec<f64> {
        for row in 0..self.0.n {
            let known: f64 = (0..row).map(|k| self.0.at(row, k) * b[k]).sum();
            b[row] = (b[row] - known) / self.0.at(row, row);
        }
        b
    }

    /// L⁻ᵀ·b
    pub(super) fn unwhiten(&self, mut b: Vec<f64>) -> Vec<f64> {
        for row in (0..self.0.n).rev() {
            let known: f64 = (row + 1..self.0.n).map(|k| self.0.at(k, row) * b[k]).sum();
            b[row] = (b[row] - known) / self.0.at(row, row);
        }
        b
    }

    /// Matrix⁻¹·b
    pub(super) fn solve(&self, b: Vec<f64>) -> Vec<f64> {
        self.unwhiten(self.whiten(b))
    }
}

pub(super) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
