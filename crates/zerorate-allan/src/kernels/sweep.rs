//! Computes all averaging times in one pass over the running sum.
//!
//! A start is the first point of a difference. A block of starts goes through every averaging time before the next
//! block does, so data that two averaging times share are read from memory once. Blocks are cut at fixed places
//! and their sums are added in order, so any number of threads gives the same bits.

use super::array::Number;
use super::exact::ExactSum;
use super::lanes;
use super::threads;
use crate::kernel::{Order, Plain};
use alloc::vec;
use alloc::vec::Vec;
use core::ops::{AddAssign, Range};

/// Number of starts in a block. The data that one averaging time reads for a block fit into the first-level cache, and
/// the data of all averaging times fit into the second-level cache.
const BLOCK: usize = 2048;
/// Starts that one thread takes at a time.
const PIECE: usize = 64 * BLOCK;
/// Averages of a multiple of this many samples are computed by columns. Otherwise the data that these averages share
/// would not stay in the second-level cache.
const ROW: usize = 1 << 16;
/// Bytes of each row that are taken at a time. The second-level cache holds them for nearly all rows of 10^8 samples.
const COLUMN_BYTES: usize = 2048;

/// Forms differences of a running sum, and sums their squares.
pub(super) trait Step {
    /// A value of the running sum.
    type Number: Number + Default + Send + Sync;
    type Sum: Copy + Default + Send + AddAssign;

    /// 2 · `end` − `number`.
    fn reflected(number: Self::Number, end: Self::Number) -> Self::Number;
    fn second(a: &[Self::Number], b: &[Self::Number], c: &[Self::Number]) -> Self::Sum;
    fn third(a: &[Self::Number], b: &[Self::Number], c: &[Self::Number], d: &[Self::Number]) -> Self::Sum;
}

/// Sum of the squared differences for each of `m`.
pub(super) fn sums<T: Step>(x: &[T::Number], plain: Plain, m: &[usize]) -> Vec<T::Sum> {
    let is_far = |m: usize| m.is_multiple_of(ROW) && plain.overlapping;
    let (far, near): (Vec<usize>, Vec<usize>) = m.iter().partition(|&&m| is_far(m));
    let mut near = near_sums::<T>(x, plain, &near).into_iter();
    let mut far = far_sums::<T>(x, plain, &far).into_iter();
    m.iter().filter_map(|&m| if is_far(m) { far.next() } else { near.next() }).collect()
}

fn near_sums<T: Step>(x: &[T::Number], plain: Plain, m: &[usize]) -> Vec<T::Sum> {
    let starts = m.iter().map(|&m| plain.starts_end(x.len(), m)).max().unwrap_or(0);
    let pieces = threads::map(starts.div_ceil(PIECE), |piece| {
        block_sums::<T>(x, plain, m, piece * PIECE..starts.min((piece + 1) * PIECE))
    });
    joined::<T>(pieces, m.len())
}

/// Handles averages of a multiple of [`ROW`] samples. In a table with rows of [`ROW`] points, their differences
/// stay within a column. As many columns as fit into the cache are processed as one record.
fn far_sums<T: Step>(x: &[T::Number], plain: Plain, m: &[usize]) -> Vec<T::Sum> {
    if m.is_empty() {
        return Vec::new();
    }
    let (rows, rest) = (x.len() / ROW, x.len() % ROW);
    let width = COLUMN_BYTES / size_of::<T::Number>();
    let columns = |rows: usize, range: Range<usize>| {
        range.clone().step_by(width).map(move |from| (rows, from, width.min(range.end - from)))
    };
    let tiles: Vec<_> = columns(rows + 1, 0..rest).chain(columns(rows, rest..ROW)).collect();
    let tiles = threads::map_with(tiles.len(), Vec::new, |tile, i| {
        let (rows, from, width) = tiles[i];
        tile.clear();
        (0..rows).for_each(|row| tile.extend_from_slice(&x[row * ROW + from..][..width]));
        let m: Vec<usize> = m.iter().map(|m| m / ROW * width).collect();
        block_sums::<T>(tile, plain, &m, 0..tile.len())
    });
    joined::<T>(tiles, m.len())
}

fn joined<T: Step>(parts: Vec<Vec<T::Sum>>, len: usize) -> Vec<T::Sum> {
    let mut sums = vec![T::Sum::default(); len];
    for part in parts {
        sums.iter_mut().zip(part).for_each(|(sum, more)| *sum += more);
    }
    sums
}

fn block_sums<T: Step>(x: &[T::Number], plain: Plain, m: &[usize], starts: Range<usize>) -> Vec<T::Sum> {
    let mut sums = vec![T::Sum::default(); m.len()];
    for start in starts.clone().step_by(BLOCK) {
        for (&m, sum) in m.iter().zip(&mut sums) {
            let end = plain.starts_end(x.len(), m).min(start + BLOCK).min(starts.end);
            if start < end {
                *sum += block_sum::<T>(x, plain, m, start..end);
            }
        }
    }
    sums
}

fn block_sum<T: Step>(x: &[T::Number], plain: Plain, m: usize, starts: Range<usize>) -> T::Sum {
    let stream = |k: usize| &x[starts.start + k * m..starts.end + k * m];
    match plain.order {
        _ if plain.stride(m) > 1 => strided::<T>(x, plain, m, starts),
        Order::Second => T::second(stream(0), stream(1), stream(2)),
        Order::Third => T::third(stream(0), stream(1), stream(2), stream(3)),
    }
}

