//! The part of a log to read, chosen by time.

use jiff::SignedDuration;
use std::str::FromStr;

/// The time at which the chosen part of a log begins or ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CutTime {
    /// Seconds since the first sample.
    SinceStart(f64),
    /// Seconds since midnight. The first such time from the start of the log on is meant.
    TimeOfDay(f64),
    /// Seconds since the Unix epoch. Stamps without a zone are taken as UTC.
    Date(f64),
}

/// The part of a log to read; by default the whole log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cut {
    /// The first sample is at this time or later.
    pub from: Option<CutTime>,
    /// All samples are before this time.
    pub until: Option<CutTime>,
}

/// Largest accepted time since the start of a log, s: ten years.
const MAX_S: f64 = 10.0 * 365.25 * DAY_S;

pub const DAY_S: f64 = 86_400.0;

impl FromStr for CutTime {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        // `12:30` would parse as a duration as well, but is a time of the day
        let duration = || Some(text.parse::<SignedDuration>().ok().filter(|_| !text.contains(':'))?.as_secs_f64());
        if let Some(s) = text.parse::<f64>().ok().or_else(duration) {
            if s < 0.0 {
                return Err("it cannot be negative".to_owned());
            }
            let is_possible = (0.0..=MAX_S).contains(&s);
            let outside = || "it must lie between 0 s and 10 years".to_owned();
            return is_possible.then_some(Self::SinceStart(s)).ok_or_else(outside);
        }
        if let Ok(stamp) = text.parse::<jiff::Timestamp>() {
            return Ok(Self::Date(stamp.as_duration().as_secs_f64()));
        }
        let utc = |date: jiff::civil::DateTime| date.to_zoned(jiff::tz::TimeZone::UTC);
        if let Ok(date) = text.parse().and_then(utc) {
            return Ok(Self::Date(date.timestamp().as_duration().as_secs_f64()));
        }
        let time = text.parse::<jiff::civil::Time>();
        let of_day = |time: jiff::civil::Time| time.duration_since(jiff::civil::Time::midnight()).as_secs_f64();
        time.map(|time| Self::TimeOfDay(of_day(time)))
            .map_err(|_| "write it like 90 (seconds), 10m, 1h30m, 12:30:00 or 2026-03-01T12:30:00".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_written_as_durations_or_clock_times() {
        let cases = [
            ("90", CutTime::SinceStart(90.0)),
            ("1h30m", CutTime::SinceStart(5400.0)),
            ("12:30", CutTime::TimeOfDay(45_000.0)),
            ("12:30:00.5", CutTime::TimeOfDay(45_000.5)),
            ("1970-01-02 00:00:01", CutTime::Date(86_401.0)),
            ("1970-01-02T01:00:01+01:00", CutTime::Date(86_401.0)),
        ];
        for (text, expected) in cases {
            assert_eq!(text.parse(), Ok(expected), "{text}");
        }
        for text in ["", "-1", "nan", "noon", "25:00", "11y"] {
            assert!(text.parse::<CutTime>().is_err(), "{text}");
        }
    }
}
