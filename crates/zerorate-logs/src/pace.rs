//! A sensor whose rate of samples changes within the log: one rate is then wrong for most of the log.

use super::clock::median;
use zerorate_record::TimeUnit;

/// Rows of a span. Its length tells the interval within a hundredth, even where the clock counts in steps as long as
/// the interval.
const SPAN: usize = 128;

/// Rows of a part of the log, at the least: the middle of so many spans is not one with a gap.
const PART: usize = 4 * SPAN;

/// Parts that are compared.
const PARTS: usize = 8;

/// A relative difference between rates that nobody notices in a deviation, nor finds in a good clock.
const SAID: f64 = 0.02;

/// The text about times of rows that come faster in one part of the log than in another.
pub fn doubt(times: &[f64], unit: TimeUnit) -> Option<String> {
    let parts = times.chunks_exact((times.len() / PARTS).max(PART));
    let rates: Vec<f64> = parts.map(|part| unit.per_s() / interval(part)).filter(|rate| rate.is_finite()).collect();
    let least = rates.iter().copied().reduce(f64::min)?;
    let most = rates.iter().copied().reduce(f64::max)?;
    (most > (1.0 + SAID) * least).then(|| {
        let [first, last] = [rates[0], rates[rates.len() - 1]];
        format!("{least:.1} to {most:.1} rows a second ({first:.1} at first, {last:.1} at the end)")
    })
}

/// The usual interval between rows of a part.
fn interval(times: &[f64]) -> f64 {
    let mut spans: Vec<f64> = times.windows(SPAN + 1).map(|rows| rows[SPAN] - rows[0]).collect();
    median(&mut spans) / SPAN as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clipped::tests::noise;

    fn said(times: &[f64]) -> bool {
        doubt(times, TimeUnit::S).is_some()
    }

    /// Times of 20,000 rows, 100 a second at first, and `change` times as many from row 12,000 on.
    fn changing(change: f64) -> Vec<f64> {
        let interval = |row: u32| if row < 12_000 { 0.01 } else { 0.01 / change };
        (0..20_000).scan(0.0, |time, row| Some(std::mem::replace(time, *time + interval(row)))).collect()
    }

    #[test]
    fn a_change_is_said() {
        assert_eq!([1.03, 1.1, 1.5, 2.0, 0.5, 0.9, 0.97].map(|change| said(&changing(change))), [true; 7]);
        let text = doubt(&changing(1.1), TimeUnit::S).unwrap();
        assert_eq!(text, "100.0 to 110.0 rows a second (100.0 at first, 110.0 at the end)");
    }

    #[test]
    fn nothing_is_said_of_one_rate() {
        assert_eq!([1.0, 1.01, 0.99].map(|change| said(&changing(change))), [false; 3]);
        let row = || (0..20_000).map(f64::from);
        let late: Vec<f64> = row().zip(noise(20_000)).map(|(row, z)| 0.01 * (row + 0.5 * z)).collect();
        assert!(!said(&late));
        for step in [0.3, 0.7, 0.83, 0.95, 1.0, 1.3] {
            let coarse: Vec<f64> = row().map(|row| step * (row / step).floor()).collect();
            assert!(!said(&coarse), "steps of {step} intervals");
        }
        let with_gap: Vec<f64> = row().map(|row| if row < 7000.0 { row } else { row + 900.0 }).collect();
        let two_at_once: Vec<f64> = row().map(|row| (row / 2.0).floor() * 2.0 + 0.05 * (row % 2.0)).collect();
        assert!(!said(&with_gap) && !said(&two_at_once));
        assert!(![0, 1, 100, 600].into_iter().any(|rows| said(&changing(1.5)[..rows])));
    }
}
