//! Detects timestamps of which a spreadsheet or float32 kept only the first digits.

use crate::clock::Times;
use zerorate_input::TimeUnit;

/// Most digits of a stamp that was cut: float32 keeps 7, and `1.70000E+18` of Excel has 6.
const DIGITS: usize = 7;

/// Stamps of this size or more have more than [`DIGITS`] digits.
const LARGE: f64 = 1e9;

/// Least share of the rows that repeat the stamp of the row before. With fewer repeats, no digits were cut.
const REPEATED: f64 = 0.5;

/// The evidence that most stamps repeat because their last digits were cut; `None` without evidence.
pub fn reason(times: &Times, unit: Option<TimeUnit>) -> Option<String> {
    let rows = times.since_first();
    let repeated = rows.windows(2).filter(|pair| pair[0] == pair[1]).count();
    if times.first().abs() < LARGE || (repeated as f64) < REPEATED * rows.len().saturating_sub(1) as f64 {
        return None;
    }
    let mut stamps = rows.iter().map(|since| times.first() + since);
    let first = times.first();
    if stamps.clone().all(|stamp| f64::from(stamp as f32) == stamp) {
        let step = f64::from((first as f32).next_up()) - first;
        let unit = unit.unwrap_or(TimeUnit::S);
        return Some(format!("the stamps step by {} s: float32 cut them", step / unit.per_s()));
    }
    let digits =
        |stamp: f64| format!("{stamp:e}").bytes().take_while(|byte| *byte != b'e').filter(u8::is_ascii_digit).count();
    stamps
        .all(|stamp| digits(stamp) <= DIGITS)
        .then(|| format!("the stamps have {DIGITS} digits at most ({first:e}): a spreadsheet cut them"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(stamps: impl Iterator<Item = f64>) -> Option<String> {
        let mut times = Times::new();
        stamps.for_each(|stamp| times.push_number(stamp).unwrap());
        reason(&times, Some(TimeUnit::S))
    }

    #[test]
    fn a_cut_stamp_shows_how_it_was_cut() {
        let exact = |at: u32| 1.7e9 + f64::from(at) * 0.01;
        assert!(of((0..900).map(|at| f64::from(exact(at) as f32))).unwrap().contains("step by 128 s"));
        assert!(
            of((0..900).map(|at| exact(at).round() * 1e9).map(|ns| (ns / 1e13).round() * 1e13))
                .unwrap()
                .contains("7 digits")
        );
        assert_eq!(of((0..900).map(exact)), None);
        assert_eq!(of((0..900).map(|at| exact(at).floor() + 7.0)), None, "a clock in seconds");
        assert_eq!(of((0..900).map(|at| f64::from(at / 100))), None);
    }
}
