//! Finds the unit of times by the dates or the rate that it gives, and detects a unit that makes them absurd.

use crate::clock::Times;
use crate::error::LogError;
use crate::setting::{Names, Setting, quoted};
use crate::time_names::SAMPLE_TIME_FINE;
use std::path::Path;
use zerorate_input::TimeUnit;

/// The units that a rate or a date can tell, from the longest to the shortest.
const UNITS: [TimeUnit; 4] = [TimeUnit::S, TimeUnit::Ms, TimeUnit::Us, TimeUnit::Ns];

/// Plausible rates of sensors, Hz: from one sample in 100 s to somewhat above the 32 kHz of the fastest IMUs.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.01..=50_000.0;

/// Rate below which a column may count in a finer unit than its name states: `millis` that are microseconds.
const SLOW_HZ: f64 = 0.5;

/// Rates of IMUs, Hz. If several units give such a rate, the user is asked for one.
const RATES_OF_IMUS_HZ: std::ops::RangeInclusive<f64> = 2.0..=33_000.0;

/// The most usual of several units is the one whose rate is nearest to this, Hz.
const USUAL_HZ: f64 = 100.0;

/// The start of the years 2000 and 2100, in seconds since 1970.
const EPOCH_S: std::ops::Range<f64> = 946_684_800.0..4_102_444_800.0;

/// Largest time in seconds since 1970, in the year 2286. Larger times are in a finer unit.
const TOO_LATE_S: f64 = 1e10;

/// The unit in which the first time is a date of 2000 to 2100, counted from 1970. `None` if rows then come slower than
/// [`SLOWEST_HZ`]: the times may count from power-on in a finer unit.
pub fn dated(times: &Times) -> Option<TimeUnit> {
    let unit = date(times.first())?;
    let span_s = times.since_first().last()? / unit.per_s();
    let rate_hz = (times.since_first().len() - 1) as f64 / span_s;
    (rate_hz >= SLOWEST_HZ).then_some(unit)
}

/// Least rate at which dates tell the unit, Hz.
const SLOWEST_HZ: f64 = 2.0;

fn date(first: f64) -> Option<TimeUnit> {
    UNITS.into_iter().find(|unit| EPOCH_S.contains(&(first / unit.per_s())))
}

/// The unit that gives the most usual rate, for `per_unit` rows in each unit; `None` if that rate is not one of a
/// sensor.
pub fn usual(per_unit: f64) -> Option<TimeUnit> {
    nearest(per_unit, UNITS.into_iter()).filter(|unit| RATES_HZ.contains(&(per_unit * unit.per_s())))
}

/// Another unit that gives a rate of an IMU, for `per_unit` rows in each unit.
pub fn other(per_unit: f64, unit: TimeUnit) -> Option<TimeUnit> {
    let fits = |other: &TimeUnit| *other != unit && RATES_OF_IMUS_HZ.contains(&(per_unit * other.per_s()));
    nearest(per_unit, UNITS.into_iter().filter(fits))
}

/// The one of these units that gives the rate nearest to [`USUAL_HZ`].
fn nearest(per_unit: f64, units: impl Iterator<Item = TimeUnit>) -> Option<TimeUnit> {
    let off = |unit: &TimeUnit| (per_unit * unit.per_s() / USUAL_HZ).ln().abs();
    units.min_by(|one, other| off(one).total_cmp(&off(other)))
}

/// Least interval, in counts, at which `SampleTimeFine` counts microseconds.
const FINE: f64 = 5000.0;

/// The unit of Xsens's `SampleTimeFine`: 0.1 ms in an MTi, whose interval is below half a second, and µs in a
/// DOT, whose interval is above 8 ms.
pub fn of_xsens(name: &str, times: &Times) -> Option<(TimeUnit, f64)> {
    let is_xsens = name.eq_ignore_ascii_case(SAMPLE_TIME_FINE);
    let interval = if is_xsens { times.interval()? } else { return None };
    Some(if interval < FINE { (TimeUnit::Ms, 0.1) } else { (TimeUnit::Us, 1.0) })
}

