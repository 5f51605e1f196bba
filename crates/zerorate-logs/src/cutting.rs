//! Reads a part of a log, by its time.

use crate::clock::Times;
use crate::cut::{Cut, CutTime, DAY_S};
use crate::error::{LogError, Result};
use crate::options::ColumnOptions;
use crate::raw_columns::{Clock, RawColumns};
use crate::setting::Setting;
use jiff::SignedDuration;
use std::fmt;
use std::path::Path;
use zerorate_input::TimeUnit;

/// Times in this range, in s, are dates since 1970 (from 1973 to 2096). Smaller times count from some other start.
const DATES_S: std::ops::Range<f64> = 1e8..4e9;

/// A row this many intervals earlier than the row before begins another log. A file with more than [`MOST_LOGS`] such
/// rows is not split.
const LATE: f64 = 64.0;
const MOST_LOGS: usize = 16;

/// Times that differ by less than this count as equal, s.
const SAME_S: f64 = 1e-6;

struct Span {
    /// The first time, s, if the log states dates or times of the day.
    first_s: Option<f64>,
    length_s: f64,
}

impl Span {
    /// Seconds from the start of the log; `None` if the log has no clock with such times.
    fn since_start(&self, time: CutTime) -> Option<f64> {
        let of_day = |s: f64| s.rem_euclid(DAY_S);
        match (time, self.first_s) {
            (CutTime::SinceStart(s), _) => Some(s),
            (CutTime::TimeOfDay(s), Some(first_s)) => Some(of_day(s - of_day(first_s))),
            (CutTime::Date(s), Some(first_s)) if DATES_S.contains(&first_s) => Some(s - first_s),
            _ => None,
        }
    }
}

impl fmt::Display for Span {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let clock = |s: f64| {
            let stamp = jiff::Timestamp::from_duration(SignedDuration::from_secs_f64(s)).unwrap_or_default();
            let date = stamp.to_zoned(jiff::tz::TimeZone::UTC).datetime().round(jiff::Unit::Second);
            date.map(|date| if DATES_S.contains(&s) { date.to_string() } else { date.time().to_string() })
        };
        let Self { first_s, length_s } = *self;
        write!(f, "is {length_s:.6} s long")?;
        match first_s.and_then(|first_s| Some((clock(first_s).ok()?, clock(first_s + length_s).ok()?))) {
            Some((first, last)) => write!(f, ", from {first} to {last}"),
            None => Ok(()),
        }
    }
}

impl Times {
    /// The time of the last row of the first log, since the first row, s, rounded down to the digits of an interval.
    /// Several logs in a file show as large steps back in time. `None` if the file has no such step, or more than
    /// [`MOST_LOGS`].
    pub fn end_of_first_s(&self, unit: TimeUnit) -> Option<f64> {
        let interval = self.interval()?;
        let mut falls = self.since_first().windows(2).filter(|pair| pair[0] - pair[1] > LATE * interval);
        let first = falls.next()?[0];
        let first_s = rounded_down(first / unit.per_s(), interval / unit.per_s());
        (falls.count() < MOST_LOGS).then_some(first_s)
    }

    /// The number of rows before the first one at this time or later. `None` if there is no such row or no row before
    /// it, and for clock times.
    pub fn rows_until(&self, until: CutTime, unit: TimeUnit) -> Option<usize> {
        let CutTime::SinceStart(until_s) = until else { return None };
        self.since_first().iter().position(|time| time / unit.per_s() >= until_s).filter(|rows| *rows > 0)
    }
}

/// The time, rounded down to as many decimals as tell the samples apart.
fn rounded_down(time_s: f64, interval_s: f64) -> f64 {
    let decimals = (0.9 / interval_s).log10().ceil().clamp(0.0, 9.0);
    let per_s = 10_f64.powi(decimals as i32);
    let nearest = (time_s * per_s).round();
    if nearest / per_s <= time_s { nearest / per_s } else { (nearest - 1.0) / per_s }
}

impl RawColumns {
    /// Keeps the rows of the part that is to be read. Returns the time left out at the start, s.
    pub fn cut(&mut self, path: &Path, args: &ColumnOptions) -> Result<f64> {
        let Cut { from, until } = args.cut;
        if from.is_none() && until.is_none() {
            return Ok(0.0);
        }
        // the caller asks for a missing rate
        let Some(times_s) = self.times_s(args) else { return Ok(0.0) };
        let span = Span { first_s: self.first_s(args), length_s: times_s.last().copied().unwrap_or_default() };
        let [from_s, until_s] = [(from, Setting::Skip), (until, Setting::Until)].map(|(time, setting)| {
            let since = time.map(|time| span.since_start(time).ok_or(setting)).transpose();
            since.map_err(|setting| {
                let why = "the log states no such clock; give seconds from its start";
                LogError::Ask(format!("{}: {}: {why}", path.display(), args.names.of(setting)))
            })
        });
        let (from_s, until_s) = (from_s?, until_s?);
        let before = |limit_s: f64| times_s.partition_point(|time_s| *time_s < limit_s - SAME_S);
        let (first, end) = (from_s.map_or(0, before), until_s.map_or(times_s.len(), before));
        if first >= end {
            let given = [from.map(|_| Setting::Skip), until.map(|_| Setting::Until)].into_iter().flatten();
            let given = given.map(|setting| args.names.of(setting).to_string()).collect::<Vec<_>>().join(" with ");
            return Err(LogError::Ask(format!("{given} leaves nothing of {}, which {span}", path.display())));
        }
        self.keep(first, end);
        Ok(times_s[first])
    }

