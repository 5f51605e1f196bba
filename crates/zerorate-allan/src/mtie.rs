//! Maximum time interval error.

use super::{Deviation, Reason};
use alloc::vec::Vec;

/// MTIE: the largest excursion of a phase within any τ, max over i of (max − min of x\[i\] … x\[i + m\]). It is
/// computed for each of the lengths `m` in samples, in their order (ITU-T G.810 section II.5), in the unit of the
/// phase. `n` counts the windows.
///
/// A missing point (NaN) is left out of its windows. MTIE is the extreme of a record: it grows with the record, and
/// one wrong point determines it.
///
/// It doubles windows (S. Bregni, IEEE Trans. Instrum. Meas. 45, 1996). The extremes of a window of 2ᵏ points follow
/// from two windows half as long, and two of these windows cover any other window. So a length costs one pass over the
/// record, and all lengths together one more for each octave. They take six times the memory of the record.
///
/// ```
/// use zerorate_allan::mtie;
/// let found = mtie(&[0.0, 3.0, 1.0, 5.0], &[1, 2]);
/// assert_eq!((found[0].unwrap().dev, found[0].unwrap().n), (4.0, 3));
/// assert_eq!((found[1].unwrap().dev, found[1].unwrap().n), (4.0, 2));
/// ```
#[must_use]
pub fn mtie(phase: &[f64], m: &[u64]) -> Vec<Result<Deviation, Reason>> {
    let mut found: Vec<_> = m.iter().map(|&m| check(phase.len(), m)).collect();
    let mut order: Vec<(usize, usize)> =
        found.iter().enumerate().filter_map(|(at, m)| Some((m.as_ref().ok()?.m as usize, at))).collect();
    order.sort_unstable();
    let mut extremes = Extremes::of(phase);
    for (m, at) in order {
        extremes.grow_to(m + 1);
        found[at] = found[at].and_then(|counted| extremes.largest(m + 1, counted));
    }
    found
}

/// The windows of a length, without their deviation.
fn check(points: usize, m: u64) -> Result<Deviation, Reason> {
    match (m, (points as u64).checked_sub(m)) {
        (0, _) => Err(Reason::ZeroLength),
        (_, None | Some(0)) => Err(Reason::TooShort { needs: m.saturating_add(1) }),
        (_, Some(n)) => Ok(Deviation { m, dev: 0.0, n }),
    }
}

/// The extremes of every window of `window` points, a power of 2.
struct Extremes {
    window: usize,
    highest: Vec<f64>,
    lowest: Vec<f64>,
}

impl Extremes {
    /// The extremes of windows of one point. A missing point is left out.
    fn of(phase: &[f64]) -> Self {
        let or = |instead: f64| move |x: &f64| if x.is_nan() { instead } else { *x };
        Self {
            window: 1,
            highest: phase.iter().map(or(f64::NEG_INFINITY)).collect(),
            lowest: phase.iter().map(or(f64::INFINITY)).collect(),
        }
    }

    /// Grows to the longest windows that are not longer than `window`.
    fn grow_to(&mut self, window: usize) {
        while self.window <= window / 2 {
            self.highest = doubled(&self.highest, self.window, higher);
            self.lowest = doubled(&self.lowest, self.window, lower);
            self.window *= 2;
        }
    }

    /// The largest excursion in windows of `window` points, which is at most twice as many as these have.
    fn largest(&self, window: usize, counted: Deviation) -> Result<Deviation, Reason> {
        let later = window - self.window;
        let high = self.highest.iter().zip(&self.highest[later..]).map(|(left, right)| higher(*left, *right));
        let low = self.lowest.iter().zip(&self.lowest[later..]).map(|(left, right)| lower(*left, *right));
        let dev = high.zip(low).map(|(high, low)| high - low).fold(f64::NEG_INFINITY, higher);
        match dev {
            f64::NEG_INFINITY => Err(Reason::Gaps),
            dev if dev.is_finite() => Ok(Deviation { dev, ..counted }),
            _ => Err(Reason::NotFinite),
        }
    }
}

fn doubled(of: &[f64], window: usize, pick: impl Fn(f64, f64) -> f64) -> Vec<f64> {
    of.iter().zip(of.get(window..).unwrap_or(&[])).map(|(left, right)| pick(*left, *right)).collect()
}

/// The higher one, as a machine instruction computes it. NaN does not occur here.
fn higher(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

fn lower(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::octaves;

    /// Numbers without an order.
    fn phase(points: u64) -> Vec<f64> {
        (0..points).map(|i| ((i * 7919) % 1009) as f64 + i as f64 * 0.37).collect()
    }

    fn by_definition(phase: &[f64], m: usize) -> f64 {
        let excursion = |window: &[f64]| {
            let present = || window.iter().copied().filter(|x| !x.is_nan());
            present().fold(f64::NEG_INFINITY, f64::max) - present().fold(f64::INFINITY, f64::min)
        };
        phase.windows(m + 1).map(excursion).fold(f64::NEG_INFINITY, f64::max)
    }

    #[test]
    fn every_length_is_its_definition() {
        let mut phase = phase(137);
        for gap in [None, Some(0..1), Some(40..75), Some(136..137)] {
            gap.into_iter().flatten().for_each(|at| phase[at] = f64::NAN);
            let lengths: Vec<u64> = (1..137).rev().collect();
            for (found, m) in mtie(&phase, &lengths).into_iter().zip(&lengths) {
                let expected = Deviation { m: *m, dev: by_definition(&phase, *m as usize), n: 137 - m };
                assert_eq!(found, Ok(expected));
            }
        }
    }

    #[test]
    fn what_has_no_windows_says_why() {
        let too_short = |needs| Err(Reason::TooShort { needs });
        assert_eq!(mtie(&[1.0, 2.0], &[0, 2, u64::MAX]), [Err(Reason::ZeroLength), too_short(3), too_short(u64::MAX)]);
        assert_eq!(mtie(&[], &[1]), [too_short(2)]);
        assert_eq!(mtie(&[f64::NAN; 4], &[1]), [Err(Reason::Gaps)]);
        assert_eq!(mtie(&[0.0, f64::INFINITY, 1.0], &[1]), [Err(Reason::NotFinite)]);
        assert_eq!(mtie(&phase(9), &[]), []);
        assert!(mtie(&phase(9), &octaves(9)).iter().all(Result::is_ok));
    }
}
