//! The error that asks for the rate of a log that does not state it.

use crate::clock_digits::times_of_day;
use crate::error::LogError;
use crate::middle::{median, usual_step};
use crate::sample::{Cell, Sampled};
use crate::setting::{Names, Setting, quoted};
use crate::text::dates::{self, DateColumn};
use crate::time_names::{is_like_time, is_step, states_time};
use crate::time_unit;
use std::path::Path;
use zerorate_allan::SettingName;
use zerorate_input::TimeUnit;

/// Fewest rows that show that a column rises evenly.
const FEWEST: usize = 10;

/// Counts since an epoch in unusual units: the range of counts from about the year 2000 to 2100, counts per second,
/// and the words of the question.
const EPOCHS: [(std::ops::Range<f64>, f64, &str); 5] = [
    (36_526.0..73_051.0, 1.0 / 86_400.0, "days, as Excel does"),
    (730_486.0..767_011.0, 1.0 / 86_400.0, "days, as MATLAB does"),
    (2_451_544.0..2_488_070.0, 1.0 / 86_400.0, "days, as the Julian date does"),
    (1.25e17..1.6e17, 1e7, "steps of 100 ns, as Windows does"),
    (6.3e17..6.63e17, 1e7, "steps of 100 ns, as .NET does"),
];

/// The error for a missing rate. It names the columns that may hold the time: by name among `columns`, and by the
/// first rows in `sample`.
pub fn no_rate(path: &Path, columns: &[&str], sample: &[Sampled], names: Names) -> LogError {
    let [rate, time, unit] = [Setting::Rate, Setting::TimeColumn, Setting::TimeUnit].map(|setting| names.of(setting));
    let rises = |Rising { column, unit: fits, other, rate_hz, step }: Rising<'_>| {
        let (or, or_hz) = other.map_or_else(Default::default, |other| {
            (format!(" or {}", other.name()), format!(" or {:.3}", rate_hz / fits.per_s() * other.per_s()))
        });
        let (fits, column) = (fits.name(), quoted(column));
        let is_time = format!("if it is the time, as it rises evenly ({rate_hz:.3}{or_hz} Hz)");
        let of_ticks = step.map(|step| format!(" (f/{step:.3} if {column} counts f ticks a second)"));
        let of_ticks = of_ticks.unwrap_or_default();
        format!("give {rate} in Hz{of_ticks}, or {time} {column} with {unit} {fits}{or} {is_time}")
    };
    let named = || match columns.iter().find(|name| is_like_time(name)) {
        Some(column) => format!("give {rate} in Hz, or {time} with {unit} if `{column}` is the time"),
        None => format!("give {rate} in Hz, or {time} if a column holds the time"),
    };
    let remedy = unread(sample).map(|why| format!("{why}, or give {rate} in Hz"));
    let remedy =
        remedy.or_else(|| clocks(sample).map(|all| format!("give {rate} in Hz, or {time} with one of: {all}")));
    let digits =
        || clock_of_digits(sample).map(|name| format!("give {rate} in Hz, or {time} {name} if it is the time"));
    let remedy = remedy.or_else(digits);
    let remedy = remedy.or_else(|| rising(sample).map(rises)).or_else(|| since_epoch(sample, rate));
    let remedy = remedy.or_else(|| steps(sample, rate)).or_else(|| ticks(sample, rate));
    let remedy = remedy.unwrap_or_else(named);
    LogError::Ask(format!("{} does not say how fast it was sampled: {remedy}", path.display()))
}

/// The first column of dates or times that cannot be read, with a cell and the reason.
fn unread(sample: &[Sampled]) -> Option<String> {
    sample.iter().find_map(|column| {
        let words = || column.cells.iter().filter_map(Cell::as_word);
        // a word that every row repeats is not a time
        let cell = words().next().filter(|first| words().any(|word| word != *first))?;
        let why = dates::reason(cell)?;
        let is_read = dates::nanoseconds(cell, DateColumn::of(words()).format).is_some();
        (!is_read).then(|| format!("column `{}` (`{cell}`) {why}", column.name))
    })
}

/// The columns of dates and times of day, if there are several.
fn clocks(sample: &[Sampled]) -> Option<String> {
    let are_times = |column: &&Sampled| DateColumn::of(column.cells.iter().filter_map(Cell::as_word)).are_times;
    let all: Vec<String> = sample.iter().filter(are_times).map(|column| format!("`{}`", column.name)).collect();
    (all.len() > 1).then(|| all.join(", "))
}

/// The first column of times with the digits of a clock.
fn clock_of_digits(sample: &[Sampled]) -> Option<String> {
    let are_digits = |column: &&Sampled| column.times().and_then(|times| times_of_day(&times)).is_some();
    sample.iter().find(are_digits).map(|column| quoted(&column.name))
}

