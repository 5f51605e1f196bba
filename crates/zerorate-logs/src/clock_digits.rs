//! Reads times with the digits of a clock: `hhmmss.ss` as in NMEA 0183, `hhmmssmmm`, or `yyyymmddhhmmss`.

use crate::clock::Times;

/// The numbers of units in a second: `hhmmss.ss`, or further digits for 10 ms, ms or µs.
const PER_S: [f64; 4] = [1.0, 1e2, 1e3, 1e6];

/// The usual interval is shorter than this, s. A count of seconds then reaches numbers from 60 to 99.
const LONGEST_S: f64 = 10.0;

/// Longest step from one minute to the next, in usual intervals, unless samples are missing.
const STEP: f64 = 2.5;

const DAY_S: f64 = 86_400.0;

/// Precision of a date of 17 digits, s.
const PRECISION_S: f64 = 0.005;

/// The times of day, s. `None` unless all times have the digits of a clock, and the times go on evenly from
/// second 59 of a minute to second 0 of the next, where a count of seconds has a gap of 40 s.
pub fn times_of_day(times: &Times) -> Option<Times> {
    PER_S.into_iter().find_map(|per_s| read(times, per_s))
}

fn read(times: &Times, per_s: f64) -> Option<Times> {
    let day = 1e6 * per_s;
    let start = times.first() - (times.first() / day).floor() * day;
    let digits = |since: f64| (start + since) / per_s;
    let minute = |since: f64| ((digits(since) + PRECISION_S) / 100.0).floor();
    let rows = times.since_first();
    // most counters stay within what would be one minute; a few rows show that
    if rows.iter().step_by(rows.len() / 64 + 1).chain(rows.last()).all(|since| minute(*since) == minute(0.0)) {
        return None;
    }
    let (mut of_day, mut minutes) = (Times::new(), Vec::new());
    for since in rows {
        let (digits, minute) = (digits(*since), minute(*since));
        let (h, m, s) = ((minute / 100.0).floor() % 100.0, minute % 100.0, digits - 100.0 * minute);
        let is_clock = (0.0..24.0).contains(&h) && (0.0..60.0).contains(&m) && s < 60.0 + PRECISION_S;
        of_day.push_number(3600.0 * h + 60.0 * m + s).ok().filter(|()| is_clock)?;
        minutes.push(minute);
    }
    let interval_s = times.interval()? / per_s;
    let rows = of_day.since_first();
    let ends: Vec<usize> = (1..rows.len()).filter(|row| minutes[*row] != minutes[row - 1]).collect();
    // the first minute of a day follows the last of the day before
    let step = |row: usize| (rows[row] - rows[row - 1]).rem_euclid(DAY_S);
    let is_even = |row: &&usize| step(**row) < STEP * interval_s;
    let even = ends.iter().filter(is_even).count();
    (interval_s < LONGEST_S && even > 0 && 2 * even >= ends.len()).then_some(of_day)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times from 12:58:30 on at 10 rows a second, over the end of an hour, and counters.
    #[test]
    fn digits_of_a_clock_are_known_by_the_ends_of_minutes() {
        let clock = |row: i64| 46_710_000 + 100 * row;
        let written = |ms: i64| ms / 3_600_000 * 10_000_000 + ms / 60_000 % 60 * 100_000 + ms % 60_000;
        let digits = |row: i64| written(clock(row));
        let read = |time: &dyn Fn(i64) -> i64, per_unit: f64| {
            let mut times = Times::new();
            (0..2000).for_each(|row| match per_unit {
                1.0 => times.push_integer(time(row)),
                _ => times.push_number(time(row) as f64 / per_unit).unwrap(),
            });
            let of_day = times_of_day(&times)?;
            Some((of_day.first(), of_day.since_first()[1999]))
        };
        let is_right = |found: Option<(f64, f64)>| {
            found.is_some_and(|(first, last)| (first - 46_710.0).abs() < 0.005 && (last - 199.9).abs() < 1e-6)
        };
        assert!(is_right(read(&digits, 1e3)), "hhmmss.s");
        assert!(is_right(read(&digits, 1.0)), "hhmmssmmm");
        assert!(is_right(read(&|row| 20_260_301_000_000_000 + digits(row), 1.0)), "yyyymmddhhmmssmmm");
        let midnight = read(&|row| written((86_300_000 + 100 * row) % 86_400_000), 1e3);
        assert!(midnight.is_some_and(|(first, _)| (first - 86_300.0).abs() < 0.005), "over midnight");
        assert_eq!(read(&|row| written(100 * row), 1e3).map(|(first, _)| first), Some(0.0), "from midnight on");
        for per_unit in [1.0, 10.0, 1e3] {
            assert!(read(&|row| 100 * row, per_unit).is_none() && read(&clock, per_unit).is_none(), "{per_unit}");
        }
    }
}
