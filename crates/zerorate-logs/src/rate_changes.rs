//! Detects a sampling rate that changes within the log. A single rate is then wrong for most of the log.

use super::middle::median;
use zerorate_allan::Gap;
use zerorate_input::TimeUnit;

/// Number of intervals in a span of rows. The duration of such a span gives the interval to one percent, even if the
/// clock counts in steps as long as the interval.
const SPAN: usize = 128;

/// Least number of rows in a part of the log. In such a part, at most a third of the spans contain the same gap, so
/// that the median span is not affected.
const PART: usize = 4 * SPAN;

/// Largest number of parts that are compared.
const PARTS: usize = 8;

/// An interval of more than this many usual intervals is a gap.
const LONG: f64 = 1.5;

/// Relative difference between rates above which a warning is given. A good clock changes less. A smaller change
/// hardly shows in Allan deviations.
const SAID: f64 = 0.02;

/// The text of the warning if rows come faster in one part of the log than in another. Lost samples do not count.
pub fn find(times: &[f64], gaps: &[Gap], unit: TimeUnit) -> Option<String> {
    let rows = (times.len() / PARTS).max(PART);
    let parts = times.chunks_exact(rows).enumerate();
    let rates: Vec<f64> = parts.map(|(index, part)| unit.per_s() / interval(part, index * rows, gaps)).collect();
    let [least, most] = [f64::min, f64::max].map(|of| rates.iter().copied().reduce(of));
    let (least, most) = (least?, most?);
    (most.is_finite() && most > (1.0 + SAID) * least).then(|| {
        let [first, last] = [rates[0], rates[rates.len() - 1]];
        format!("{least:.1} to {most:.1} rows a second ({first:.1} at first, {last:.1} at the end)")
    })
}

/// The usual interval between the rows of a part whose first row is row `begin` of the log.
fn interval(times: &[f64], begin: usize, gaps: &[Gap]) -> f64 {
    let first = gaps.partition_point(|gap| gap.at <= begin);
    let last = gaps.partition_point(|gap| gap.at < begin + times.len());
    let closed = (first < last).then(|| without_gaps(times, begin, &gaps[first..last]));
    let times = closed.as_deref().unwrap_or(times);
    let mut spans: Vec<f64> = times.windows(SPAN + 1).map(|rows| rows[SPAN] - rows[0]).collect();
    median(&mut spans) / SPAN as f64
}

/// The times with an interval of the usual length in place of each gap.
fn without_gaps(times: &[f64], begin: usize, gaps: &[Gap]) -> Vec<f64> {
    let usual = median(&mut times.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<f64>>());
    let (mut lost, mut gaps) = (0.0, gaps.iter().map(|gap| gap.at - begin).peekable());
    let closed = times.iter().enumerate().map(|(row, time)| {
        if gaps.next_if_eq(&row).is_some() {
            let interval = time - times[row - 1];
            lost += if interval > LONG * usual { interval - usual } else { 0.0 };
        }
        time - lost
    });
    closed.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clock::Times;
    use crate::column_checks::clipped::tests::noise;
    use crate::setting::Names;

    /// True if a log with these times is refused, or reported with a change of rate.
    fn said(times: &[f64]) -> bool {
        let mut clock = Times::new();
        clock.replace(times.to_vec());
        let time_base = clock.time_base(TimeUnit::S, Names::default());
        time_base.map_or(true, |time_base| find(times, &time_base.gaps, TimeUnit::S).is_some())
    }

    /// Times of 20,000 rows, 100 a second at first, and `change` times as many from row 12,000 on.
    fn changing(change: f64) -> Vec<f64> {
        let interval = |row: u32| if row < 12_000 { 0.01 } else { 0.01 / change };
        (0..20_000).scan(0.0, |time, row| Some(std::mem::replace(time, *time + interval(row)))).collect()
    }

    #[test]
    fn a_change_is_said() {
        for change in [1.03, 1.1, 1.5, 2.0, 0.5, 0.9, 0.97] {
            let times = changing(change);
            assert!(said(&times) && find(&times, &[], TimeUnit::S).is_some(), "{change}");
        }
        let text = find(&changing(1.1), &[], TimeUnit::S).unwrap();
        assert_eq!(text, "100.0 to 110.0 rows a second (100.0 at first, 110.0 at the end)");
    }

    #[test]
    fn one_rate_gives_no_warning() {
        assert_eq!([1.0, 1.01, 0.99].map(|change| said(&changing(change))), [false; 3]);
        let row = || (0..20_000).map(f64::from);
        let late: Vec<f64> = row().zip(noise(20_000)).map(|(row, z)| 0.01 * (row + 0.4 * z)).collect();
        assert!(!said(&late));
        for step in [0.3, 0.7, 0.83, 0.95, 1.0, 1.3] {
            let coarse: Vec<f64> = row().map(|row| 0.01 * step * (row / step).floor()).collect();
            assert!(!said(&coarse), "steps of {step} intervals");
        }
        let two_at_once: Vec<f64> = row().map(|row| 0.02 * (row / 2.0).floor() + 0.006 * (row % 2.0)).collect();
        assert!(!said(&two_at_once));
        assert!(![0, 1, 600].into_iter().any(|rows| find(&changing(1.5)[..rows], &[], TimeUnit::S).is_some()));
    }

    #[test]
    fn losses_are_no_change() {
        let log = |is_there: fn(&u32) -> bool| (0..30_000).filter(is_there).map(|row| 0.01 * f64::from(row));
        let one_gap: Vec<f64> = log(|row| !(7000..7900).contains(row)).collect();
        let in_the_middle: Vec<f64> = log(|row| !(10_000..20_000).contains(row) || row % 5 < 3).collect();
        assert!(!said(&one_gap) && !said(&in_the_middle));
    }
}
