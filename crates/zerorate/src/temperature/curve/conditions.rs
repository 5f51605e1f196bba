//! Chooses the unknown conditions of a record by their evidence, before the search for models: whether the sensor was
//! on before the logs, the noise and the lag of the thermometer, a draught at the thermometer, and the change of
//! temperature over which a hysteresis passes from one branch to the other.

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

/// Numbers of blocks to either side over which a draught at the thermometer is averaged.
const DRAUGHTS: [usize; 4] = [30, 100, 200, 300];
/// Least gain of the log evidence by a lag that may stand for a draught.
const GAIN_OF_LAG: f64 = 6.0;
/// A draught explains the logs as well as a lag if it lacks at most this share of the gain by the lag.
const AS_WELL: f64 = 0.07;
/// Log evidence that a draught may lack in any case.
const LITTLE: f64 = 1.5;

/// A record and its best model.
type Explained = (Record, Model);

/// The conditions that explain the logs best, with the best model. If `record` has a draught and a lag explains the
/// logs as well, `with_lag` is the record with this lag, and the lag, s.
pub(super) struct Conditions {
    pub(super) record: Record,
    pub(super) model: Model,
    pub(super) with_lag: Option<(Record, f64)>,
}

impl Conditions {
    /// `None` if no model can be computed.
    pub(super) fn of(logs: &[LogMeans]) -> Option<Self> {
        let (mut record, mut model) = best(logs)?;
        let lag_s = model.following.lag_s;
        if let Some((averaged, of_averaged)) = in_draught(logs, &record, &model) {
            let with_lag = Some((record.over(averaged.series), lag_s));
            return Some(Self { record: averaged, model: of_averaged, with_lag });
        }
        if lag_s > LONG_LAG * search::longest_lag_s(&record.logs) {
            record = record.without_lag();
            model = search::best(&record)?;
        }
        Some(Self { record, model, with_lag: None })
    }
}

/// The logs without a lag, with the temperature averaged, if they are explained nearly as well as by the lag of the
/// model. Where only the thermometer feels a draught, a lag averages its readings likewise. The shortest average that
/// explains the logs is taken, because a long one is uncertain at the ends of a log.
fn in_draught(logs: &[LogMeans], record: &Record, model: &Model) -> Option<Explained> {
    if model.following.lag_s <= 0.0 {
        return None;
    }
    let gain = model.log_score - search::best(&first_start(logs, record).without_lag())?.log_score;
    if gain < GAIN_OF_LAG {
        return None;
    }
    let enough = model.log_score - (AS_WELL * gain).max(LITTLE);
    let averaged = |reach: &usize| {
        let smoothed: Vec<LogMeans> = logs.iter().map(|log| log.smoothed(*reach, 0.0)).collect();
        let record = first_start(&smoothed, record).without_lag();
        is_near(&record, model).then(|| best_of([record].into_iter()))?
    };
    DRAUGHTS.iter().filter_map(averaged).find(|(_, model)| model.log_score > enough)
}

/// The record of these logs with the sensor switched on at their beginning, if it is not known to have been on.
fn first_start(logs: &[LogMeans], other: &Record) -> Record {
    let record = Record::new(logs.to_vec()).turning_within(other.turns);
    record.starts().into_iter().next().unwrap_or(record)
}

/// Returns the record of these logs under the conditions that explain it best, and its best model. `None` if no model
/// can be computed.
fn best(logs: &[LogMeans]) -> Option<Explained> {
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
    Some(best)
}

fn best_of(records: impl Iterator<Item = Record>) -> Option<Explained> {
    let explained = records.filter_map(|record| search::best(&record).map(|model| (record, model)));
    explained.max_by(|one, other| one.1.log_score.total_cmp(&other.1.log_score))
}

/// The likeliest of `others` if its log evidence is above that of `usual` by more than `gain`. Otherwise `usual`.
fn better(others: Vec<Record>, usual: Explained, gain: f64) -> Explained {
    let scored = others.into_iter().map(|record| (search::log_evidence_like(&record, &usual.1), record));
    let likeliest = scored.max_by(|one, other| one.0.total_cmp(&other.0));
    let worth = likeliest.map(|(_, record)| record).filter(|record| is_near(record, &usual.1));
    best_of(worth.into_iter()).filter(|(_, model)| model.log_score > usual.1.log_score + gain).unwrap_or(usual)
}

/// Whether a record is worth a search, which takes long: it is not if it is far worse under the noise of the model.
fn is_near(record: &Record, model: &Model) -> bool {
    search::log_evidence_like(record, model) > model.log_score - FAR
}

/// The logs as they are and, if the thermometer is noisy, with the temperature smoothed over each of [`REACHES`].
fn smoothings(logs: &[LogMeans]) -> Vec<Vec<LogMeans>> {
    let is_noisy = logs.iter().any(|log| log.noise_by_temperature() > NOISY);
    let reaches = if is_noisy { &REACHES[..] } else { &[] };
    let smoothed = |reach: &usize| logs.iter().map(|log| log.smoothed(*reach, 0.0)).collect();
    [logs.to_vec()].into_iter().chain(reaches.iter().map(smoothed)).collect()
}

/// The logs for each lag of the thermometer that is tried, smoothed as in the record, and at least over `REACHES[0]`.
fn late_thermometers(logs: &[LogMeans], record: &Record) -> Vec<Vec<LogMeans>> {
    let reach = |log: &LogMeans| (log.thermometer().smoothed_s / log.block_s() / 2.0) as usize;
    let reach = record.logs.iter().map(reach).max().unwrap_or(0).max(REACHES[0]);
    LATE_S.iter().map(|late_s| logs.iter().map(|log| log.smoothed(reach, *late_s)).collect()).collect()
}
