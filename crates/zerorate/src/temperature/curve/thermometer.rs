//! Smooths the readings of a coarse thermometer, removes failed readings, and finds the times at which it sticks.

use super::means::median;
use alloc::vec::Vec;

/// The steps of the thermometer of a log, its lag, and what was done about its faults.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thermometer {
    /// The smallest step between two readings, °C, if the readings are so coarse that each was taken as an interval.
    pub coarse_step_c: Option<f64>,
    /// Total time for which the thermometer was stuck, s.
    pub stuck_s: f64,
    /// Time over which the readings were smoothed, s, because of noise, a lag or a draught. 0 without smoothing.
    pub smoothed_s: f64,
    /// Lag of the thermometer behind the sensor, s.
    pub late_s: f64,
}

/// A run of equal readings.
#[derive(Clone, Copy, Debug)]
struct Run {
    start: usize,
    end: usize,
    temp_c: f64,
}

impl Run {
    fn length(&self) -> usize {
        self.end - self.start
    }
}

/// Mean length of runs, in parts of blocks, above which the readings are coarse.
const LONG_RUNS: usize = 3;
/// Ratio of the length of a run to the median above which a thermometer with fine readings may be stuck.
const STICKS: f64 = 60.0;
/// Ratio of a jump of the temperature to the median change above which a long run before the jump is a stuck one.
const JUMP: f64 = 8.0;
/// Smallest jump that shows a stuck thermometer, °C.
const LEAST_JUMP_C: f64 = 0.5;
/// Ratio of the length of the last run to the median, and its share of the log, above which the thermometer may
/// have stuck to the end.
const AT_END: (f64, f64) = (20.0, 0.1);
/// Share of changes that reverse the one before, above which the readings count as noisy.
const NOISY: f64 = 0.1;
/// Longest gap between readings that is interpolated: the larger of a time, s, and a multiple of the median gap.
const GAP: (f64, f64) = (60.0, 4.0);
/// Largest relative difference of run lengths if the thermometer is read at fixed times.
const EVEN: f64 = 0.15;

/// A reading is compared with this many readings to either side, to tell whether it has failed.
const BESIDE: usize = 10;
/// A reading has failed if it differs by more than this from the median of the readings beside it, °C.
const FAILED_C: f64 = 2.0;

/// Returns the readings with NaN in place of those that are far from the readings beside them, such as 0 °C where the
/// transfer failed.
pub(super) fn without_failures(readings_c: Vec<f64>) -> Vec<f64> {
    let has_failed = |at: usize| {
        let beside = &readings_c[at.saturating_sub(BESIDE)..(at + BESIDE + 1).min(readings_c.len())];
        let there: Vec<f64> = beside.iter().copied().filter(|temp_c| !temp_c.is_nan()).collect();
        (readings_c[at] - median(there)).abs() > FAILED_C
    };
    (0..readings_c.len()).map(|at| if has_failed(at) { f64::NAN } else { readings_c[at] }).collect()
}

/// Returns the temperatures of parts without the steps of a coarse thermometer, NaN where they are not known.
/// `last_c` are the last readings of the parts, and `means_c` their means.
pub(super) fn smooth(last_c: &[f64], means_c: &[f64], step_s: f64) -> (Vec<f64>, Thermometer) {
    let runs = runs(last_c);
    let readings: usize = runs.iter().map(Run::length).sum();
    if runs.len() < 3 || readings == 0 {
        return (means_c.to_vec(), Thermometer::default());
    }
    let is_coarse = readings > LONG_RUNS * runs.len();
    let is_held = is_coarse && are_even(&runs);
    let mut smoothed = match (is_held, is_coarse) {
        (true, _) => by_lines(last_c, &runs.iter().map(|run| (run.start as f64, run.temp_c)).collect::<Vec<_>>()),
        (false, true) => by_lines(last_c, &changes(&runs)),
        (false, false) => means_c.to_vec(),
    };
    fill(&mut smoothed, step_s);
    let stuck = stuck(&runs, is_coarse);
    stuck.iter().for_each(|run| smoothed[run.start..run.end].fill(f64::NAN));
    let coarse_step_c = (is_coarse && !is_held).then(|| least_step_c(&runs));
    let stuck_s = stuck.iter().map(Run::length).sum::<usize>() as f64 * step_s;
    (smoothed, Thermometer { coarse_step_c, stuck_s, ..Thermometer::default() })
}

/// Interpolates between readings that are not too far apart.
fn fill(temps_c: &mut [f64], step_s: f64) {
    let known: Vec<usize> = (0..temps_c.len()).filter(|k| !temps_c[*k].is_nan()).collect();
    let gaps = known.windows(2).map(|pair| (pair[1] - pair[0]) as f64);
    let longest = (GAP.0 / step_s).max(GAP.1 * median(gaps.collect()));
    for pair in known.windows(2).filter(|pair| (pair[1] - pair[0]) as f64 <= longest) {
        line(temps_c, pair[0], pair[1]);
    }
}

