//! Sums over short runs, such as of squared differences, compiled to the best vector instructions of the machine.

#![allow(clippy::needless_range_loop)]

use super::exact::ExactSum;
use alloc::vec;
use alloc::vec::Vec;

const LANES: usize = 16;

/// Sum of squared second differences of f64. The number of independent sums is fixed, so every machine rounds alike.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn second_f64(a: &[f64], b: &[f64], c: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let ((a, a_rest), (b, b_rest), (c, c_rest)) = (a.as_chunks(), b.as_chunks(), c.as_chunks());
    for ((a, b), c) in a.iter().zip(b).zip(c) {
        let (a, b, c): (&[f64; LANES], &[f64; LANES], &[f64; LANES]) = (a, b, c);
        for l in 0..LANES {
            let d = (c[l] - b[l]) - (b[l] - a[l]);
            sums[l] += d * d;
        }
    }
    for (((a, b), c), sum) in a_rest.iter().zip(b_rest).zip(c_rest).zip(&mut sums) {
        let d = (c - b) - (b - a);
        *sum += d * d;
    }
    sums.iter().sum()
}

/// Sum of the values, each less `offset`.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn sum_f64(values: &[f64], offset: f64) -> f64 {
    let mut sums = [0.0; LANES];
    let (chunks, rest) = values.as_chunks();
    for chunk in chunks {
        let chunk: &[f64; LANES] = chunk;
        for l in 0..LANES {
            sums[l] += chunk[l] - offset;
        }
    }
    sums.iter_mut().zip(rest).for_each(|(sum, value)| *sum += value - offset);
    sums.iter().sum()
}

/// A straight line through the phase.
#[derive(Clone, Copy)]
pub(super) struct Line {
    pub start: f64,
    /// Rise per sample.
    pub slope: f64,
}

impl Line {
    /// The height of x above the line. The sum `first` + `i` is an exact f64.
    #[inline(always)]
    fn level(self, first: f64, i: usize, x: f64) -> f64 {
        x - self.start - self.slope * (first + f64::from(i as u32))
    }
}

/// The largest deviations of the phase from a line.
pub(super) struct Reach {
    /// The largest distance from the line.
    pub level: f64,
    /// The largest change, from one point to the next, of the height above the line.
    pub difference: f64,
}

/// The reach of the points `x`, the first of which has the index `first`.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn reach(line: Line, first: usize, x: &[f64]) -> Reach {
    let first = first as f64;
    let (mut levels, mut differences) = ([0.0; LANES], [0.0; LANES]);
    let larger = |a: &mut f64, b: f64| *a = if b > *a { b } else { *a };
    for (at, x) in x.windows(LANES + 1).step_by(LANES).enumerate() {
        let x: &[f64; LANES + 1] = x.try_into().unwrap_or(&[0.0; LANES + 1]);
        for l in 0..LANES {
            let (before, level) =
                (line.level(first, at * LANES + l, x[l]), line.level(first, at * LANES + l + 1, x[l + 1]));
            larger(&mut levels[l], before.abs());
            larger(&mut differences[l], (level - before).abs());
        }
    }
    let mut reach = Reach { level: 0.0, difference: 0.0 };
    let rest = x.len().saturating_sub(1) / LANES * LANES;
    for i in rest..x.len() {
        let level = line.level(first, i, x[i]);
        larger(&mut reach.level, level.abs());
        if i > rest {
            larger(&mut reach.difference, (level - line.level(first, i - 1, x[i - 1])).abs());
        }
    }
    levels.iter().for_each(|level| larger(&mut reach.level, *level));
    differences.iter().for_each(|difference| larger(&mut reach.difference, *difference));
    reach
}

/// The level of a point, rounded to whole steps.
#[inline(always)]
fn steps(line: Line, per_step: f64, first: f64, i: usize, x: f64) -> i64 {
    /// 2^52. Every f64 above is a whole number.
    const WHOLE: f64 = 4_503_599_627_370_496.0;
    let exact = line.level(first, i, x) * per_step;
    let whole = WHOLE.copysign(exact);
    let rounded = (exact + whole) - whole;
    (if exact.abs() < WHOLE { rounded } else { exact }) as i64
}

/// Sum of the levels of points from number `first` on, in steps, modulo 2^64.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn sum_steps(line: Line, per_step: f64, first: usize, x: &[f64]) -> i64 {
    let first = first as f64;
    let of = |(i, x): (usize, &f64)| steps(line, per_step, first, i, *x);
    x.iter().enumerate().map(of).fold(0, i64::wrapping_add)
}

