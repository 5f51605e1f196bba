//! Computes the deviations of records with missing samples.

use super::Squares;
use crate::kernel::{Kernel, Order, Plain, Reason};
use crate::{Gap, Input};
use alloc::vec;
use alloc::vec::Vec;

/// A record with fewer than 1 sample present in this many is refused. This bounds the memory.
const SPARSEST: u64 = 16;

pub(super) fn squares(input: &Input<'_>, kernel: Kernel, m: &[usize]) -> Vec<Result<Squares, Reason>> {
    let len = input.len();
    if len / SPARSEST > len - input.missing() {
        return vec![Err(Reason::Gaps); m.len()];
    }
    match input {
        Input::Codes { codes, gaps } => each(&Present::of(&expanded(codes, gaps)), kernel, m),
        Input::Rate(rate) => each(&Present::of(rate), kernel, m),
        Input::Phase(phase) => each(&Points(phase), kernel, m),
    }
}

/// The codes as numbers, with NaN for lost samples.
pub(crate) fn expanded(codes: &[i32], gaps: &[Gap]) -> Vec<f64> {
    let mut rate = Vec::new();
    let mut next = 0;
    for gap in gaps {
        let at = gap.at.clamp(next, codes.len());
        rate.extend(codes[next..at].iter().map(|&code| f64::from(code)));
        rate.resize(rate.len() + gap.missing as usize, f64::NAN);
        next = at;
    }
    rate.extend(codes[next..].iter().map(|&code| f64::from(code)));
    rate
}

fn each(record: &impl Record, kernel: Kernel, m: &[usize]) -> Vec<Result<Squares, Reason>> {
    m.iter().map(|&m| sum(record, kernel, m)).collect()
}

fn sum(record: &impl Record, kernel: Kernel, m: usize) -> Result<Squares, Reason> {
    let starts = kernel.starts(record.points(), m);
    let mut valid = Valid::default();
    match kernel {
        Kernel::Plain(Plain { order: Order::Second, .. }) => {
            starts.for_each(|i| valid.add_square(record.square(i as isize, m)));
        }
        Kernel::Plain(Plain { order: Order::Third, .. }) => {
            starts.for_each(|i| valid.add(record.third(i as isize, m)));
        }
        Kernel::Reflected => starts.for_each(|i| valid.add_square(record.square(i as isize + 1 - m as isize, m))),
        Kernel::Modified => modified(record, m, starts, &mut valid),
    }
    match valid.n {
        // the sum is negative if the correction for losses exceeds the whole square
        n if n == 0 || valid.sum < 0.0 => Err(Reason::Gaps),
        n => Ok(Squares { sum: valid.sum, n, per: 1.0 }),
    }
}

/// The sums of modified statistics. In the sliding inner mean, one difference enters and one leaves.
fn modified(record: &impl Record, m: usize, starts: impl Iterator<Item = usize>, valid: &mut Valid) {
    let mut inner = Inner::default();
    (0..m as isize - 1).for_each(|i| inner.change(record.second(i, m), 1));
    for i in starts {
        inner.change(record.second((i + m) as isize - 1, m), 1);
        valid.add(inner.mean(m));
        inner.change(record.second(i as isize, m), -1);
    }
}

/// Sum of the squares of the terms that are present, and their number.
#[derive(Default)]
struct Valid {
    sum: f64,
    n: u64,
}

impl Valid {
    fn add(&mut self, difference: Option<f64>) {
        self.add_square(difference.map(|difference| difference * difference));
    }

    fn add_square(&mut self, square: Option<f64>) {
        if let Some(square) = square {
            self.sum += square;
            self.n += 1;
        }
    }
}

/// Sum with its rounding error (Neumaier), because terms are also removed from it.
#[derive(Default)]
struct Inner {
    sum: f64,
    error: f64,
    n: usize,
}

impl Inner {
    fn change(&mut self, difference: Option<f64>, sign: i8) {
        let Some(difference) = difference else { return };
        let term = difference * f64::from(sign);
        let sum = self.sum + term;
        let (large, small) = if libm::fabs(self.sum) < libm::fabs(term) { (term, self.sum) } else { (self.sum, term) };
        self.error += (large - sum) + small;
        self.sum = sum;
        self.n = if sign < 0 { self.n - 1 } else { self.n + 1 };
    }

    fn mean(&self, m: usize) -> Option<f64> {
        (2 * self.n >= m.max(1)).then(|| (self.sum + self.error) / self.n as f64)
    }
}

