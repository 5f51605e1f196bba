//! Compares a rate that the user or the log states with the timestamps of the log.

use crate::TimeUnit;
use crate::clock::median;
use crate::sample::Sampled;
use crate::setting::Names;
use crate::warning::LogWarning;
use std::path::Path;

/// Relative difference between a given rate and the rate of the stamps above which a warning is given. The clocks of a
/// sensor and of a computer differ by less.
const RATE_OFF: f64 = 0.02;

/// Relative difference above which a warning is given if several rows share a stamp, or if some stamps fall. Such
/// stamps give the rate less precisely.
const COARSE_RATE_OFF: f64 = 0.1;

/// A rate is computed from a coarse clock only if the clock makes more steps than this in the first rows.
const FEWEST_STEPS: usize = 20;

/// The warning about a given rate that differs from the rate of the stamps by more than the fraction `within`.
pub fn doubt(path: &Path, given_hz: f64, (stamps_hz, within): (f64, f64)) -> Option<LogWarning> {
    let path = path.display().to_string();
    let differs = (given_hz / stamps_hz - 1.0).abs() > within;
    differs.then_some(LogWarning::RateContradicts { path, given_hz, stamps_hz })
}

/// The rate of the stamps in Hz, and its relative tolerance. `all_hz` is the rate of all rows, if it is known. If not,
/// the first rows of the only column whose type or name states a unit of time tell the rate.
pub fn of_stamps(all_hz: Option<f64>, sample: &[Sampled]) -> Option<(f64, f64)> {
    if let Some(rate_hz) = all_hz {
        return Some((rate_hz, RATE_OFF));
    }
    let mut stating = sample.iter().filter_map(|column| Some((column, column.stated_time()?)));
    let (column, unit) = stating.next().filter(|_| stating.next().is_none())?;
    let times = column.times()?;
    let rows = times.since_first();
    if rows.is_sorted_by(|one, next| one < next) {
        return times.time_base(unit, Names::default()).ok().map(|time_base| (time_base.rate_hz, RATE_OFF));
    }
    if !rows.is_sorted() {
        return median_rate_hz(rows, unit).map(|rate_hz| (rate_hz, COARSE_RATE_OFF));
    }
    let steps = rows.windows(2).filter(|pair| pair[0] < pair[1]).count();
    let rate_hz = (rows.len() - 1) as f64 * unit.per_s() / rows.last()?;
    (steps > FEWEST_STEPS).then_some((rate_hz, COARSE_RATE_OFF))
}

/// The rate of stamps of which a few are wrong, from the median step, Hz. `None` if at most [`FEWEST_STEPS`] steps
/// rise, or more than a tenth do not.
fn median_rate_hz(rows: &[f64], unit: TimeUnit) -> Option<f64> {
    let mut steps: Vec<f64> = rows.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    let rise = steps.len() > FEWEST_STEPS && 10 * steps.len() >= 9 * (rows.len() - 1);
    rise.then(|| unit.per_s() / median(&mut steps))
}
