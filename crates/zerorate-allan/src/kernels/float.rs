use super::array::{Array, zeroed};
use super::lanes::Line;
use super::sweep::FixedPoint;
use super::{Squares, lanes, sweep, threads};
use crate::kernel::{Kernel, Plain, Reason};
use alloc::vec;
use alloc::vec::Vec;

/// Samples that one thread takes at a time.
const PIECE: usize = 1 << 17;
/// Number of samples that are summed from zero before the total is added, so that little precision is lost.
const SHORT: usize = 256;

/// Running sum of the rate minus its approximate mean, which cancels in differences. `None` if samples are
/// missing, which the first of two passes finds.
pub(super) fn phase(rate: &[f64]) -> Option<Array<f64>> {
    let pieces: Vec<&[f64]> = rate.chunks(PIECE).collect();
    let near = near_mean(rate);
    let sums = threads::map(pieces.len(), |i| lanes::sum_f64(pieces[i], near));
    let total: f64 = sums.iter().sum();
    if total.is_nan() && rate.iter().any(|value| value.is_nan()) {
        return None;
    }
    let mean = coarse(near + total / rate.len().max(1) as f64, rate);
    let less = |piece: &[f64], sum: f64| sum - (mean - near) * piece.len() as f64;
    let sums = pieces.iter().zip(sums).map(|(piece, sum)| less(piece, sum));
    let before: Vec<f64> = sums.scan(0.0, |sum, piece| Some(core::mem::replace(sum, *sum + piece))).collect();
    let mut x = zeroed(rate.len() + 1);
    threads::fill(&mut x[1..], PIECE, |i, x| run(pieces[i], mean, before[i], x));
    Some(x)
}

/// The mean of some samples, so that sums about it are small.
fn near_mean(rate: &[f64]) -> f64 {
    let some = || rate.iter().step_by(1 + rate.len() / PIECE);
    coarse(some().sum::<f64>() / some().count().max(1) as f64, rate)
}

/// Rounds the mean to 24 bits of the spread. With all bits of the mean, the samples of a converter would all have the
/// same fraction, and the running sum would round each of them the same way.
fn coarse(mean: f64, rate: &[f64]) -> f64 {
    let some = &rate[..rate.len().min(PIECE)];
    let spread = some.iter().map(|value| libm::fabs(value - mean)).sum::<f64>() / some.len().max(1) as f64;
    if !spread.is_normal() {
        return mean;
    }
    let grid = libm::exp2(f64::from(libm::ilogb(spread) - 24));
    libm::rint(mean / grid) * grid
}

fn run(rate: &[f64], mean: f64, before: f64, x: &mut [f64]) {
    let mut base = before;
    for (rate, x) in rate.chunks(SHORT).zip(x.chunks_mut(SHORT)) {
        let mut sum = 0.0;
        for (value, x) in rate.iter().zip(x) {
            sum += value - mean;
            *x = base + sum;
        }
        base += sum;
    }
}

pub(super) fn squares(x: &[f64], kernel: Kernel, m: &[usize]) -> Vec<Result<Squares, Reason>> {
    let sums = match kernel {
        Kernel::Plain(plain) => sweep::sums::<f64>(x, plain, m),
        Kernel::Modified => modified(x, m),
        Kernel::Reflected => sweep::reflected_sums::<f64>(x, m),
    };
    let squares = |(sum, &m)| Squares { sum, n: kernel.terms(x.len() as u64, m as u64), per: kernel.per(m) };
    sums.into_iter().zip(m).map(|pair| Ok(squares(pair))).collect()
}

/// Exclusive ends of the classes of averages, in samples. The fixed-point step is fine for short averages only.
const CLASSES: [usize; 3] = [1 << 8, 1 << 16, usize::MAX];

/// Inner sums of second differences are third differences of the running sum of x. In f64 that sum would lose small
/// values, so it is formed in fixed point, where sum and difference are exact. Only x is rounded, once, to the step.
fn modified(x: &[f64], m: &[usize]) -> Vec<f64> {
    let bounds = Bounds::of(x);
    let mut sums = vec![0.0; m.len()];
    let mut sum_of_sums = zeroed(x.len() + 1);
    let mut shortest = 0;
    for longest in CLASSES {
        let class: Vec<usize> = (0..m.len()).filter(|&i| (shortest..longest).contains(&m[i])).collect();
        let of_class: Vec<usize> = class.iter().map(|&i| m[i]).collect();
        let step = bounds.step(of_class.iter().copied().max().unwrap_or(0));
        if !class.is_empty() {
            bounds.sum_sums(x, step, &mut sum_of_sums[1..]);
            let found = sweep::sums::<FixedPoint>(&sum_of_sums, Plain::OF_SUMS, &of_class);
            class.iter().zip(found).for_each(|(&i, sum)| sums[i] = sum * step * step);
        }
        shortest = longest;
    }
    sums
}

/// The bounds of the inner sums: the ranges of x less the line between its ends, and of its first differences.
struct Bounds {
    line: Line,
    x: f64,
    differences: f64,
}

impl Bounds {
    fn of(x: &[f64]) -> Self {
        let steps = x.len() - 1;
        let line = Line { start: x[0], slope: (x[steps] - x[0]) / steps.max(1) as f64 };
        let reach = threads::map(x.len().div_ceil(PIECE), |piece| {
            let first = piece * PIECE;
            lanes::reach(line, first, &x[first..x.len().min(first + PIECE + 1)])
        });
        let largest = |all: &mut dyn Iterator<Item = f64>| all.fold(0.0, f64::max);
        let is_finite = line.slope.is_finite();
        let or_nan = |bound: f64| if is_finite { bound } else { f64::NAN };
        Self {
            line,
            x: or_nan(largest(&mut reach.iter().map(|reach| reach.level))),
            differences: or_nan(largest(&mut reach.iter().map(|reach| reach.difference))),
        }
    }

    /// The fixed-point step: a power of two for which x and all inner sums are below 2^62 steps. NaN for infinities.
    fn step(&self, m: usize) -> f64 {
        let m = m as f64;
        let largest = self.x.max(m * f64::min(4.0 * self.x, 2.0 * m * self.differences));
        let exponent = libm::ilogb(largest).clamp(-900, 1100);
        if largest.is_finite() { libm::exp2(f64::from(exponent - 60)) } else { f64::NAN }
    }

    fn sum_sums(&self, x: &[f64], step: f64, out: &mut [i64]) {
        let per_step = 1.0 / step;
        let pieces: Vec<&[f64]> = x.chunks(PIECE).collect();
        let totals = threads::map(pieces.len(), |i| lanes::sum_steps(self.line, per_step, i * PIECE, pieces[i]));
        let before: Vec<i64> =
            totals.iter().scan(0i64, |sum, total| Some(core::mem::replace(sum, sum.wrapping_add(*total)))).collect();
        threads::fill(out, PIECE, |i, out| {
            lanes::run_steps(self.line, per_step, i * PIECE, pieces[i], before[i], out);
        });
    }
}