/// Interpolates linearly between the temperatures at two indices.
pub(super) fn line(temps_c: &mut [f64], from: usize, to: usize) {
    let (start_c, step_c) = (temps_c[from], (temps_c[to] - temps_c[from]) / (to - from) as f64);
    (from + 1..to).for_each(|k| temps_c[k] = start_c + step_c * (k - from) as f64);
}

fn runs(temps_c: &[f64]) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (at, temp_c) in temps_c.iter().enumerate().filter(|(_, temp_c)| !temp_c.is_nan()) {
        match runs.last_mut() {
            Some(run) if run.temp_c == *temp_c => run.end = at + 1,
            _ => runs.push(Run { start: at, end: at + 1, temp_c: *temp_c }),
        }
    }
    runs
}

/// Whether more than nine in ten runs have about the same length. Then the thermometer is read at fixed times, and
/// each reading is held.
fn are_even(runs: &[Run]) -> bool {
    let inner = &runs[1..runs.len() - 1];
    let usual = median(inner.iter().map(|run| run.length() as f64).collect());
    let is_usual = |run: &&Run| (run.length() as f64 - usual).abs() <= (EVEN * usual).max(1.0);
    usual >= LONG_RUNS as f64 && 10 * inner.iter().filter(is_usual).count() > 9 * inner.len()
}

/// Returns the runs in which the thermometer sticks. With fine and noisy readings, such runs are much longer than
/// usual. Otherwise they are long, and end with a jump or with the log.
fn stuck(runs: &[Run], is_coarse: bool) -> Vec<Run> {
    let usual = median(runs.iter().map(|run| run.length() as f64).collect()).max(1.0);
    let changes_c = || runs.windows(2).map(|pair| pair[1].temp_c - pair[0].temp_c);
    let jump_c = LEAST_JUMP_C.max(JUMP * median(changes_c().map(f64::abs).collect()));
    let turns = changes_c().zip(changes_c().skip(1)).filter(|(one, next)| one * next < 0.0).count();
    let is_noisy = !is_coarse && turns as f64 > NOISY * runs.len() as f64;
    let next_c = changes_c().map(Some).chain([None]);
    let readings: usize = runs.iter().map(Run::length).sum();
    let is_stuck = |(run, next_c): &(&Run, Option<f64>)| {
        let length = run.length() as f64;
        let is_long = length > usual * if is_coarse { 2.0 } else { STICKS };
        let is_very_long = length > (AT_END.0 * usual).max(AT_END.1 * readings as f64);
        is_long && (is_noisy || next_c.map_or(is_very_long, |next_c| next_c.abs() > jump_c))
    };
    runs.iter().zip(next_c).filter(is_stuck).map(|(run, _)| *run).collect()
}

fn least_step_c(runs: &[Run]) -> f64 {
    runs.windows(2).map(|pair| (pair[1].temp_c - pair[0].temp_c).abs()).fold(f64::MAX, f64::min)
}

/// Returns the changes of the readings as knots: at a change, the temperature is midway between both readings. If the
/// temperature turns within a run, it is assumed to go a quarter of a step beyond the change.
fn changes(runs: &[Run]) -> Vec<(f64, f64)> {
    let mut knots: Vec<(f64, f64)> = Vec::new();
    for pair in runs.windows(2) {
        let (before, after) = (pair[0], pair[1]);
        let middle_c = (before.temp_c + after.temp_c) / 2.0;
        if let Some(&(last_at, last_c)) = knots.last()
            && (last_c - before.temp_c) * (middle_c - before.temp_c) > 0.0
        {
            knots.push(((last_at + before.end as f64) / 2.0, (last_c + middle_c) / 4.0 + before.temp_c / 2.0));
        }
        knots.push(((before.end as f64 + after.start as f64) / 2.0, middle_c));
    }
    knots
}

/// Interpolates linearly between knots, each an index and a temperature.
fn by_lines(temps_c: &[f64], knots: &[(f64, f64)]) -> Vec<f64> {
    let mut next = 1;
    let at = |(index, reading_c): (usize, &f64)| {
        let at = index as f64 + 0.5;
        while next + 1 < knots.len() && knots[next].0 <= at {
            next += 1;
        }
        let Some((from, to)) = knots.get(next - 1).zip(knots.get(next)) else { return *reading_c };
        let temp_c = from.1 + (to.1 - from.1) / (to.0 - from.0) * (at - from.0);
        let half_c = (to.1 - from.1).abs() / 2.0;
        match at < from.0 || at > to.0 {
            true if reading_c.is_nan() => f64::NAN,
            // the first and the last run have a knot at one end only
            true => temp_c.clamp(reading_c - half_c, reading_c + half_c),
            false => temp_c,
        }
    };
    temps_c.iter().enumerate().map(at).collect()
}
