//! Compares a rate that the user or the log states with the timestamps of the log.

use crate::choice::Columns;
use crate::clock::Times;
use crate::middle::median;
use crate::sample::{Cell, Sampled};
use crate::setting::Names;
use crate::text::dates::{self, DateColumn};
use crate::time_names::{fraction_of_clock_s, fraction_s, is_named_time, states_time, ticks};
use crate::warning::LogWarning;
use crate::{TimeUnit, time_unit};
use std::path::Path;

/// Relative difference between a given rate and the rate of the stamps above which a warning is given. The clocks of a
/// sensor and of a computer differ by less.
const RATE_OFF: f64 = 0.02;

/// Relative difference above which a warning is given if several rows share a stamp, or if some stamps fall. Such
/// stamps give the rate less precisely.
const COARSE_RATE_OFF: f64 = 0.1;

/// Rows come in bursts if their usual step is this many times shorter than the mean step. Bursts of two are twice.
const BURSTS: f64 = 1.9;

/// A rate is computed from a coarse clock only if the clock makes more steps than this in the first rows.
const FEWEST_STEPS: usize = 20;

/// The warning about a given rate that differs from the rate of the stamps by more than the fraction `within`.
pub fn doubt(path: &Path, given_hz: f64, (stamps_hz, within): (f64, f64)) -> Option<LogWarning> {
    let path = path.display().to_string();
    let differs = (given_hz / stamps_hz - 1.0).abs() > within;
    differs.then_some(LogWarning::RateContradicts { path, given_hz, stamps_hz })
}

/// The rate of the stamps in Hz, and its relative tolerance. `all_hz` is the rate of all rows, if it is known. If not,
/// the first rows tell the rate, by the column that would be the time if no rate were given. A column that is called a
/// time and states no unit counts if no decimal unit gives `given_hz`.
pub fn of_stamps(path: &Path, all_hz: Option<f64>, sample: &[Sampled], given_hz: f64) -> Option<(f64, f64)> {
    if let Some(rate_hz) = all_hz {
        return Some((rate_hz, RATE_OFF));
    }
    let Some((times, unit)) = first_times(path, sample) else {
        return rival(sample, given_hz).map(|(_, _, rate_hz)| (rate_hz, RATE_OFF));
    };
    let rows = times.since_first();
    if rows.is_sorted_by(|one, next| one < next) {
        let mean_hz = rows.len().checked_sub(1)? as f64 * unit.per_s() / rows.last()?;
        let rate_hz = times.time_base(unit, Names::default()).ok()?.rate_hz;
        // the short steps of rows that come in bursts tell no rate
        return (rate_hz < BURSTS * mean_hz).then_some((rate_hz, RATE_OFF));
    }
    if !rows.is_sorted() {
        return median_rate_hz(rows, unit).map(|rate_hz| (rate_hz, COARSE_RATE_OFF));
    }
    let steps = rows.windows(2).filter(|pair| pair[0] < pair[1]).count();
    let rate_hz = (rows.len() - 1) as f64 * unit.per_s() / rows.last()?;
    (steps > FEWEST_STEPS).then_some((rate_hz, COARSE_RATE_OFF))
}

/// An even column that is called a time, states no unit, and tells another rate than `rate_hz` in each decimal unit:
/// its name, its usual unit, and the rate in Hz. A counter of rows is not a time.
pub fn rival(sample: &[Sampled], rate_hz: f64) -> Option<(&str, TimeUnit, f64)> {
    sample.iter().filter(|column| is_named_time(&column.name) && !states_time(&column.name)).find_map(|column| {
        let times = column.times().filter(|times| times.since_first().len() > FEWEST_STEPS)?;
        let is_even = times.since_first().is_sorted_by(|one, next| one < next) && times.interval() != Some(1.0);
        let time_base = times.time_base(TimeUnit::S, Names::default()).ok().filter(|_| is_even)?;
        let unit = time_unit::usual(time_base.rate_hz)?;
        let other_hz = time_base.rate_hz * unit.per_s();
        let decades = (other_hz / rate_hz).log10();
        let differs = (10f64.powf(decades - decades.round()) - 1.0).abs() > RATE_OFF;
        (differs && time_base.jitter_text().is_none()).then_some((&*column.name, unit, other_hz))
    })
}

/// The rate of stamps of which a few are wrong, from the median step, Hz. `None` if at most [`FEWEST_STEPS`] steps
/// rise, or more than a tenth do not.
fn median_rate_hz(rows: &[f64], unit: TimeUnit) -> Option<f64> {
    let mut steps: Vec<f64> = rows.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let rise = steps.len() > FEWEST_STEPS && 10 * steps.len() >= 9 * (rows.len() - 1);
    rise.then(|| unit.per_s() / median(&mut steps))
}

/// The times of the first rows, and their unit.
fn first_times(path: &Path, sample: &[Sampled]) -> Option<(Times, TimeUnit)> {
    let dates: Vec<DateColumn> = sample.iter().map(|column| DateColumn::of(words(column))).collect();
    let is_clock = |(column, dates): (&Sampled, &DateColumn)| dates.are_times || column.time_unit.is_some();
    let clocks = sample.iter().zip(&dates).map(is_clock).collect();
    let is_numeric = |column: &Sampled| column.time_unit.is_none() && words(column).next().is_none();
    let numeric = sample.iter().map(is_numeric).collect();
    let names = sample.iter().map(|column| &*column.name).collect();
    let at = Columns { path, names, numeric, clocks, settings: Names::default() }.time(&[])?;
    let (column, DateColumn { are_times, format }) = (&sample[at], dates[at]);
    if are_times {
        let mut times = Times::new();
        let all = words(column).filter_map(|word| dates::nanoseconds(word, format));
        all.for_each(|ns| times.push_integer(ns));
        return Some((with_fraction(times, TimeUnit::Ns, sample, fraction_of_clock_s)?, TimeUnit::Ns));
    }
    let mut times = column.times()?;
    if let Some(unit) = column.stated_time() {
        return Some((with_fraction(times, unit, sample, |name| fraction_s(name, &column.name))?, unit));
    }
    if let Some((unit, step)) = ticks(&column.name).or_else(|| time_unit::of_xsens(&column.name, &times)) {
        times.scale(step);
        return Some((times, unit));
    }
    let unit = time_unit::dated(&times)?;
    Some((times, unit))
}

fn words(column: &Sampled) -> impl Iterator<Item = &str> + Clone {
    column.cells.iter().filter_map(Cell::as_word)
}

/// The times with the fractions of a second in another column, if there is one. `unit_s` tells the unit of a fraction,
/// s, by the name of its column. `None` if the columns are not whole seconds and fractions.
fn with_fraction(
    mut times: Times,
    unit: TimeUnit,
    sample: &[Sampled],
    unit_s: impl Fn(&str) -> Option<f64>,
) -> Option<Times> {
    let rest = sample.iter().find_map(|column| Some((column.times()?, unit_s(&column.name)?)));
    let Some((rest, unit_s)) = rest else { return Some(times) };
    let is_whole = |since: &f64| since % unit.per_s() == 0.0;
    let is_rest = |since: &f64| (0.0..1.0).contains(&((rest.first() + since) * unit_s));
    if !times.since_first().iter().all(is_whole) || !rest.since_first().iter().all(is_rest) {
        return None;
    }
    let since = |(whole, rest): (&f64, &f64)| whole + unit.per_s() * unit_s * rest;
    let all = times.since_first().iter().zip(rest.since_first()).map(since).collect();
    times.replace(all);
    Some(times)
}
