//! The readings of a thermometer: coarse ones as the intervals that they stand for, and times at which it sticks.

use alloc::vec::Vec;

/// Facts about the thermometer of a log.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Thermometer {
    /// The smallest step between two readings, °C, if the readings are so coarse that they were taken as intervals.
    pub coarse_step_c: Option<f64>,
    /// Time in which it stuck, s.
    pub stuck_s: f64,
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

/// Mean length of runs, in readings, from which the readings are taken as intervals.
const LONG_RUNS: usize = 3;
/// Ratio of the length of a run to the median from which the thermometer sticks, where readings are fine.
const STICKS: usize = 60;
/// Ratio of a jump of the temperature to the median jump that ends a time in which the thermometer sticks.
const JUMP: f64 = 8.0;
/// Least such jump, °C.
const LEAST_JUMP_C: f64 = 0.5;

/// The temperatures of parts without the steps of a coarse thermometer, NaN where it sticks. `last_c` are the last
/// readings of the parts, and `means_c` their means. A coarse reading stands for an interval: where it changes, the
/// temperature is in the middle of both readings, and between two changes it is a line.
pub(super) fn smooth(last_c: &[f64], means_c: &[f64], step_s: f64) -> (Vec<f64>, Thermometer) {
    let runs = runs(last_c);
    let count = runs.len();
    let readings: usize = runs.iter().map(Run::length).sum();
    if count < 3 || readings == 0 {
        return (means_c.to_vec(), Thermometer::default());
    }
    let is_coarse = readings > LONG_RUNS * count;
    let stuck: Vec<Run> = stuck(&runs, is_coarse);
    let mut smoothed = if is_coarse { between_changes(last_c, &runs) } else { means_c.to_vec() };
    stuck.iter().for_each(|run| smoothed[run.start..run.end].fill(f64::NAN));
    let coarse_step_c = is_coarse.then(|| least_step_c(&runs));
    let stuck_s = stuck.iter().map(Run::length).sum::<usize>() as f64 * step_s;
    (smoothed, Thermometer { coarse_step_c, stuck_s })
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

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
}

/// The times in which the thermometer sticks: much longer than usual where readings are fine, and before a jump where
/// they are coarse.
fn stuck(runs: &[Run], is_coarse: bool) -> Vec<Run> {
    let usual = median(runs.iter().map(|run| run.length() as f64).collect()).max(1.0);
    let jumps_c = || runs.windows(2).map(|pair| (pair[1].temp_c - pair[0].temp_c).abs());
    let jump_c = LEAST_JUMP_C.max(JUMP * median(jumps_c().collect()));
    let next_c = jumps_c().map(Some).chain([None]);
    let is_stuck = |(run, next_c): &(&Run, Option<f64>)| {
        let is_long = run.length() as f64 > usual * if is_coarse { 2.0 } else { STICKS as f64 };
        is_long && (!is_coarse || next_c.is_some_and(|next_c| next_c > jump_c))
    };
    runs.iter().zip(next_c).filter(is_stuck).map(|(run, _)| *run).collect()
}

/// The smallest difference between two readings, °C.
fn least_step_c(runs: &[Run]) -> f64 {
    runs.windows(2).map(|pair| (pair[1].temp_c - pair[0].temp_c).abs()).fold(f64::MAX, f64::min)
}

/// Lines between the changes of the readings. Where the temperature turns within a run, it goes a quarter of a step
/// into the run.
fn between_changes(temps_c: &[f64], runs: &[Run]) -> Vec<f64> {
    let mut knots: Vec<(f64, f64)> = Vec::new();
    for pair in runs.windows(2) {
        let (before, after) = (pair[0], pair[1]);
        let middle_c = (before.temp_c + after.temp_c) / 2.0;
        if let Some(&(last_at, last_c)) = knots.last() {
            let turns = (last_c - before.temp_c) * (middle_c - before.temp_c) > 0.0;
            if turns {
                knots.push(((last_at + before.end as f64) / 2.0, (last_c + middle_c) / 4.0 + before.temp_c / 2.0));
            }
        }
        knots.push(((before.end as f64 + after.start as f64) / 2.0, middle_c));
    }
    let line =
        |(from, to): ((f64, f64), (f64, f64)), at: f64| from.1 + (to.1 - from.1) / (to.0 - from.0) * (at - from.0);
    let mut next = 1;
    let at = |(index, reading_c): (usize, &f64)| {
        let at = index as f64 + 0.5;
        while next + 1 < knots.len() && knots[next].0 <= at {
            next += 1;
        }
        let Some(pair) = knots.get(next - 1).copied().zip(knots.get(next).copied()) else { return *reading_c };
        if reading_c.is_nan() {
            return f64::NAN;
        }
        let is_outside = at < pair.0.0 || at > pair.1.0;
        let half_c = (pair.1.1 - pair.0.1).abs() / 2.0;
        // the first and the last run have one end only
        let limit =
            |temp_c: f64| if is_outside { temp_c.clamp(reading_c - half_c, reading_c + half_c) } else { temp_c };
        limit(line(pair, at))
    };
    temps_c.iter().enumerate().map(at).collect()
}