/// Differences of averages; `None` if too many samples are missing. Points beyond the ends are reflected.
trait Record {
    fn points(&self) -> usize;
    fn second(&self, i: isize, m: usize) -> Option<f64>;
    /// The expected square of the second difference of complete averages.
    fn square(&self, i: isize, m: usize) -> Option<f64> {
        self.second(i, m).map(|difference| difference * difference)
    }
    fn third(&self, i: isize, m: usize) -> Option<f64> {
        Some(self.second(i + m as isize, m)? - self.second(i, m)?)
    }
}

/// The points of a phase. If the first or the last is missing, there is no point to reflect at.
struct Points<'a>(&'a [f64]);

impl Points<'_> {
    fn at(&self, i: isize) -> f64 {
        let x = self.0;
        let last = x.len() - 1;
        match usize::try_from(i) {
            Err(_) => 2.0 * x[0] - x[i.unsigned_abs()],
            Ok(i) if i > last => 2.0 * x[last] - x[2 * last - i],
            Ok(i) => x[i],
        }
    }
}

impl Record for Points<'_> {
    fn points(&self) -> usize {
        self.0.len()
    }

    fn second(&self, i: isize, m: usize) -> Option<f64> {
        let [a, b, c] = [i, i + m as isize, i + 2 * m as isize].map(|i| self.at(i));
        let difference = ((c - b) - (b - a)) / m as f64;
        (!difference.is_nan()).then_some(difference)
    }
}

/// Running sums over the samples present.
struct Present {
    sums: Vec<Sums>,
}

#[derive(Clone, Copy, Default)]
struct Sums {
    sum: f64,
    squares: f64,
    count: isize,
}

impl Sums {
    fn plus(self, other: Self, times: f64) -> Self {
        Self {
            sum: self.sum + times * other.sum,
            squares: self.squares + times * other.squares,
            count: self.count + times as isize * other.count,
        }
    }
}

/// A mean over the samples present.
struct Average {
    mean: f64,
    /// Expected squared difference from the average of all samples. `None` if one sample stands for several.
    excess: Option<f64>,
}

impl Present {
    fn of(rate: &[f64]) -> Self {
        let present = |value: &f64| !value.is_nan();
        let count = rate.iter().filter(|value| present(value)).count().max(1);
        let mean = rate.iter().filter(|value| present(value)).sum::<f64>() / count as f64;
        let mut last = Sums::default();
        let next = rate.iter().map(|value| {
            if present(value) {
                let value = value - mean;
                last = last.plus(Sums { sum: value, squares: value * value, count: 1 }, 1.0);
            }
            last
        });
        Self { sums: core::iter::once(Sums::default()).chain(next).collect() }
    }

    /// Sums up to a point. The record is mirrored before the first sample and after the last.
    fn up_to(&self, i: isize) -> Sums {
        let last = self.sums.len() - 1;
        match usize::try_from(i) {
            Err(_) => Sums::default().plus(self.sums[i.unsigned_abs()], -1.0),
            Ok(i) if i > last => Sums::default().plus(self.sums[last], 2.0).plus(self.sums[2 * last - i], -1.0),
            Ok(i) => self.sums[i],
        }
    }

    fn average(&self, i: isize, m: usize) -> Option<Average> {
        let Sums { sum, squares, count } = self.up_to(i + m as isize).plus(self.up_to(i), -1.0);
        (2 * count >= m as isize).then(|| {
            let (c, m) = (count as f64, m as f64);
            let mean = sum / c;
            let excess = match count {
                _ if c == m => Some(0.0),
                // variance of the mean of c values that are drawn from m without replacement
                2.. => Some((squares - sum * mean).max(0.0) / (c - 1.0) * (1.0 / c - 1.0 / m)),
                _ => None,
            };
            Average { mean, excess }
        })
    }
}

impl Record for Present {
    fn points(&self) -> usize {
        self.sums.len()
    }

    fn second(&self, i: isize, m: usize) -> Option<f64> {
        Some(self.average(i + m as isize, m)?.mean - self.average(i, m)?.mean)
    }

    fn square(&self, i: isize, m: usize) -> Option<f64> {
        let (first, second) = (self.average(i, m)?, self.average(i + m as isize, m)?);
        let difference = second.mean - first.mean;
        Some(difference * difference - first.excess? - second.excess?)
    }
}