    /// The time of each row since the first, s; `None` if neither the unit of the times nor the rate is known.
    fn times_s(&self, args: &ColumnOptions) -> Option<Vec<f64>> {
        let rows = self.columns.first()?.values.rows();
        match &self.clock {
            Clock::Column(_, times) if !self.clock.is_guess(args) => {
                let per_s = self.clock.unit(args)?.per_s();
                Some(times.since_first().iter().map(|since| since / per_s).collect())
            }
            Clock::Counted { rate_hz, gaps } => {
                let rate_hz = args.rate.or(*rate_hz)?;
                let (mut missing, mut gaps) = (0, gaps.iter().peekable());
                let time_s = |row: u64| {
                    while let Some(gap) = gaps.next_if(|gap| gap.at as u64 <= row) {
                        missing += gap.missing;
                    }
                    (row + missing) as f64 / rate_hz
                };
                Some((0..rows).map(time_s).collect())
            }
            _ => args.rate.map(|rate_hz| (0..rows).map(|row| row as f64 / rate_hz).collect()),
        }
    }

    /// The date or the time of day of the first row, s; `None` without a time column, or if its times count from some
    /// other start.
    fn first_s(&self, args: &ColumnOptions) -> Option<f64> {
        let Clock::Column(_, times) = &self.clock else { return None };
        let first_s = times.first() / self.clock.unit(args)?.per_s();
        // clock times without a date are read as ns since midnight
        let is_of_day = times.unit == Some(TimeUnit::Ns) && (0.0..DAY_S).contains(&first_s);
        (DATES_S.contains(&first_s) || is_of_day).then_some(first_s)
    }

    fn keep(&mut self, first: usize, end: usize) {
        self.columns.iter_mut().for_each(|column| column.values.keep(first, end));
        match &mut self.clock {
            Clock::Silent => {}
            Clock::Column(_, times) => times.keep(first, end),
            Clock::Counted { gaps, .. } => {
                gaps.retain(|gap| first < gap.at && gap.at < end);
                gaps.iter_mut().for_each(|gap| gap.at -= first);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::ColumnSelection;
    use crate::read_all;

    /// The samples from `from` to `until` of a log that holds row numbers from 0 to 99. Row 40 is missing.
    fn rows(stamp: impl Fn(u32) -> String, from: Option<&str>, until: Option<&str>) -> Result<Vec<f64>> {
        let text = (0..100).filter(|row| *row != 40).map(|row| format!("{},{row}\n", stamp(row))).collect::<String>();
        let [from, until] = [from, until].map(|time| time.map(|time| time.parse().unwrap()));
        let args = ColumnOptions {
            time_column: Some("t_s".to_owned()),
            cut: Cut { from, until },
            ..ColumnOptions::default()
        };
        let columns =
            read_all(Path::new("log.csv"), format!("t_s,x\n{text}").into_bytes().into(), ColumnSelection::All, &args)?;
        columns[0].points(Path::new("log.csv"))
    }

    #[test]
    fn a_part_is_chosen_by_seconds_or_clock() {
        let seconds = |row: u32| format!("{}", 5.0 + f64::from(row) / 10.0);
        let clock = |row: u32| match row / 10 {
            s @ ..5 => format!("23:59:{:02}.{}", 55 + s, row % 10),
            s => format!("00:00:{:02}.{}", s - 5, row % 10),
        };
        let date = |row: u32| format!("2026-03-01T12:30:{:02}.{}", row / 10, row % 10);
        let span = |rows: &[f64]| (rows[0], rows[rows.len() - 1], rows.len());
        assert_eq!(span(&rows(seconds, Some("3"), Some("5s")).unwrap()), (30.0, 49.0, 20));
        assert_eq!(span(&rows(seconds, Some("4"), None).unwrap()), (41.0, 99.0, 59));
        assert_eq!(span(&rows(date, Some("12:30:03"), Some("2026-03-01T12:30:05Z")).unwrap()), (30.0, 49.0, 20));
        assert_eq!(span(&rows(clock, Some("23:59:58"), Some("00:00:02")).unwrap()), (30.0, 69.0, 40));
    }

    #[test]
    fn advice_to_cut_has_the_digits_of_the_samples() {
        for (time_s, interval_s, rounded_s) in [
            (2.99, 0.01, 2.99),
            (0.29, 0.01, 0.29),
            (14.989999999999782, 0.01, 14.98),
            (14.989999999999782, 0.005, 14.989),
            (14.989999999999782, 1e-12, 14.989999999),
            (60.0, 7.0, 60.0),
            (59.9, 7.0, 59.0),
        ] {
            assert_eq!(rounded_down(time_s, interval_s), rounded_s);
        }
    }

    #[test]
    fn a_part_outside_the_log_is_refused_with_its_span() {
        let date = |row: u32| format!("2026-03-01T12:30:{:02}.{}", row / 10, row % 10);
        let seconds = |row: u32| format!("{}", 5.0 + f64::from(row) / 10.0);
        let why = |stamp: &dyn Fn(u32) -> String, from, until| rows(stamp, from, until).unwrap_err().to_string();
        let said = why(&date, Some("13:00"), None);
        assert!(
            said.contains("skip leaves nothing of log.csv, which is 9.900000 s long, from 2026-03-01T12:30:00"),
            "{said}"
        );
        assert!(why(&seconds, Some("5"), Some("5")).starts_with("skip with until leaves nothing"));
        assert!(why(&seconds, Some("12:30"), None).contains("states no such clock; give seconds"));
    }
}