/// Advice with the rate of a column that counts days, by its name, or counts since an epoch in an unusual unit.
fn since_epoch(sample: &[Sampled], rate: SettingName) -> Option<String> {
    sample.iter().find_map(|column| {
        let times = column.times().filter(|times| times.since_first().is_sorted_by(|one, next| one < next))?;
        let epoch = EPOCHS.iter().find(|(first, ..)| first.contains(&times.first()));
        let days = has_word(&column.name, &["days", "day"]).then_some((1.0 / 86_400.0, "days"));
        let (per_s, words) = epoch.map(|(_, per_s, words)| (*per_s, *words)).or(days)?;
        let rate_hz = times.time_base(TimeUnit::S, Names::default()).ok()?.rate_hz * per_s;
        Some(format!("give {rate} in Hz, which is {rate_hz:.3} if `{}` counts {words}", column.name))
    })
}

/// Advice with the rate of a column that, by its name, holds the steps between rows, in an unknown unit.
fn steps(sample: &[Sampled], rate: SettingName) -> Option<String> {
    let column = sample.iter().find(|column| is_step(&column.name))?;
    let step = usual_step(column.cells.iter().filter_map(Cell::as_number).collect())?;
    let unit = time_unit::usual(1.0 / step)?;
    let (name, rate_hz, unit) = (&column.name, unit.per_s() / step, unit.name());
    Some(format!("give {rate} in Hz, which is {rate_hz:.6} if `{name}` holds the step between rows in {unit}"))
}

/// Advice for a column whose name states ticks of an unknown length.
fn ticks(sample: &[Sampled], rate: SettingName) -> Option<String> {
    let is_other = |column: &&Sampled| has_other_unit(&column.name);
    let (name, step) = sample.iter().filter(is_other).find_map(|column| Some((&column.name, tick_step(column)?)))?;
    Some(format!("give {rate} in Hz, which is f/{step:.3} if `{name}` counts f ticks a second, evenly"))
}

/// The usual step of a column of whole numbers that rises by more than one a row.
fn tick_step(column: &Sampled) -> Option<f64> {
    let times = column.times().filter(|times| times.since_first().iter().all(|time| time.fract() == 0.0))?;
    times.interval().filter(|step| *step > 1.0 && times.since_first().is_sorted())
}

/// True if a name states a unit or a scale of time that is not known, so that no unit can be proposed.
fn has_other_unit(name: &str) -> bool {
    let words = ["days", "ticks", "tick", "cycles", "khz", "mhz", "hz", "ps"];
    let name_lower = name.to_lowercase();
    let is_counter = name_lower.contains("32k") || name_lower.contains("32768");
    !states_time(name) && (is_counter || has_word(name, &words))
}

fn has_word(name: &str, words: &[&str]) -> bool {
    name.to_lowercase().split(|c: char| !c.is_alphabetic()).any(|word| words.contains(&word))
}

/// Minutes or hours, if the name of a column suggests that it counts them.
fn longer_unit(name: &str) -> Option<TimeUnit> {
    let minutes = has_word(name, &["min", "mins", "minute", "minutes"]).then_some(TimeUnit::Min);
    minutes.or(has_word(name, &["h", "hr", "hrs", "hour", "hours"]).then_some(TimeUnit::H))
}

/// A column of numbers that rises as a time does.
struct Rising<'a> {
    column: &'a str,
    /// The unit in which rows come at a usual rate.
    unit: TimeUnit,
    /// Another unit in which rows come at a rate of an IMU.
    other: Option<TimeUnit>,
    rate_hz: f64,
    /// The usual step between rows, if the column may count ticks of an unknown length.
    step: Option<f64>,
}

/// A column that rises evenly, if possible one with the name of a time.
fn rising(sample: &[Sampled]) -> Option<Rising<'_>> {
    let all: Vec<Rising<'_>> = sample.iter().filter_map(Rising::of).collect();
    let at = all.iter().position(|rising| is_like_time(rising.column)).unwrap_or_default();
    all.into_iter().nth(at)
}

impl<'a> Rising<'a> {
    fn of(column: &'a Sampled) -> Option<Self> {
        let times = column.times().filter(|_| !has_other_unit(&column.name))?;
        if EPOCHS.iter().any(|(first, per_s, _)| *per_s > 1.0 && first.contains(&times.first())) {
            return None;
        }
        let rows = times.since_first();
        // a counter of rows or packets may have lost some, and so may times in ms
        let mut steps: Vec<f64> = rows.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let counts_rows = steps.iter().all(|step| step.fract() == 0.0) && median(&mut steps) == 1.0;
        let is_counter = counts_rows && (!is_like_time(&column.name) || steps.iter().all(|step| *step == 1.0));
        if rows.len() < FEWEST || is_counter || !rows.is_sorted_by(|one, next| one < next) {
            return None;
        }
        let per_unit = times.time_base(TimeUnit::S, Names::default()).ok()?.rate_hz;
        let stated = longer_unit(&column.name).or_else(|| time_unit::dated(&times));
        let unit = stated.or_else(|| time_unit::usual(per_unit))?;
        let other = time_unit::other(per_unit, unit).filter(|_| stated.is_none());
        let step = tick_step(column).filter(|_| stated.is_none() && !states_time(&column.name));
        Some(Self { column: &column.name, unit, other, rate_hz: per_unit * unit.per_s(), step })
    }
}
