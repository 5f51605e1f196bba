//! Strips for the plots over time: the smallest and largest value in bins of several lengths, in bounded memory.

use crate::message::Strip;
use std::collections::VecDeque;

/// Length of a bin at the first level, ns.
const SHORTEST_NS: u64 = 1_000_000;
/// Number of bins of one level that make a bin of the next.
const RATIO: u64 = 8;
/// Number of levels. Their bins are from 1 ms to 262 s long.
const LEVELS: u32 = 7;
/// Number of bins that each level keeps. They span 2 s at the first level and 6 days at the last.
pub const KEPT: usize = 2048;
/// Number of values in a bin: smallest and largest of rate, corrected rate and temperature.
const COLUMNS: usize = 6;

pub fn bins_s() -> impl Iterator<Item = f64> {
    (0..LEVELS).map(|level| bin_ns(level) as f64 * 1e-9)
}

const fn bin_ns(level: u32) -> u64 {
    SHORTEST_NS * RATIO.pow(level)
}

/// The values at one time; NaN means unknown.
#[derive(Clone, Copy, Debug)]
pub struct Values {
    pub rate_dps: f64,
    pub corrected_dps: f64,
    pub temp_c: f64,
}

/// The smallest and the largest of each value.
#[derive(Clone, Copy, Debug)]
struct Bin([f32; COLUMNS]);

impl Bin {
    const EMPTY: Self = Self([f32::NAN; COLUMNS]);

    /// Merges another bin into this one. NaN does not change a smallest or largest value.
    fn widen(&mut self, other: &Self) {
        for (index, (own, other)) in self.0.iter_mut().zip(other.0).enumerate() {
            *own = if index % 2 == 0 { own.min(other) } else { own.max(other) };
        }
    }
}

impl From<Values> for Bin {
    fn from(values: Values) -> Self {
        let Values { rate_dps, corrected_dps, temp_c } = values;
        let [rate, corrected, temp] = [rate_dps, corrected_dps, temp_c].map(|value| value as f32);
        Self([rate, rate, corrected, corrected, temp, temp])
    }
}

#[derive(Debug)]
pub struct Strips {
    levels: Vec<Level>,
}

impl Default for Strips {
    fn default() -> Self {
        Self { levels: (0..LEVELS).map(|_| Level::default()).collect() }
    }
}

impl Strips {
    /// Adds the values at `at_ns` since the first reading. Times must not decrease.
    pub fn push(&mut self, at_ns: u64, values: Values) {
        let mut bin = Bin::from(values);
        let mut number = at_ns / SHORTEST_NS;
        for level in &mut self.levels {
            let Some(closed) = level.push(number, &bin) else { return };
            (number, bin) = (closed.0 / RATIO, closed.1);
        }
    }

    /// Appends the complete bins to a frame: those since the last [`Strips::mark_given`], or all.
    pub fn give(&self, axis: u32, all: bool, strips: &mut Vec<Strip>, payload: &mut Vec<f32>) {
        for (number, level) in self.levels.iter().enumerate() {
            let first = if all { level.first } else { level.given.max(level.first) };
            let skipped = (first - level.first) as usize;
            let count = level.bins.len() - skipped;
            if count == 0 {
                continue;
            }
            let at = payload.len() as u32;
            strips.push(Strip { axis, level: number as u32, first, count: count as u32, at });
            for column in 0..COLUMNS {
                payload.extend(level.bins.iter().skip(skipped).map(|bin| bin.0[column]));
            }
        }
    }

    /// Marks all complete bins as sent.
    pub fn mark_given(&mut self) {
        for level in &mut self.levels {
            level.given = level.first + level.bins.len() as u64;
        }
    }
}

#[derive(Debug, Default)]
struct Level {
    bins: VecDeque<Bin>,
    /// Number of the oldest bin that is kept.
    first: u64,
    /// Number of the first bin that was not sent.
    given: u64,
    /// The bin that is being filled, with its number.
    open: Option<(u64, Bin)>,
}

