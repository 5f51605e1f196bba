//! Chooses the unknown conditions of a record by their evidence, before the search for models: whether the sensor was
//! on before the logs, the noise and the lag of the thermometer, and the change of temperature over which a hysteresis
//! passes from one branch to the other.

use super::LogMeans;
use super::evidence::{Model, Record, TURNS};
use super::search;
use alloc::vec::Vec;

/// Numbers of blocks to either side over which the temperature may be smoothed.
const REACHES: [usize; 4] = [3, 10, 30, 100];
/// Ratio of the noise by the thermometer to the white noise above which smoothing is tried.
const NOISY: f64 = 0.1;
/// Lags of the thermometer behind the sensor that are tried, s.
const LATE_S: [f64; 4] = [5.0, 10.0, 20.0, 40.0];
/// Gain of the log evidence that a lag of the thermometer needs. Such a lag is rarer than a lag of the bias.
const FROM_LATE: f64 = 6.0;
/// Gain of the log evidence that an unusual value of [`TURNS`] needs.
const FROM_TURNS: f64 = 3.0;
/// A record whose log evidence is lower than the best one by this much, under the same noise, is not searched.
const FAR: f64 = 20.0;
/// A lag above this share of the longest lag that is tried stands for another effect.
const LONG_LAG: f64 = 0.8;

/// A record and its best model.
type Explained = (Record, Model);

/// Returns the record of these logs under the conditions that explain it best, and its best model. `None` if no model
/// can be computed.
pub(super) fn best(logs: &[LogMeans]) -> Option<Explained> {
    let mut best = best_of(smoothings(logs).into_iter().flat_map(|logs| Record::new(logs).starts()))?;
    if best.0.two_directions {
        let turns = TURNS[1..].iter().map(|turns| best.0.turning_within(*turns)).collect();
        best = better(turns, best, FROM_TURNS);
    }
    // a lag of the thermometer is tried only if the bias seems to lag, because the two look alike
    if best.1.following.lag_s > 0.0 {
        let turns = best.0.turns;
        let late = late_thermometers(logs, &best.0).into_iter().flat_map(|logs| Record::new(logs).starts());
        best = better(late.map(|record| record.turning_within(turns)).collect(), best, FROM_LATE);
    }
    let (mut record, model) = best;
    if model.following.lag_s <= LONG_LAG * search::longest_lag_s(&record.logs) {
        return Some((record, model));
    }
    record.without_lag = true;
    search::best(&record).map(|model| (record, model))
}

fn best_of(records: impl Iterator<Item = Record>) -> Option<Explained> {
    let explained = records.filter_map(|record| search::best(&record).map(|model| (record, model)));
    explained.max_by(|one, other| one.1.log_score.total_cmp(&other.1.log_score))
}

/// The likeliest of `others`, if its log evidence is above that of `usual` by more than `gain`. A record that is far
/// worse under the noise of `usual` is not searched, because a search takes long.
fn better(others: Vec<Record>, usual: Explained, gain: f64) -> Explained {
    let score = usual.1.log_score;
    let scored = others.into_iter().map(|record| (search::log_evidence_like(&record, &usual.1), record));
    let likeliest = scored.max_by(|one, other| one.0.total_cmp(&other.0));
    let worth = likeliest.filter(|(evidence, _)| *evidence > score - FAR).map(|(_, record)| record);
    best_of(worth.into_iter()).filter(|(_, model)| model.log_score > score + gain).unwrap_or(usual)
}

/// The logs as they are and, if the thermometer is noisy, with its temperature smoothed.
fn smoothings(logs: &[LogMeans]) -> Vec<Vec<LogMeans>> {
    let is_noisy = logs.iter().any(|log| log.noise_by_temperature() > NOISY);
    let reaches = if is_noisy { &REACHES[..] } else { &[] };
    let smoothed = |reach: &usize| logs.iter().map(|log| log.smoothed(*reach, 0.0)).collect();
    [logs.to_vec()].into_iter().chain(reaches.iter().map(smoothed)).collect()
}

/// The logs for each lag of the thermometer that is tried, smoothed over the same time as in the record.
fn late_thermometers(logs: &[LogMeans], record: &Record) -> Vec<Vec<LogMeans>> {
    let reach = |log: &LogMeans| (log.thermometer().smoothed_s / log.block_s() / 2.0) as usize;
    let reach = record.logs.iter().map(reach).max().unwrap_or(0).max(REACHES[0]);
    LATE_S.iter().map(|late_s| logs.iter().map(|log| log.smoothed(reach, *late_s)).collect()).collect()
}
