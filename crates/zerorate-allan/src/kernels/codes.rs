use super::array::{Array, zeroed};
use super::exact::ExactSum;
use super::lanes::{self, SHORT};
use super::{Squares, sweep, threads};
use crate::kernel::{Kernel, Order, Plain, Reason};
use alloc::vec::Vec;

/// Samples that one thread takes at a time.
const PIECE: usize = 1 << 17;

/// Exact sums of squares, rounded only at the end.
///
/// Running sums may wrap modulo a power of two if their differences are small. Narrower sums take less memory to read.
pub(super) fn squares(codes: &[i32], kernel: Kernel, m: &[usize]) -> Vec<Result<Squares, Reason>> {
    let bounds = Bounds::of(codes);
    let width = |&m: &usize| bounds.width(kernel, m);
    let by_width = [Width::Narrow, Width::Middle, Width::Wide].map(|this| {
        let m: Vec<usize> = m.iter().copied().filter(|m| width(m) == this).collect();
        sums(codes, &bounds, kernel, &m, this).into_iter()
    });
    let [mut narrow, mut middle, mut wide] = by_width;
    let mut next = |m: &usize| match width(m) {
        Width::Narrow => narrow.next(),
        Width::Middle => middle.next(),
        Width::Wide => wide.next(),
    };
    let n = |m| kernel.terms(codes.len() as u64 + 1, m as u64);
    let squares = |sum: ExactSum, m| Squares { sum: sum.to_f64(), n: n(m), per: kernel.per(m) };
    m.iter().map(|m| next(m).map(|sum| squares(sum, *m)).ok_or(Reason::NotFinite)).collect()
}

/// The size of the differences, which decides the number of bits of the sums.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Width {
    /// Below 2^28.
    Narrow,
    /// Below 2^56.
    Middle,
    /// Any size.
    Wide,
}

/// The bounds of the differences. The offset, which cancels in differences, keeps the running sum small.
struct Bounds {
    offset: i64,
    /// The range of the codes: the largest minus the smallest.
    codes: u128,
    /// An upper bound of the range of the running sum.
    sums: u128,
    /// Running sum before each piece.
    before: Vec<i64>,
}

impl Bounds {
    fn of(codes: &[i32]) -> Self {
        let pieces: Vec<&[i32]> = codes.chunks(PIECE).collect();
        let surveys = threads::map(pieces.len(), |i| lanes::survey(pieces[i]));
        let total: i64 = surveys.iter().flat_map(|survey| &survey.sums).sum();
        let offset = total / codes.len().max(1) as i64;
        let low = surveys.iter().map(|survey| i64::from(survey.low)).min().unwrap_or(0);
        let high = surveys.iter().map(|survey| i64::from(survey.high)).max().unwrap_or(0);
        let (mut sum, mut least, mut most) = (0i64, 0i64, 0i64);
        let mut before = Vec::with_capacity(surveys.len());
        for survey in &surveys {
            before.push(sum);
            for short in &survey.sums {
                sum += short - offset * SHORT as i64;
                (least, most) = (least.min(sum), most.max(sum));
            }
        }
        let between = SHORT as u64 * high.abs_diff(offset).max(offset.abs_diff(low));
        let sums = u128::from(most.abs_diff(least)) + 2 * u128::from(between);
        Self { offset, codes: high.abs_diff(low).into(), sums, before }
    }

    /// The width of a difference. A second difference is at most m times the range of the codes, and at most twice the
    /// range of the running sum (four times if reflected). The bounds of a third difference are twice those of a
    /// second one. A modified difference is a sum of m second differences.
    fn width(&self, kernel: Kernel, m: usize) -> Width {
        let long = m as u128;
        let (largest, narrowest) = match kernel {
            Kernel::Plain(Plain { order: Order::Second, .. }) => {
                ((2 * self.sums).min(long * self.codes), Width::Narrow)
            }
            Kernel::Plain(Plain { order: Order::Third, .. }) => {
                ((4 * self.sums).min(2 * long * self.codes), Width::Narrow)
            }
            Kernel::Reflected => ((4 * self.sums).min(long * self.codes), Width::Narrow),
            Kernel::Modified => (long * (2 * self.sums).min(long * self.codes), Width::Middle),
        };
        match largest {
            0..NARROW => narrowest,
            NARROW..MIDDLE => Width::Middle,
            _ => Width::Wide,
        }
    }
}