impl Level {
    /// Adds values to the bin with this number. If they start a new bin, returns the previous bin, which is complete.
    fn push(&mut self, number: u64, bin: &Bin) -> Option<(u64, Bin)> {
        match &mut self.open {
            Some((open, values)) if *open >= number => {
                values.widen(bin);
                None
            }
            open => {
                let closed = open.replace((number, *bin));
                if let Some((at, values)) = closed {
                    self.close(at, values, number);
                }
                closed
            }
        }
    }

    /// Stores the complete bin `at`, and empty bins for the numbers between `at` and `next`.
    fn close(&mut self, at: u64, values: Bin, next: u64) {
        if self.bins.is_empty() {
            self.first = at;
        }
        self.keep(values);
        let empty = next - at - 1;
        if empty > KEPT as u64 {
            self.bins.clear();
            self.first = next - KEPT as u64;
        }
        for _ in 0..empty.min(KEPT as u64) {
            self.keep(Bin::EMPTY);
        }
    }

    fn keep(&mut self, values: Bin) {
        if self.bins.len() == KEPT {
            self.bins.pop_front();
            self.first += 1;
        }
        self.bins.push_back(values);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rate(rate_dps: f64) -> Values {
        Values { rate_dps, corrected_dps: f64::NAN, temp_c: f64::NAN }
    }

    fn level(strips: &Strips, level: u32, all: bool) -> Option<(u64, Vec<f32>, Vec<f32>)> {
        let (mut heads, mut payload) = (Vec::new(), Vec::new());
        strips.give(0, all, &mut heads, &mut payload);
        let head = heads.into_iter().find(|head| head.level == level)?;
        let (at, count) = (head.at as usize, head.count as usize);
        Some((head.first, payload[at..at + count].to_vec(), payload[at + count..at + 2 * count].to_vec()))
    }

    #[test]
    fn a_spike_is_in_every_level() {
        let mut strips = Strips::default();
        for k in 0..200_000u64 {
            strips.push(k * 100_000, rate(if k == 12_345 { 99.0 } else { (k % 7) as f64 * -0.1 }));
        }
        for number in 0..4 {
            let (first, low, high) = level(&strips, number, true).unwrap();
            let spike = 12_345 / 10 / RATIO.pow(number);
            let there = spike.checked_sub(first).map(|at| high[at as usize]);
            assert_eq!(there, (number > 1).then_some(99.0), "level {number} from {first}");
            assert!(low.iter().all(|low| (*low + 0.6).abs() < 1e-6));
        }
    }

    #[test]
    fn silence_becomes_empty_bins_within_the_bound() {
        let mut strips = Strips::default();
        strips.push(0, rate(1.0));
        strips.push(5_000_000, rate(2.0));
        strips.push(6_000_000, rate(3.0));
        let (first, low, _) = level(&strips, 0, true).unwrap();
        assert_eq!((first, low.len()), (0, 6));
        assert!(low[0] == 1.0 && low[1..5].iter().all(|low| low.is_nan()) && low[5] == 2.0);
        strips.push(3_600_000_000_000, rate(4.0));
        let (first, low, _) = level(&strips, 0, true).unwrap();
        assert_eq!((first, low.len()), (3_600_000 - KEPT as u64, KEPT));
        assert!(low.iter().all(|low| low.is_nan()));
    }

    #[test]
    fn samples_are_given_once() {
        let mut strips = Strips::default();
        (0..10).for_each(|k| strips.push(k * SHORTEST_NS, rate(k as f64)));
        assert_eq!(level(&strips, 0, false).unwrap().1.len(), 9);
        strips.mark_given();
        assert!(level(&strips, 0, false).is_none());
        strips.push(10 * SHORTEST_NS, rate(10.0));
        assert_eq!(level(&strips, 0, false).unwrap(), (9, vec![9.0], vec![9.0]));
        assert_eq!(level(&strips, 0, true).unwrap().1.len(), 10);
    }
}
