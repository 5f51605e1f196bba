use super::shape::Shape;
use super::{Reason, Squares};
use alloc::vec::Vec;

/// Running sum of the rate less its mean.
pub(super) fn phase(rate: &[f64]) -> Vec<f64> {
    let mean = rate.iter().sum::<f64>() / rate.len().max(1) as f64;
    let sums = rate.iter().scan(0.0, |sum, &value| {
        *sum += value - mean;
        Some(*sum)
    });
    core::iter::once(0.0).chain(sums).collect()
}

pub(super) fn squares(x: &[f64], shape: Shape, m: &[usize]) -> Vec<Result<Squares, Reason>> {
    let squares = |&m| Squares { sum: sum(x, shape, m), n: shape.terms(x.len(), m) as u64, per: shape.per(m) };
    m.iter().map(|m| Ok(squares(m))).collect()
}

fn sum(x: &[f64], shape: Shape, m: usize) -> f64 {
    let second = |i: usize| (x[i + 2 * m] - x[i + m]) - (x[i + m] - x[i]);
    let third = |i: usize| second(i + m) - second(i);
    let starts = (0..shape.terms(x.len(), m)).map(|term| term * shape.stride(m));
    match shape {
        Shape::Second { .. } => starts.map(|i| square(second(i))).sum(),
        Shape::Third { .. } => starts.map(|i| square(third(i))).sum(),
        Shape::Modified => {
            let mut inner = (0..m).map(second).sum();
            let first = square(inner);
            let rest = starts.take(x.len() - 3 * m).map(|i| {
                inner += third(i);
                square(inner)
            });
            first + rest.sum::<f64>()
        }
        Shape::Total => starts.map(|i| square(reflected(x, i + 1, m))).sum(),
    }
}

/// Second difference around the point `i`, of x continued by reflection through its ends.
fn reflected(x: &[f64], i: usize, m: usize) -> f64 {
    let last = x.len() - 1;
    let before = if i < m { 2.0 * x[0] - x[m - i] } else { x[i - m] };
    let after = if i + m > last { 2.0 * x[last] - x[2 * last - i - m] } else { x[i + m] };
    (after - x[i]) - (x[i] - before)
}

fn square(number: f64) -> f64 {
    number * number
}