/// The running sum of the levels of points, in steps, from `before` on.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn run_steps(line: Line, per_step: f64, first: usize, x: &[f64], before: i64, out: &mut [i64]) {
    let mut sum = before;
    for (at, (x, out)) in x.chunks(SHORT).zip(out.chunks_mut(SHORT)).enumerate() {
        let first = (first + at * SHORT) as f64;
        x.iter().enumerate().zip(&mut *out).for_each(|((i, x), out)| *out = steps(line, per_step, first, i, *x));
        for out in out {
            sum = sum.wrapping_add(*out);
            *out = sum;
        }
    }
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn third_f64(a: &[f64], b: &[f64], c: &[f64], d: &[f64]) -> f64 {
    let mut sums = [0.0; LANES];
    let ((a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)) =
        (a.as_chunks(), b.as_chunks(), c.as_chunks(), d.as_chunks());
    for (((a, b), c), d) in a.iter().zip(b).zip(c).zip(d) {
        let (a, b, c, d): (&[f64; LANES], &[f64; LANES], &[f64; LANES], &[f64; LANES]) = (a, b, c, d);
        for l in 0..LANES {
            let third = ((d[l] - c[l]) - (c[l] - b[l])) - ((c[l] - b[l]) - (b[l] - a[l]));
            sums[l] += third * third;
        }
    }
    for ((((a, b), c), d), sum) in a_rest.iter().zip(b_rest).zip(c_rest).zip(d_rest).zip(&mut sums) {
        let third = ((d - c) - (c - b)) - ((c - b) - (b - a));
        *sum += third * third;
    }
    sums.iter().sum()
}

/// Number of codes in one partial sum, and of points in one step of [`run_steps`].
pub(super) const SHORT: usize = 64;

pub(super) struct Survey {
    pub low: i32,
    pub high: i32,
    /// The sums of [`SHORT`] codes each.
    pub sums: Vec<i64>,
}

#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn survey(codes: &[i32]) -> Survey {
    let mut survey = Survey { low: i32::MAX, high: i32::MIN, sums: vec![0; codes.len().div_ceil(SHORT)] };
    for (short, sum) in codes.chunks(SHORT).zip(&mut survey.sums) {
        let (mut total, mut low, mut high) = (0, i32::MAX, i32::MIN);
        for &code in short {
            total += i64::from(code);
            (low, high) = (low.min(code), high.max(code));
        }
        *sum = total;
        (survey.low, survey.high) = (survey.low.min(low), survey.high.max(high));
    }
    survey
}

/// Number of values below 2^28 whose squares fit into a sum of 64 bits.
const RUN: usize = 256;

/// Sum of squared second differences of i32 modulo 2^32, all of which are below 2^28.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn second_i32(a: &[i32], b: &[i32], c: &[i32]) -> ExactSum {
    let mut sum = 0u128;
    for ((a, b), c) in a.chunks(RUN).zip(b.chunks(RUN)).zip(c.chunks(RUN)) {
        let mut squares = 0u64;
        for ((a, b), c) in a.iter().zip(b).zip(c) {
            let d = i64::from(c.wrapping_sub(*b).wrapping_sub(b.wrapping_sub(*a)));
            squares = squares.wrapping_add((d * d) as u64);
        }
        sum += u128::from(squares);
    }
    ExactSum::from(sum)
}

/// Sum of squared third differences of i32 modulo 2^32, all of which are below 2^28.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn third_i32(a: &[i32], b: &[i32], c: &[i32], d: &[i32]) -> ExactSum {
    let mut sum = 0u128;
    for (((a, b), c), d) in a.chunks(RUN).zip(b.chunks(RUN)).zip(c.chunks(RUN)).zip(d.chunks(RUN)) {
        let mut squares = 0u64;
        for (((a, b), c), d) in a.iter().zip(b).zip(c).zip(d) {
            let middle = c.wrapping_sub(*b);
            let third = i64::from(d.wrapping_sub(*a).wrapping_sub(middle.wrapping_add(middle).wrapping_add(middle)));
            squares = squares.wrapping_add((third * third) as u64);
        }
        sum += u128::from(squares);
    }
    ExactSum::from(sum)
}

/// Number of values below 2^56 whose squares fit in parts into sums of 64 bits.
const LONG_RUN: usize = 128;
/// Values below 2^56 are split in two at this bit, before they are squared.
const SPLIT: u32 = 28;

/// A sum of squares of values that are split in two.
#[derive(Default)]
struct Parts {
    high: u64,
    middle: i64,
    low: u64,
}

