use super::exact::ExactSum;
use super::shape::Shape;
use super::{Reason, Squares, sweep, threads};
use alloc::vec;
use alloc::vec::Vec;

/// Exact: no running sum, no difference and no square rounds or overflows.
///
/// A difference that is known to be small may be formed from running sums modulo a power of two: the narrower these are, the less
/// memory has to be read.
pub(super) fn squares(codes: &[i32], shape: Shape, m: &[usize]) -> Vec<Result<Squares, Reason>> {
    let bounds = Bounds::of(codes);
    let width = |&m: &usize| bounds.width(shape, m);
    let by_width = [Width::Narrow, Width::Middle, Width::Wide].map(|this| {
        let m: Vec<usize> = m.iter().copied().filter(|m| width(m) == this).collect();
        sums(codes, bounds.offset, shape, &m, this).into_iter()
    });
    let [mut narrow, mut middle, mut wide] = by_width;
    let mut next = |m: &usize| match width(m) {
        Width::Narrow => narrow.next(),
        Width::Middle => middle.next(),
        Width::Wide => wide.next(),
    };
    let n = |m| shape.terms(codes.len() + 1, m) as u64;
    let squares = |sum: ExactSum, m| Squares { sum: sum.to_f64(), n: n(m), per: shape.per(m) };
    m.iter().map(|m| next(m).map(|sum| squares(sum, *m)).ok_or(Reason::NotFinite)).collect()
}

/// How many bits the differences need.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Width {
    /// Below 2^30.
    Narrow,
    /// Below 2^57.
    Middle,
    /// Any.
    Wide,
}

/// What bounds the differences. The offset, which no difference sees, keeps the running sum small.
struct Bounds {
    offset: i64,
    /// Largest less smallest code.
    codes: u128,
    /// Largest less smallest running sum.
    sums: u128,
}

impl Bounds {
    fn of(codes: &[i32]) -> Self {
        let (mut total, mut low, mut high) = (0i64, i32::MAX, i32::MIN);
        for &code in codes {
            total += i64::from(code);
            (low, high) = (low.min(code), high.max(code));
        }
        let offset = total / codes.len().max(1) as i64;
        let (mut sum, mut least, mut most) = (0i64, 0i64, 0i64);
        for &code in codes {
            sum += i64::from(code) - offset;
            (least, most) = (least.min(sum), most.max(sum));
        }
        Self { offset, codes: (i64::from(high) - i64::from(low)).max(0) as u128, sums: most.abs_diff(least).into() }
    }

    /// A difference of two sums over m is below m times the range of the codes, and below twice the range of the running sum
    /// (four times, where it is reflected or a third difference).
    fn width(&self, shape: Shape, m: usize) -> Width {
        let long = m as u128;
        let largest = match shape {
            Shape::Second { .. } => (2 * self.sums).min(long * self.codes),
            Shape::Third { .. } => (4 * self.sums).min(2 * long * self.codes),
            Shape::Total => (4 * self.sums).min(long * self.codes),
            Shape::Modified => long * (2 * self.sums).min(long * self.codes),
        };
        match largest {
            _ if shape.stride(2) > 1 => Width::Wide,
            0..NARROW if shape != Shape::Modified => Width::Narrow,
            0..MIDDLE => Width::Middle,
            _ => Width::Wide,
        }
    }
}

const NARROW: u128 = 1 << 30;
const MIDDLE: u128 = 1 << 57;

fn sums(codes: &[i32], offset: i64, shape: Shape, m: &[usize], width: Width) -> Vec<ExactSum> {
    if m.is_empty() {
        return Vec::new();
    }
    match width {
        Width::Narrow => sweep::sums(&narrow_sum(codes, offset as i32), shape, m),
        Width::Middle if shape == Shape::Modified => {
            sweep::sums(&sum_of_sums(codes, offset), Shape::Third { overlapping: true }, m)
        }
        Width::Middle => sweep::sums(&running_sum(codes, offset), shape, m),
        Width::Wide => {
            let x = running_sum(codes, offset);
            threads::map(m.len(), |i| sum(&x, shape, m[i]))
        }
    }
}

/// Modulo 2^32.
fn narrow_sum(codes: &[i32], offset: i32) -> Vec<i32> {
    let mut x = vec![0; codes.len() + 1];
    let mut sum = 0i32;
    for (x, code) in x[1..].iter_mut().zip(codes) {
        sum = sum.wrapping_add(*code).wrapping_sub(offset);
        *x = sum;
    }
    x
}

fn running_sum(codes: &[i32], offset: i64) -> Vec<i64> {
    let mut x = vec![0; codes.len() + 1];
    let mut sum = 0;
    for (x, &code) in x[1..].iter_mut().zip(codes) {
        sum += i64::from(code) - offset;
        *x = sum;
    }
    x
}

/// Running sum of the running sum, modulo 2^64: its third differences are the inner sums of the modified Allan deviation.
fn sum_of_sums(codes: &[i32], offset: i64) -> Vec<i64> {
    let mut out = vec![0; codes.len() + 2];
    let (mut sum, mut sum_of_sums) = (0i64, 0i64);
    for (out, &code) in out[2..].iter_mut().zip(codes) {
        sum += i64::from(code) - offset;
        sum_of_sums = sum_of_sums.wrapping_add(sum);
        *out = sum_of_sums;
    }
    out
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
