use super::exact::ExactSum;
use super::shape::Shape;
use super::{Reason, Squares};
use alloc::vec::Vec;

/// Exact: neither the running sum nor a square rounds.
pub(super) fn squares(codes: &[i32], shape: Shape, m: &[usize]) -> Vec<Result<Squares, Reason>> {
    let x = running_sum(codes);
    let squares =
        |&m| Squares { sum: sum(&x, shape, m).to_f64(), n: shape.terms(x.len(), m) as u64, per: shape.per(m) };
    m.iter().map(|m| Ok(squares(m))).collect()
}

fn running_sum(codes: &[i32]) -> Vec<i64> {
    let sums = codes.iter().scan(0i64, |sum, &code| {
        *sum += i64::from(code);
        Some(*sum)
    });
    core::iter::once(0).chain(sums).collect()
}

fn sum(x: &[i64], shape: Shape, m: usize) -> ExactSum {
    let mut sum = ExactSum::default();
    let at = |i: usize| i128::from(x[i]);
    let second = |i: usize| at(i + 2 * m) - 2 * at(i + m) + at(i);
    let third = |i: usize| second(i + m) - second(i);
    let starts = (0..shape.terms(x.len(), m)).map(|term| term * shape.stride(m));
    match shape {
        Shape::Second { .. } => starts.for_each(|i| sum.add_square(second(i))),
        Shape::Third { .. } => starts.for_each(|i| sum.add_square(third(i))),
        Shape::Modified => {
            let mut inner = (0..m).map(second).sum();
            sum.add_square(inner);
            for i in starts.take(x.len() - 3 * m) {
                inner += third(i);
                sum.add_square(inner);
            }
        }
        Shape::Total => starts.for_each(|i| sum.add_square(reflected(x, i + 1, m))),
    }
    sum
}

/// Second difference around the point `i`, of x continued by reflection through its ends.
fn reflected(x: &[i64], i: usize, m: usize) -> i128 {
    let last = x.len() - 1;
    let at = |i: usize| i128::from(x[i]);
    let before = if i < m { 2 * at(0) - at(m - i) } else { at(i - m) };
    let after = if i + m > last { 2 * at(last) - at(2 * last - i - m) } else { at(i + m) };
    before - 2 * at(i) + after
}
