//! Finds missing samples among rows that may be as late as a missing sample would make them.
//!
//! A late row stands alone. Behind a missing sample all rows are later, which median delays of neighbouring rows show.

use super::middle::{mean, median};
use super::series::missing_in;
use std::ops::Range;
use zerorate_allan::Gap;

/// A span of rows has no gap if it differs from the usual span by no more than this, in intervals.
const NEAR: f64 = 1.75;

/// Number of rows on each side of a possible gap. The median delays of both sides differ if samples are missing
/// between them. The standard deviation of such a median is a fifth of the jitter.
pub const AROUND: usize = 32;

/// Samples can be missing before a row only if its delay exceeds that of the row before by this, in intervals.
const LEAP: f64 = 0.25;

/// The median delays of both sides of a gap differ by at least this many of their standard deviations.
const SURE_SIGMA: f64 = 4.0;

/// The standard deviation of the median of many delays, in jitters times the square root of their number.
const OF_MEDIAN: f64 = 1.253;

/// Jitter, gaps and number of intervals of a clock with these times of rows.
pub fn gaps(times: &[f64]) -> (f64, Vec<Gap>, u64) {
    let late = delays(times);
    let mut squares = 0.0;
    for first in (1..late.len()).step_by(AROUND / 2) {
        let (before, after) = sides(&late, first, 0..late.len());
        let (before, after) = (middle(before), middle(after));
        let rows = &late[first..late.len().min(first + AROUND / 2)];
        squares += rows.iter().map(|late| (late - after).abs().min((late - before).abs()).powi(2)).sum::<f64>();
    }
    let jitter = (squares / (times.len() - 1) as f64).sqrt();
    let gaps = confirmed(&late, possible(&late), jitter);
    let steps = (times.len() as u64 - 1).saturating_add(missing_in(&gaps));
    (jitter, gaps, steps)
}

/// How late each row is, in intervals.
fn delays(times: &[f64]) -> Vec<f64> {
    let span = AROUND.min(times.len() / 2).max(1);
    let mut over: Vec<f64> = times.windows(span + 1).map(|rows| (rows[span] - rows[0]) / span as f64).collect();
    let middle = median(&mut over);
    // the mean is exact for a clock that counts in steps, and the median is not
    let is_near = |over: &f64| (over - middle).abs() * span as f64 <= NEAR * middle;
    let interval = mean(over.into_iter().filter(is_near));
    times.iter().enumerate().map(|(row, time)| time / interval - row as f64).collect()
}

/// Gaps by the median delays of the rows around them, also across other gaps.
fn possible(late: &[f64]) -> Vec<Gap> {
    let mut gaps: Vec<Gap> = Vec::new();
    let mut widest = 0.0;
    for row in (1..late.len()).filter(|row| late[*row] - late[row - 1] >= LEAP) {
        let leap = late[row] - late[row - 1];
        let (before, after) = sides(late, row, 0..late.len());
        let missing = (middle(after) - middle(before)).round();
        // near a gap, the medians differ as well; the gap is where the leap is widest
        let is_new = gaps.last().is_none_or(|last| row > last.at + AROUND / 2);
        if missing >= 1.0 && (is_new || leap > widest) {
            if !is_new {
                gaps.pop();
            }
            gaps.push(Gap { at: row, missing: missing as u64 });
            widest = leap;
        }
    }
    gaps
}

/// The gaps that the rows up to the next gap confirm. The smallest are examined first, since the rows beside a wide
/// gap seem to have another.
fn confirmed(late: &[f64], mut gaps: Vec<Gap>, jitter: f64) -> Vec<Gap> {
    let mut order: Vec<Gap> = gaps.clone();
    order.sort_by_key(|gap| gap.missing);
    for gap in order {
        let index = gaps.partition_point(|other| other.at < gap.at);
        let start = index.checked_sub(1).map_or(0, |before| gaps[before].at);
        let end = gaps.get(index + 1).map_or(late.len(), |after| after.at);
        let (before, after) = sides(late, gap.at, start..end);
        let error = OF_MEDIAN * jitter * (1.0 / before.len() as f64 + 1.0 / after.len() as f64).sqrt();
        let leap = middle(after) - middle(before);
        match leap.round() {
            missing if missing >= 1.0 && leap > SURE_SIGMA * error => gaps[index].missing = missing as u64,
            _ => drop(gaps.remove(index)),
        }
    }
    gaps
}

/// The rows `within` a range that are before and after a gap.
fn sides(late: &[f64], row: usize, within: Range<usize>) -> (&[f64], &[f64]) {
    let before = &late[row.saturating_sub(AROUND).max(within.start)..row];
    (before, &late[row..(row + AROUND).min(within.end)])
}

fn middle(rows: &[f64]) -> f64 {
    let mut buffer = [0.0; AROUND];
    let rows_here = &mut buffer[..rows.len()];
    rows_here.copy_from_slice(rows);
    median(rows_here)
}