impl Parts {
    #[inline(always)]
    fn add_square(&mut self, number: i64) {
        let high = i64::from((number as u64 >> SPLIT) as i32);
        let low = number & ((1 << SPLIT) - 1);
        self.high = self.high.wrapping_add((high * high) as u64);
        self.middle = self.middle.wrapping_add(high * low);
        self.low = self.low.wrapping_add((low * low) as u64);
    }

    fn total(&self) -> u128 {
        let total =
            (i128::from(self.high) << (2 * SPLIT)) + (i128::from(self.middle) << (SPLIT + 1)) + i128::from(self.low);
        total as u128
    }
}

/// Sum of at most 2^16 squared second differences of i64 modulo 2^64, all of which are below 2^56.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn second_i64(a: &[i64], b: &[i64], c: &[i64]) -> ExactSum {
    let mut sum = 0;
    for ((a, b), c) in a.chunks(LONG_RUN).zip(b.chunks(LONG_RUN)).zip(c.chunks(LONG_RUN)) {
        let mut parts = Parts::default();
        for ((a, b), c) in a.iter().zip(b).zip(c) {
            parts.add_square(c.wrapping_sub(*b).wrapping_sub(b.wrapping_sub(*a)));
        }
        sum += parts.total();
    }
    ExactSum::from(sum)
}

/// Sum of at most 2^16 squared third differences of i64 modulo 2^64, all of which are below 2^56.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn third_i64(a: &[i64], b: &[i64], c: &[i64], d: &[i64]) -> ExactSum {
    let mut sum = 0;
    let chunks = a.chunks(LONG_RUN).zip(b.chunks(LONG_RUN)).zip(c.chunks(LONG_RUN)).zip(d.chunks(LONG_RUN));
    for (((a, b), c), d) in chunks {
        let mut parts = Parts::default();
        for (((a, b), c), d) in a.iter().zip(b).zip(c).zip(d) {
            let middle = c.wrapping_sub(*b);
            parts.add_square(d.wrapping_sub(*a).wrapping_sub(middle.wrapping_add(middle).wrapping_add(middle)));
        }
        sum += parts.total();
    }
    ExactSum::from(sum)
}

/// Sum of squared third differences of fixed-point numbers, squared in f64.
#[cfg_attr(feature = "std", multiversion::multiversion(targets("x86_64+avx512dq", "x86_64+avx2+fma", "aarch64+neon")))]
pub(super) fn third_fixed(a: &[i64], b: &[i64], c: &[i64], d: &[i64]) -> f64 {
    let mut sums = [0.0; LANES];
    let third = |a: i64, b: i64, c: i64, d: i64| {
        let middle = c.wrapping_sub(b);
        to_f64(d.wrapping_sub(a).wrapping_sub(middle.wrapping_add(middle).wrapping_add(middle)))
    };
    let ((a, a_rest), (b, b_rest), (c, c_rest), (d, d_rest)) =
        (a.as_chunks(), b.as_chunks(), c.as_chunks(), d.as_chunks());
    for (((a, b), c), d) in a.iter().zip(b).zip(c).zip(d) {
        let (a, b, c, d): (&[i64; LANES], &[i64; LANES], &[i64; LANES], &[i64; LANES]) = (a, b, c, d);
        for l in 0..LANES {
            let third = third(a[l], b[l], c[l], d[l]);
            sums[l] += third * third;
        }
    }
    for ((((a, b), c), d), sum) in a_rest.iter().zip(b_rest).zip(c_rest).zip(d_rest).zip(&mut sums) {
        let third = third(*a, *b, *c, *d);
        *sum += third * third;
    }
    sums.iter().sum()
}

/// Converts like `as f64`, by two halves put into the bits of an f64: many machines cannot convert i64 vectors.
#[inline(always)]
fn to_f64(number: i64) -> f64 {
    /// 2^52 and 2^84, in whose mantissas 32 bits stand for 0 … 2^32 − 1 and for multiples of 2^32.
    const UNITS: u64 = 0x4330_0000_0000_0000;
    const TWO_POW_32: u64 = 0x4530_0000_0000_0000;
    let low = f64::from_bits(UNITS | (number as u64 & 0xffff_ffff));
    let high = f64::from_bits(TWO_POW_32 ^ 0x8000_0000 ^ (number as u64 >> 32));
    (high - (f64::from_bits(TWO_POW_32 | 0x8000_0000) + f64::from_bits(UNITS))) + low
}
