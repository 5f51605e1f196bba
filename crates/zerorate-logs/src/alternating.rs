//! Intervals that are long and short in turn, as where two sensors or the halves of a packet share one time column.

use crate::middle::mean;

/// Least share of the intervals behind which the next one lies on the other side of the mean. By chance, two of three
/// do so where single stamps are late.
const IN_TURN: f64 = 0.95;
/// Least difference of the two intervals, in mean intervals.
const LEAST: f64 = 0.04;
/// Fewest intervals that are judged.
const ENOUGH: usize = 20;
/// Largest relative error of a step of the clock.
const EXACT: f64 = 1e-3;

/// The means of the short and of the long intervals, if they take turns. `None` if an even clock that is rounded to
/// decimal places of a second explains them: stamps of 400 Hz in whole milliseconds, for example.
pub fn intervals(intervals_s: &[f64]) -> Option<(f64, f64)> {
    let all = || intervals_s.iter().copied();
    let middle = mean(all());
    let turns = intervals_s.windows(2).filter(|pair| (pair[0] < middle) != (pair[1] < middle)).count();
    if intervals_s.len() < ENOUGH || (turns as f64) < IN_TURN * (intervals_s.len() - 1) as f64 {
        return None;
    }
    let short = mean(all().filter(|interval| *interval < middle));
    let long = mean(all().filter(|interval| *interval >= middle));
    let step = 10f64.powf((long - short).log10().round());
    let is_whole = |steps: f64| (steps - steps.round()).abs() < EXACT * steps.max(1.0);
    let is_rounded = ((long - short) / step - 1.0).abs() < EXACT && is_whole(short / step);
    (long - short > LEAST * middle && !is_rounded).then_some((short, long))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(stamps_s: impl Fn(f64) -> f64) -> Option<(f64, f64)> {
        let stamps: Vec<f64> = (0..200).map(|row| stamps_s(f64::from(row))).collect();
        intervals(&stamps.windows(2).map(|pair| pair[1] - pair[0]).collect::<Vec<_>>())
    }

    #[test]
    fn intervals_of_two_sensors_take_turns() {
        for short in [0.001, 0.003, 0.0045, 0.0048] {
            let (least, most) =
                found(|row| (row / 2.0).floor() * 0.01 + if row % 2.0 == 1.0 { short } else { 0.0 }).unwrap();
            assert!((least - short).abs() < 1e-9 && (most - (0.01 - short)).abs() < 1e-9, "{least} {most}");
        }
    }

    #[test]
    fn rounding_and_late_stamps_do_not() {
        for rate in [100.0, 133.0, 222.0, 400.0, 2000.0 / 3.0] {
            assert_eq!(found(|row| (row / rate * 1e3).floor() * 1e-3), None, "{rate}");
            let late = |row: f64| (row + 0.3 * (row * row * 0.37).sin().abs()) / rate;
            assert_eq!(found(late), None, "{rate}");
        }
    }
}