const NARROW: u128 = 1 << 28;
const MIDDLE: u128 = 1 << 56;

fn sums(codes: &[i32], bounds: &Bounds, kernel: Kernel, m: &[usize], width: Width) -> Vec<ExactSum> {
    if m.is_empty() {
        return Vec::new();
    }
    match (width, kernel) {
        (Width::Narrow, Kernel::Plain(plain)) => sweep::sums::<i32>(&narrow_sum(codes, bounds), plain, m),
        (Width::Narrow, Kernel::Reflected) => sweep::reflected_sums::<i32>(&narrow_sum(codes, bounds), m),
        (Width::Middle, Kernel::Plain(plain)) => sweep::sums::<i64>(&running_sum(codes, bounds), plain, m),
        (Width::Middle, Kernel::Reflected) => sweep::reflected_sums::<i64>(&running_sum(codes, bounds), m),
        (Width::Narrow | Width::Middle, Kernel::Modified) => {
            sweep::sums::<i64>(&sum_of_sums(codes, bounds), Plain::OF_SUMS, m)
        }
        (Width::Wide, _) => {
            let x = running_sum(codes, bounds);
            threads::map(m.len(), |i| sum(&x, kernel, m[i]))
        }
    }
}

/// The running sum modulo 2^32.
fn narrow_sum(codes: &[i32], bounds: &Bounds) -> Array<i32> {
    let mut x = zeroed(codes.len() + 1);
    threads::fill(&mut x[1..], PIECE, |piece, x| {
        let mut sum = bounds.before[piece] as i32;
        for (x, code) in x.iter_mut().zip(&codes[piece * PIECE..]) {
            sum = sum.wrapping_add(*code).wrapping_sub(bounds.offset as i32);
            *x = sum;
        }
    });
    x
}

fn running_sum(codes: &[i32], bounds: &Bounds) -> Array<i64> {
    let mut x = zeroed(codes.len() + 1);
    threads::fill(&mut x[1..], PIECE, |piece, x| {
        let mut sum = bounds.before[piece];
        for (x, &code) in x.iter_mut().zip(&codes[piece * PIECE..]) {
            sum += i64::from(code) - bounds.offset;
            *x = sum;
        }
    });
    x
}

/// Running sum of the running sum, modulo 2^64. Its third differences are the inner sums of the modified deviation.
fn sum_of_sums(codes: &[i32], bounds: &Bounds) -> Array<i64> {
    let sums = |piece: usize| {
        let mut sum = bounds.before[piece];
        codes.iter().skip(piece * PIECE).take(PIECE).map(move |&code| {
            sum += i64::from(code) - bounds.offset;
            sum
        })
    };
    let totals = threads::map(bounds.before.len(), |piece| sums(piece).fold(0, i64::wrapping_add));
    let before: Vec<i64> =
        totals.iter().scan(0i64, |sum, total| Some(core::mem::replace(sum, sum.wrapping_add(*total)))).collect();
    let mut out = zeroed(codes.len() + 2);
    threads::fill(&mut out[2..], PIECE, |piece, out| {
        let mut sum_of_sums = before[piece];
        for (out, sum) in out.iter_mut().zip(sums(piece)) {
            sum_of_sums = sum_of_sums.wrapping_add(sum);
            *out = sum_of_sums;
        }
    });
    out
}

fn sum(x: &[i64], kernel: Kernel, m: usize) -> ExactSum {
    let mut sum = ExactSum::default();
    let at = |i: usize| i128::from(x[i]);
    let second = |i: usize| at(i + 2 * m) - 2 * at(i + m) + at(i);
    let third = |i: usize| second(i + m) - second(i);
    let starts = kernel.starts(x.len(), m);
    match kernel {
        Kernel::Plain(Plain { order: Order::Second, .. }) => starts.for_each(|i| sum.add_square(second(i))),
        Kernel::Plain(Plain { order: Order::Third, .. }) => starts.for_each(|i| sum.add_square(third(i))),
        Kernel::Modified => {
            let mut inner = (0..m).map(second).sum();
            sum.add_square(inner);
            for i in starts.take(x.len() - 3 * m) {
                inner += third(i);
                sum.add_square(inner);
            }
        }
        Kernel::Reflected => starts.for_each(|i| sum.add_square(reflected(x, i + 1, m))),
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