/// The sum over differences that start at every m-th point. These points are a record with averages of one sample.
fn strided<T: Step>(x: &[T::Number], plain: Plain, m: usize, starts: Range<usize>) -> T::Sum {
    let first = starts.start.next_multiple_of(m);
    if first >= starts.end {
        return T::Sum::default();
    }
    let mut points = [T::Number::default(); BLOCK / 2 + 3];
    let terms = (starts.end - first).div_ceil(m);
    points.iter_mut().zip(x[first..].iter().step_by(m)).take(terms + 3).for_each(|(point, x)| *point = *x);
    let stream = |k: usize| &points[k..k + terms];
    match plain.order {
        Order::Second => T::second(stream(0), stream(1), stream(2)),
        Order::Third => T::third(stream(0), stream(1), stream(2), stream(3)),
    }
}

/// Sum of the squared second differences of the reflected record, for each of `m`. Around points within m of the ends
/// of the record, they include reflected points.
pub(super) fn reflected_sums<T: Step>(x: &[T::Number], m: &[usize]) -> Vec<T::Sum> {
    let mut sums = sums::<T>(x, Plain::WITHIN, m);
    let last = x.len() - 1;
    let edges = threads::map(m.len(), |i| {
        let start_end = m[i].min(last);
        let mut sum = T::Sum::default();
        for edge in [1..start_end, start_end.max(x.len() - m[i])..last] {
            for from in edge.clone().step_by(BLOCK) {
                sum += reflected::<T>(x, m[i], from..edge.end.min(from + BLOCK));
            }
        }
        sum
    });
    sums.iter_mut().zip(edges).for_each(|(sum, edge)| *sum += edge);
    sums
}

/// Sum over the terms around the points `middles`. The caller passes points of which all or none are within m of the
/// start. The range is split so that this holds for the end as well.
fn reflected<T: Step>(x: &[T::Number], m: usize, middles: Range<usize>) -> T::Sum {
    let cut = x.len().saturating_sub(m).clamp(middles.start, middles.end);
    let mut sum = T::Sum::default();
    for middles in [middles.start..cut, cut..middles.end] {
        if !middles.is_empty() {
            sum += reflected_alike::<T>(x, m, middles);
        }
    }
    sum
}

fn reflected_alike<T: Step>(x: &[T::Number], m: usize, middles: Range<usize>) -> T::Sum {
    let (len, last) = (middles.len(), x.len() - 1);
    let (mut before, mut after) = ([T::Number::default(); BLOCK], [T::Number::default(); BLOCK]);
    let (before, after) = (&mut before[..len], &mut after[..len]);
    let backwards = |out: &mut [T::Number], first: usize, end: T::Number| {
        let from = x[first + 1 - len..=first].iter().rev();
        out.iter_mut().zip(from).for_each(|(out, x)| *out = T::reflected(*x, end));
    };
    match m.checked_sub(middles.start).filter(|first| *first > 0) {
        Some(first) => backwards(before, first, x[0]),
        None => before.copy_from_slice(&x[middles.start - m..][..len]),
    }
    match (middles.start + m).checked_sub(last).filter(|beyond| *beyond > 0) {
        Some(beyond) => backwards(after, last - beyond, x[last]),
        None => after.copy_from_slice(&x[middles.start + m..][..len]),
    }
    T::second(before, &x[middles], after)
}

impl Step for f64 {
    type Number = f64;
    type Sum = f64;

    fn reflected(number: f64, end: f64) -> f64 {
        2.0 * end - number
    }

    fn second(a: &[f64], b: &[f64], c: &[f64]) -> f64 {
        lanes::second_f64(a, b, c)
    }

    fn third(a: &[f64], b: &[f64], c: &[f64], d: &[f64]) -> f64 {
        lanes::third_f64(a, b, c, d)
    }
}

/// Exact sums over a running sum that wraps modulo 2^32. Every difference must be below 2^28.
impl Step for i32 {
    type Number = i32;
    type Sum = ExactSum;

    fn reflected(number: i32, end: i32) -> i32 {
        end.wrapping_mul(2).wrapping_sub(number)
    }

    fn second(a: &[i32], b: &[i32], c: &[i32]) -> ExactSum {
        lanes::second_i32(a, b, c)
    }

    fn third(a: &[i32], b: &[i32], c: &[i32], d: &[i32]) -> ExactSum {
        lanes::third_i32(a, b, c, d)
    }
}

/// Exact sums over a running sum that wraps modulo 2^64. Every difference must be below 2^56.
impl Step for i64 {
    type Number = i64;
    type Sum = ExactSum;

    fn reflected(number: i64, end: i64) -> i64 {
        end.wrapping_mul(2).wrapping_sub(number)
    }

    fn second(a: &[i64], b: &[i64], c: &[i64]) -> ExactSum {
        lanes::second_i64(a, b, c)
    }

    fn third(a: &[i64], b: &[i64], c: &[i64], d: &[i64]) -> ExactSum {
        lanes::third_i64(a, b, c, d)
    }
}

/// Fixed point modulo 2^64, whose squares are summed in f64.
pub(super) enum FixedPoint {}

impl Step for FixedPoint {
    type Number = i64;
    type Sum = f64;

    fn reflected(number: i64, end: i64) -> i64 {
        i64::reflected(number, end)
    }

    fn second(a: &[i64], b: &[i64], c: &[i64]) -> f64 {
        lanes::second_i64(a, b, c).to_f64()
    }

    fn third(a: &[i64], b: &[i64], c: &[i64], d: &[i64]) -> f64 {
        lanes::third_fixed(a, b, c, d)
    }
}