/// Checks that times in this unit, in a column of a log, make sense. `is_named` means that only the name of the column
/// or dates state the unit.
///
/// # Errors
/// Returns a question that states the rate in this unit and in the unit that fits.
pub fn check(
    (path, column): (&Path, &str),
    times: &Times,
    (unit, is_named): (TimeUnit, bool),
    rate_hz: f64,
    names: Names,
) -> Result<(), LogError> {
    let better = better(unit, rate_hz, times.first());
    let is_open = better.is_none();
    let is_doubtful = is_named && date(times.first()) != Some(unit);
    let finer = || if is_doubtful { finer(unit, rate_hz) } else { None };
    let Some(better) = better.or_else(finer) else { return Ok(()) };
    let [rate, column_option, unit_option] =
        [Setting::Rate, Setting::TimeColumn, Setting::TimeUnit].map(|setting| names.of(setting));
    let span = times.since_first().last().copied().unwrap_or_default();
    let seen = |unit: TimeUnit, rate_hz: f64| {
        let span_s = span / unit.per_s();
        format!("in {} the rows come at {} Hz over {} s", unit.name(), short(rate_hz), short(span_s))
    };
    let per_unit = rate_hz / unit.per_s();
    let better_hz = per_unit * better.per_s();
    let or = if is_open { Some(unit) } else { other(per_unit, better) };
    let or = or.map_or_else(String::new, |or| format!(" or {}", or.name()));
    Err(LogError::Ask(format!(
        "{}, column {column}: {}, and {}; give {column_option} {} with {unit_option} {}{or}, or {rate} alone",
        path.display(),
        seen(unit, rate_hz),
        seen(better, better_hz),
        quoted(column),
        better.name(),
    )))
}

fn short(number: f64) -> String {
    if (1e-3..1e7).contains(&number) { format!("{number:.3}") } else { format!("{number:.1e}") }
}

/// The next finer unit than ms or µs, if rows come slower than [`SLOW_HZ`] in this unit.
fn finer(unit: TimeUnit, rate_hz: f64) -> Option<TimeUnit> {
    match unit {
        TimeUnit::Ms if rate_hz < SLOW_HZ => Some(TimeUnit::Us),
        TimeUnit::Us if rate_hz < SLOW_HZ => Some(TimeUnit::Ns),
        _ => None,
    }
}

/// Returns a time unit that fits the log better than `unit`; `None` if dates and rate are plausible in `unit`.
///
/// `rate_hz` is the rate of rows that `unit` implies. `first` is the first time as it is written.
fn better(unit: TimeUnit, rate_hz: f64, first: f64) -> Option<TimeUnit> {
    if first / unit.per_s() > TOO_LATE_S
        && let Some(dated) = date(first)
    {
        return Some(dated);
    }
    if RATES_HZ.contains(&rate_hz) {
        return None;
    }
    nearest(rate_hz / unit.per_s(), UNITS.into_iter().filter(|other| *other != unit))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 0.008 rows per unit are 8 Hz in ms or 8000 Hz in µs. 0.1 rows per unit are a rate of an IMU in ms only.
    #[test]
    fn another_unit_may_fit_as_well() {
        assert_eq!((usual(0.008), other(0.008, TimeUnit::Ms)), (Some(TimeUnit::Ms), Some(TimeUnit::Us)));
        assert_eq!((usual(0.1), other(0.1, TimeUnit::Ms)), (Some(TimeUnit::Ms), None));
    }

    #[test]
    fn an_absurd_rate_or_date_tells_the_unit() {
        use TimeUnit::{Ms, Ns, S, Us};
        let cases = [
            (S, 1e-7, 0.0, Some(Ns)),
            (Us, 1e5, 0.0, Some(Ms)),
            (Ns, 4e10, 0.0, Some(S)),
            (S, 0.2, 1.7e12, Some(Ms)),
            (S, 2e-4, 1.7e15, Some(Us)),
            (S, 100.0, 1.7e9, None),
            (Ns, 200.0, 1.7e18, None),
            (S, 1.0 / 60.0, 0.0, None),
            (Us, 32_000.0, 5e6, None),
            (Ms, 100.0, 1.7e12, None),
            (Ms, 0.1, 0.0, None),
        ];
        for (unit, rate_hz, first, expected) in cases {
            assert_eq!(better(unit, rate_hz, first), expected, "{unit:?} {rate_hz} {first}");
        }
        assert_eq!([finer(Ms, 0.1), finer(Us, 0.4), finer(Ms, 1.0), finer(S, 0.1)], [Some(Us), Some(Ns), None, None]);
    }
}
