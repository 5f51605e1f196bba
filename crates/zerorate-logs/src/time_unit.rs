//! Detects a unit of time that makes the rate or the date absurd.

use crate::clock::Times;
use crate::error::LogError;
use crate::setting::{Names, Setting};
use std::path::Path;
use zerorate_input::TimeUnit;

/// Rates of sensors, Hz: from one sample in a minute or two to the fastest registers.
const RATES_HZ: std::ops::RangeInclusive<f64> = 0.01..=50_000.0;

/// A usual rate, Hz.
const USUAL_HZ: f64 = 100.0;

/// The start of the years 2000 and 2100, in seconds since 1970.
const EPOCH_S: std::ops::Range<f64> = 946_684_800.0..4_102_444_800.0;

/// The year 2286, in seconds since 1970.
const TOO_LATE_S: f64 = 1e10;

const ALL: [TimeUnit; 4] = [TimeUnit::S, TimeUnit::Ms, TimeUnit::Us, TimeUnit::Ns];

/// The unit in which times are dates of 2000 to 2100, counted from 1970. Where rows then come slower than
/// [`SLOWEST_HZ`], the times may be those since the start in a finer unit, and nothing is told.
pub fn dated(times: &Times) -> Option<TimeUnit> {
    let unit = date(times.first())?;
    let span_s = times.since_first().last()? / unit.per_s();
    let rate_hz = (times.since_first().len() - 1) as f64 / span_s;
    (rate_hz >= SLOWEST_HZ).then_some(unit)
}

/// Least rate at which dates tell the unit, Hz.
const SLOWEST_HZ: f64 = 2.0;

fn date(first: f64) -> Option<TimeUnit> {
    ALL.into_iter().find(|unit| EPOCH_S.contains(&(first / unit.per_s())))
}

/// Checks that times in this unit, in a column of a log, make sense.
///
/// # Errors
/// Returns a question that states the rate in this unit and in the unit that fits.
pub fn check(
    (path, column): (&Path, &str),
    times: &Times,
    unit: TimeUnit,
    rate_hz: f64,
    names: Names,
) -> Result<(), LogError> {
    let Some(better) = better(unit, rate_hz, times.first()) else { return Ok(()) };
    let [rate, column_option, unit_option] =
        [Setting::Rate, Setting::TimeColumn, Setting::TimeUnit].map(|setting| names.of(setting));
    let span = times.since_first().last().copied().unwrap_or_default();
    let seen = |unit: TimeUnit, rate_hz: f64| {
        let span_s = span / unit.per_s();
        format!("in {} the rows come at {} Hz over {} s", unit.name(), short(rate_hz), short(span_s))
    };
    let better_hz = rate_hz / unit.per_s() * better.per_s();
    Err(LogError::Ask(format!(
        "{}, column {column}: {}, and {}; give {column_option} {column} with {unit_option} {}, or {rate} alone",
        path.display(),
        seen(unit, rate_hz),
        seen(better, better_hz),
        better.name()
    )))
}

/// Formats a number of any size in few digits.
fn short(number: f64) -> String {
    if (1e-3..1e7).contains(&number) { format!("{number:.3}") } else { format!("{number:.1e}") }
}

/// The unit that fits better than `unit`, in which rows come at `rate_hz` from the time `first` on; `None` where that
/// unit makes sense.
fn better(unit: TimeUnit, rate_hz: f64, first: f64) -> Option<TimeUnit> {
    let others = || ALL.into_iter().filter(move |other| *other != unit);
    if first / unit.per_s() > TOO_LATE_S
        && let Some(dated) = date(first)
    {
        return Some(dated);
    }
    if RATES_HZ.contains(&rate_hz) {
        return None;
    }
    let off = |other: &TimeUnit| (rate_hz / unit.per_s() * other.per_s() / USUAL_HZ).ln().abs();
    others().min_by(|one, other| off(one).total_cmp(&off(other)))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        ];
        for (unit, rate_hz, first, expected) in cases {
            assert_eq!(better(unit, rate_hz, first), expected, "{unit:?} {rate_hz} {first}");
        }
    }
}
