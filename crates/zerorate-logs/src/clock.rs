//! The time column of a log: its sampling rate, and the places of missing samples.

use super::alternating;
use super::late_rows::{self, AROUND};
use super::middle::mean;
use super::series::{join, missing_in};
use crate::setting::{Names, Setting};
use zerorate_allan::{Gap, SettingName};
use zerorate_input::TimeUnit;

/// Jitter of timestamps above which a warning is given: RMS deviation from an even clock, in sampling intervals.
const SAID_JITTER: f64 = 0.1;

/// Largest jitter, in intervals, at which the time of a row alone shows whether samples are missing before it. A clock
/// that counts in steps of 0.69 intervals has this jitter from rounding alone.
const CLEAR_JITTER: f64 = 0.2;

/// Largest jitter, in intervals, at which the rows around a place show whether samples are missing there. With
/// Gaussian jitter of this size, a third of the rows are nearer to the place of another row than to their own.
const MAX_JITTER: f64 = 0.5;

/// A row behind a missing sample may come this fraction of an interval early; the sample still counts as missing.
const EARLY: f64 = 0.35;

/// Rows that arrive in bursts look like gaps. So a log is refused if it has more gaps than this share of its rows, and
/// more missing samples than rows.
const MAX_GAPS: f64 = 0.05;

/// A log is refused if a single gap has more than this many times as many missing samples as the log has rows: the
/// clock was set, or another log follows.
const MAX_LEAP: u64 = 100;

/// Share of each deviation by which the even clock is corrected. Ten samples reduce an offset to a third.
const FOLLOW: f64 = 0.1;

/// Number of intervals that are searched for long and short ones in turn.
const JUDGED: usize = 10_000;

/// Longest regular interval, in steps, of a clock that counts in steps. Regular intervals are one step or two.
const LONGEST_STEP: f64 = 2.5;

/// Limits that tell a clock that counts in steps from a sensor that loses single samples: the fewest blocks of rows,
/// the mean number of losses in a block, and the share of neighbouring blocks whose losses differ by one at most.
const FEWEST_BLOCKS: usize = 8;
const IN_A_BLOCK: usize = 8;
const EVEN_BLOCKS: f64 = 0.9;

/// Times of rows, relative to the first, in the unit of the file.
pub struct Times {
    origin: Option<Origin>,
    since_first: Vec<f64>,
    /// The unit, if the type of the column or the format of the file states it.
    pub unit: Option<TimeUnit>,
}

/// The first time, exactly as in the file, because an epoch in nanoseconds does not fit an f64.
#[derive(Clone, Copy)]
enum Origin {
    Integer(i64),
    Number(f64),
}

impl Times {
    pub fn new() -> Self {
        Self { origin: None, since_first: Vec::new(), unit: None }
    }

    pub fn push_integer(&mut self, time: i64) {
        let since_first = match *self.origin.get_or_insert(Origin::Integer(time)) {
            Origin::Integer(first) => (i128::from(time) - i128::from(first)) as f64,
            Origin::Number(first) => time as f64 - first,
        };
        self.since_first.push(since_first);
    }

    /// Returns an error if the time is not finite.
    pub fn push_number(&mut self, time: f64) -> Result<(), String> {
        if !time.is_finite() {
            return Err("no time; every row must have one".to_owned());
        }
        let since_first = match *self.origin.get_or_insert(Origin::Number(time)) {
            Origin::Integer(first) => time - first as f64,
            Origin::Number(first) => time - first,
        };
        self.since_first.push(since_first);
        Ok(())
    }

    pub fn scale(&mut self, step: f64) {
        self.origin = Some(Origin::Number(self.first() * step));
        self.since_first.iter_mut().for_each(|time| *time *= step);
    }

    /// Appends the times of the next file, which was recorded with the same clock.
    pub fn append(&mut self, next: &Self) {
        let Some(origin) = next.origin else { return };
        let mine = *self.origin.get_or_insert(origin);
        let shift = match (mine, origin) {
            (Origin::Integer(mine), Origin::Integer(next)) => (i128::from(next) - i128::from(mine)) as f64,
            _ => next.first() - self.first(),
        };
        self.since_first.extend(next.since_first.iter().map(|time| time + shift));
    }

    /// The time of the first row; 0 without rows.
    pub fn first(&self) -> f64 {
        match self.origin {
            Some(Origin::Integer(first)) => first as f64,
            Some(Origin::Number(first)) => first,
            None => 0.0,
        }
    }

    pub fn since_first(&self) -> &[f64] {
        &self.since_first
    }

    /// Replaces the times since the first row. The first of them must be 0.
    pub fn replace(&mut self, since_first: Vec<f64>) {
        self.since_first = since_first;
    }

    /// Adds a minute wherever seconds of a minute start again. Returns the number of minutes that were added; 0 if a
    /// start does not follow the end of a minute, as after a restart of the device.
    pub fn unwrap_minutes(&mut self, per_s: f64) -> usize {
        let longest = self.interval().map_or(per_s, |interval| per_s.max(2.5 * interval));
        let (mut minutes, mut before) = (0, 0.0);
        let mut times = self.since_first.clone();
        for time in &mut times {
            let starts_again = *time < before - 30.0 * per_s;
            if starts_again && *time + 60.0 * per_s - before > longest {
                return 0;
            }
            minutes += usize::from(starts_again);
            before = *time;
            *time += 60.0 * per_s * minutes as f64;
        }
        self.since_first = times;
        minutes
    }

    /// Keeps the rows from `first` up to, but not including, `end`.
    pub fn keep(&mut self, first: usize, end: usize) {
        let start = self.since_first[first];
        self.origin = self.origin.map(|origin| match origin {
            Origin::Integer(time) => Origin::Integer(time.saturating_add(start as i64)),
            Origin::Number(time) => Origin::Number(time + start),
        });
        self.since_first = self.since_first[first..end].iter().map(|time| time - start).collect();
    }

    /// Keeps these rows, which must be ascending. Does nothing without rows.
    pub fn select(&mut self, rows: &[usize]) {
        let all = self.since_first.clone();
        if let (Some(first), Some(last)) = (rows.first(), rows.last()) {
            self.keep(*first, last + 1);
            self.since_first = rows.iter().map(|row| all[*row] - all[*first]).collect();
        }
    }

    /// Time of each row in ns, since the origin of the file's clock or, where that does not fit a `u64`, since the
    /// first row.
    pub fn nanoseconds(&self, unit: TimeUnit) -> Vec<u64> {
        let ns_per_unit = 1e9 / unit.per_s();
        let first_ns = match self.origin {
            Some(Origin::Integer(first)) => i128::from(first) * ns_per_unit as i128,
            Some(Origin::Number(first)) => (first * ns_per_unit).round() as i128,
            None => 0,
        };
        let last_ns = self.since_first.last().map_or(0, |last| (last * ns_per_unit).round() as i128);
        let fits = first_ns >= 0 && u64::try_from(first_ns + last_ns).is_ok();
        let first_ns = if fits { first_ns as u64 } else { 0 };
        self.since_first.iter().map(|since| first_ns.saturating_add((since * ns_per_unit).round() as u64)).collect()
    }

    pub fn time_base(&self, unit: TimeUnit, names: Names) -> Result<TimeBase, String> {
        let rate = names.of(Setting::Rate);
        let interval = self.interval();
        let interval =
            interval.ok_or_else(|| format!("a time column of fewer than two rows tells no rate; give {rate}"))?;
        let rows = self.since_first.len();
        let mut tracking = Tracking { interval, even: 0.0, steps: 0, squares: 0.0, gaps: Vec::new() };
        self.since_first.iter().enumerate().skip(1).for_each(|(row, time)| tracking.step(row, *time));
        let jitter = (tracking.squares / (rows - 1) as f64).sqrt();
        let is_clear = jitter <= CLEAR_JITTER;
        let is_coarse = is_clear && is_even(&tracking.gaps, rows);
        let (jitter, gaps, steps) = match is_clear {
            true if is_coarse => self.in_steps(interval, &tracking.gaps),
            true => (jitter, tracking.gaps, tracking.steps),
            false => late_rows::gaps(&self.since_first),
        };
        let missing = missing_in(&gaps);
        if missing > rows as u64 && gaps.len() as f64 > MAX_GAPS * rows as f64 {
            let places = if gaps.len() == 1 { "1 place".to_owned() } else { format!("{} places", gaps.len()) };
            let why = format!("{missing} samples would be missing in {places} among {rows}");
            return Err(self.unsteady(unit, &why, rate));
        }
        if let Some(leap) = gaps.iter().find(|gap| gap.missing > MAX_LEAP.saturating_mul(rows as u64)) {
            let by = (self.since_first[leap.at] - self.since_first[leap.at - 1]) / unit.per_s();
            return Err(format!(
                "the time leaps forward by {by:.3} s at row {}, and {rows} rows are all there is: a clock that was \
                 set, or two logs in one file? Cut the log there, or give {rate} and no time column",
                leap.at
            ));
        }
        if jitter > MAX_JITTER {
            let (off, most) = (jitter * 100.0, MAX_JITTER * 100.0);
            let why =
                format!("the timestamps are off an even clock by {off:.0} % of an interval (at most {most:.0} %)");
            return Err(self.unsteady(unit, &why, rate));
        }
        let rate_hz = match jitter <= SAID_JITTER {
            true => steps as f64 * unit.per_s() / self.since_first[rows - 1],
            false => unit.per_s() / self.slope(&gaps),
        };
        let as_losses = is_coarse.then_some(unit.per_s() / interval);
        let intervals_s: Vec<f64> = self.intervals().take(JUDGED).map(|interval| interval / unit.per_s()).collect();
        let in_turn_s = alternating::intervals(&intervals_s).filter(|_| !is_coarse);
        Ok(TimeBase { rate_hz, gaps, jitter, as_losses, in_turn_s })
    }

    /// Jitter, gaps and number of intervals of a clock that counts in steps a little shorter than the sampling
    /// interval. A double step is not a gap.
    fn in_steps(&self, step: f64, double: &[Gap]) -> (f64, Vec<Gap>, u64) {
        let short = self.intervals().filter(|interval| *interval <= LONGEST_STEP * step);
        let steps_per_sample = mean(short) / step;
        let samples = |missing: u64| (((missing + 1) as f64 / steps_per_sample).round() as u64).max(1) - 1;
        let long = double.iter().filter(|gap| gap.missing > 1);
        let gaps = long.map(|gap| Gap { missing: samples(gap.missing), ..*gap }).filter(|gap| gap.missing > 0);
        let gaps: Vec<Gap> = gaps.collect();
        let steps = (self.since_first.len() as u64 - 1).saturating_add(missing_in(&gaps));
        (1.0 / steps_per_sample / 12f64.sqrt(), gaps, steps)
    }

    /// The usual interval: the mean of the positive intervals from half to 1.5 times their median. `None` if no
    /// interval is positive.
    pub fn interval(&self) -> Option<f64> {
        let mut intervals: Vec<f64> = self.intervals().filter(|interval| *interval > 0.0).collect();
        let middle = intervals.len().checked_sub(1)? / 2;
        let median = *intervals.select_nth_unstable_by(middle, f64::total_cmp).1;
        let near = |interval: &f64| (0.5 * median..=1.5 * median).contains(interval);
        Some(mean(intervals.into_iter().filter(near)))
    }

    fn intervals(&self) -> impl Iterator<Item = f64> {
        self.since_first.windows(2).map(|pair| pair[1] - pair[0])
    }

    /// The sampling interval by least squares, so that delays of the first and the last row matter little.
    fn slope(&self, gaps: &[Gap]) -> f64 {
        let (mut missing, mut gaps) = (0, gaps.iter().peekable());
        let place = self.since_first.iter().enumerate().map(|(row, time)| {
            while let Some(gap) = gaps.next_if(|gap| gap.at <= row) {
                missing += gap.missing;
            }
            (row as f64 + missing as f64, *time)
        });
        let places: Vec<(f64, f64)> = place.collect();
        let rows = places.len() as f64;
        let (x, y) = places.iter().fold((0.0, 0.0), |(x, y), place| (x + place.0 / rows, y + place.1 / rows));
        let sums = places.iter().map(|place| ((place.0 - x) * (place.1 - y), (place.0 - x).powi(2)));
        let (both, square) = sums.fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1));
        both / square
    }

    fn unsteady(&self, unit: TimeUnit, why: &str, rate: SettingName) -> String {
        let shortest = self.intervals().fold(f64::INFINITY, f64::min);
        let longest = self.intervals().fold(0.0, f64::max);
        let [shortest, usual, longest] =
            [shortest, self.interval().unwrap_or_default(), longest].map(|dt| dt / unit.per_s());
        let span_s = self.since_first.last().copied().unwrap_or_default() / unit.per_s();
        let mean_hz = (self.since_first.len() - 1) as f64 / span_s;
        format!(
            "the clock is unsteady: intervals of {shortest:.6} s to {longest:.6} s around {usual:.6} s, and {why}; \
             give {rate} and no time column if the samples themselves are evenly spaced ({mean_hz:.3} Hz on average)"
        )
    }
}

/// True if gaps of one sample come as evenly as the double steps of a clock that counts in steps a little shorter than
/// the interval. The numbers of random losses differ by several from block to block.
fn is_even(gaps: &[Gap], rows: usize) -> bool {
    let singles: Vec<usize> = gaps.iter().filter(|gap| gap.missing == 1).map(|gap| gap.at).collect();
    let block = (rows * IN_A_BLOCK).div_ceil(singles.len().max(1));
    if rows / block < FEWEST_BLOCKS {
        return false;
    }
    let mut counts = vec![0i64; rows / block];
    for at in singles {
        if let Some(count) = counts.get_mut(at / block) {
            *count += 1;
        }
    }
    let even = counts.windows(2).filter(|pair| (pair[1] - pair[0]).abs() <= 1).count();
    even as f64 >= EVEN_BLOCKS * (counts.len() - 1) as f64
}

/// The rate and the gaps of a log according to its timestamps.
#[derive(Debug, PartialEq)]
pub struct TimeBase {
    /// Mean rate, Hz; lost samples count.
    pub rate_hz: f64,
    /// Before row `at`, `missing` samples were lost.
    pub gaps: Vec<Gap>,
    /// Root mean square deviation of the timestamps from an even clock, in intervals.
    pub jitter: f64,
    /// The other possible rate, Hz, of a clock that counts in steps: if double steps are losses. Otherwise `None`.
    pub as_losses: Option<f64>,
    /// The short and the long interval, s, if they take turns.
    pub in_turn_s: Option<(f64, f64)>,
}

/// Relative error of an Allan deviation that is negligible.
const NO_ERROR: f64 = 0.01;

impl TimeBase {
    /// The text of a warning, if the jitter is large. The samples are taken as evenly spaced. If they were really
    /// taken when the timestamps say, each is w(t + δ) in place of w(t), with δ of rms j intervals τ₀:
    ///
    /// * White noise is uncorrelated, so nothing changes.
    /// * A random walk differs by a variance of K²·E|δ| ≤ K²·j·τ₀, independent from sample to sample. The mean of m
    ///   samples differs by that over m, beside an Allan variance of K²·m·τ₀/3: the deviation by 3·j/m²/2 at most.
    /// * Flicker noise up to the Nyquist frequency differs by a variance of π/4·j²·B², beside 2·ln 2/π·B²: the
    ///   deviation by 0.89·j²/m.
    pub fn jitter_text(&self) -> Option<String> {
        let Self { rate_hz, jitter, .. } = *self;
        let error = |m: f64| 1.5 * jitter / (m * m) + 0.89 * jitter * jitter / m;
        let enough = (0..30).map(|power| f64::from(1u32 << power)).find(|m| error(*m) < NO_ERROR);
        (jitter > SAID_JITTER || self.in_turn_s.is_some()).then(|| {
            let off = match (self.in_turn_s, self.as_losses) {
                (Some((short_s, long_s)), _) => {
                    format!("come after {short_s:.6} and {long_s:.6} s in turn (two sensors in one table?)")
                }
                (None, Some(hz)) => format!("count in steps (or even losses at {hz:.0} Hz)"),
                (None, None) => format!("are off an even clock by {:.0} % of an interval", 100.0 * jitter),
            };
            format!("stamps {off}; judge from {:.4} s on", enough.unwrap_or_default() / rate_hz)
        })
    }
}

/// An even clock that follows the timestamps, so that one late row does not count as a lost sample.
struct Tracking {
    interval: f64,
    even: f64,
    steps: u64,
    squares: f64,
    gaps: Vec<Gap>,
}

impl Tracking {
    fn step(&mut self, row: usize, time: f64) {
        let steps = |even: f64| ((time - even) / self.interval + EARLY).floor();
        let near = self.gaps.last_mut().filter(|gap| gap.at + AROUND > row);
        if time - self.even < 0.5 * self.interval
            && let Some(gap) = near
        {
            // the rows since the gap were late, so the gap has one sample less
            gap.missing -= 1;
            self.even -= self.interval;
            self.steps = self.steps.saturating_sub(1);
        }
        self.gaps.pop_if(|gap| gap.missing == 0);
        let steps = steps(self.even).max(1.0);
        self.even += steps * self.interval;
        let off = time - self.even;
        self.squares += (off / self.interval).powi(2);
        self.even += FOLLOW * off;
        // the cast saturates; `time_base` refuses a gap as long as that
        let steps = steps as u64;
        self.steps = self.steps.saturating_add(steps);
        if steps > 1 {
            join(&mut self.gaps, Gap { at: row, missing: steps - 1 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn time_base(times: impl IntoIterator<Item = f64>) -> Result<TimeBase, String> {
        let mut all = Times::new();
        for time in times {
            all.push_number(time)?;
        }
        all.time_base(TimeUnit::S, Names::default())
    }

    /// Nearly Gaussian numbers of standard deviation 1, each a sum of twelve uniform numbers.
    fn normal(count: usize) -> impl Iterator<Item = f64> {
        let mut state = 1u64;
        let mut uniform = move || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..count).map(move |_| (0..12).map(|_| uniform()).sum::<f64>() - 6.0)
    }

    #[test]
    fn an_epoch_in_nanoseconds_is_exact() {
        let mut times = Times::new();
        for i in 0..100 {
            times.push_integer(1_700_000_000_000_000_000 + i * 175_439);
        }
        assert!((times.time_base(TimeUnit::Ns, Names::default()).unwrap().rate_hz * 175_439e-9 - 1.0).abs() < 1e-15);
    }

    #[test]
    fn gaps_are_counted() {
        let there = (0..1000).filter(|i| !(300..305).contains(i) && *i != 700);
        let found = time_base(there.map(|i| f64::from(i) * 0.01)).unwrap();
        assert_eq!(found.gaps, [Gap { at: 300, missing: 5 }, Gap { at: 695, missing: 1 }]);
        assert!((found.rate_hz - 100.0).abs() < 1e-9);
    }

    #[test]
    fn a_clock_that_rounds_has_no_gaps() {
        for rate in [400.0, 640.0] {
            let found = time_base((0..2000).map(|i| (f64::from(i) / rate * 1e3).floor() * 1e-3)).unwrap();
            assert!(found.gaps.is_empty(), "{rate} Hz: {:?}", found.gaps);
            assert!((found.rate_hz / rate - 1.0).abs() < 1e-3, "{}", found.rate_hz);
        }
    }

    /// Sampling rates of gyroscopes, with stamps in whole milliseconds and 500 samples missing once. The interval is
    /// below 1 ms, or between 1 ms and 1.5 ms.
    #[test]
    fn coarse_stamps_are_no_losses() {
        for rate in [667.0, 833.0, 952.0, 990.0, 1666.0] {
            let there = (0..60_000).filter(|i| !(30_000..30_500).contains(i));
            let found = time_base(there.map(|i| (f64::from(i) / rate * 1e3).floor() * 1e-3)).unwrap();
            assert!((found.rate_hz / rate - 1.0).abs() < 1e-4, "{rate} Hz: {}", found.rate_hz);
            assert!(missing_in(&found.gaps).abs_diff(500) < 3, "{rate} Hz: {:?}", found.gaps);
        }
        let text = time_base((0..60_000).map(|i| (f64::from(i) * 1.2).floor())).unwrap().jitter_text().unwrap();
        assert!(text.contains("count in steps (or even losses at 1 Hz)"), "{text}");
        // about as many samples are lost at random
        let mut late = normal(60_000);
        let there = (0..60_000).filter(|_| late.next().is_some_and(|z| z < 1.0));
        let found = time_base(there.map(|i| f64::from(i) * 1e-3)).unwrap();
        assert!((found.rate_hz - 1000.0).abs() < 1e-3 && found.as_losses.is_none(), "{}", found.rate_hz);
    }

    /// The interval grows by 400 ppm in the course of the log.
    #[test]
    fn a_clock_that_drifts_has_no_gaps() {
        let found = time_base((0..100_000).map(|i| f64::from(i) * 0.01 * (1.0 + 2e-9 * f64::from(i)))).unwrap();
        assert!(found.gaps.is_empty());
    }

    #[test]
    fn jitter_is_not_a_gap() {
        let normal: Vec<f64> = normal(40_000).collect();
        let gaussian = |jitter_s: f64| -> Vec<f64> { normal[..20_000].iter().map(|z| z * jitter_s).collect() };
        // the delays of a busy computer
        let exponential = normal.chunks_exact(2).map(|z| 0.000_75 * (z[0].powi(2) + z[1].powi(2))).collect();
        for late in [gaussian(0.001), gaussian(0.002), exponential] {
            let stamps = |missing: std::ops::Range<usize>| {
                let there = (0..20_000).filter(move |i| !missing.contains(i));
                let mut times: Vec<f64> = there.map(|i| i as f64 / 200.0 + late[i]).collect();
                times.sort_by(f64::total_cmp);
                times
            };
            let whole = time_base(stamps(0..0)).unwrap();
            assert!(whole.gaps.is_empty(), "{:?}", whole.gaps);
            assert!((whole.rate_hz / 200.0 - 1.0).abs() < 2e-6, "{}", whole.rate_hz);
            let text = whole.jitter_text().unwrap();
            assert!(text.contains("off an even clock by") && text.contains("judge from"), "{text}");
            let found = time_base(stamps(9_000..9_007)).unwrap();
            assert_eq!(missing_in(&found.gaps), 7, "{:?}", found.gaps);
            assert!(found.gaps.iter().all(|gap| gap.at.abs_diff(9_000) < 3), "{:?}", found.gaps);
        }
        assert_eq!(time_base((0..1000).map(f64::from)).unwrap().jitter_text(), None);
    }

    /// The bound of [`TimeBase::jitter_text`] holds for a simulated random walk, from one interval on.
    #[test]
    fn the_bound_on_jitter_holds() {
        const FINE: usize = 16;
        let (rows, jitter) = (20_000usize, 0.25);
        let mut walk = vec![0.0];
        walk.extend(normal(rows * FINE + 10 * FINE).scan(0.0, |sum, z| {
            *sum += z;
            Some(*sum)
        }));
        let even: Vec<f64> = (0..rows).map(|i| walk[(i + 4) * FINE]).collect();
        let late: Vec<f64> = normal(rows).map(|z| z * jitter * FINE as f64).collect();
        let taken: Vec<f64> =
            (0..rows).map(|i| walk[((i + 4) * FINE).saturating_add_signed(late[i] as isize)]).collect();
        let variance = |numbers: &[f64], m: usize| {
            let means: Vec<f64> = numbers.chunks_exact(m).map(|some| some.iter().sum::<f64>() / m as f64).collect();
            means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum::<f64>() / (2 * (means.len() - 1)) as f64
        };
        for m in [1usize, 2, 4, 8, 16] {
            let off = (variance(&taken, m) / variance(&even, m)).sqrt() - 1.0;
            let bound = 1.5 * jitter / (m * m) as f64 + 0.89 * jitter * jitter / m as f64;
            assert!(off.abs() < bound + 0.005, "m {m}: {off} {bound}");
        }
    }

    #[test]
    fn rows_that_were_late_are_no_gap() {
        let time = |i: i32| match i {
            300 => 300.9,
            500..=504 => 504.0 + 0.01 * f64::from(i - 500),
            _ => f64::from(i),
        };
        let found = time_base((0..1000).map(time)).unwrap();
        assert!(found.gaps.is_empty() && (found.rate_hz - 1.0).abs() < 1e-9, "{:?}", found.gaps);
        // stamps cut to whole units, of rows of which four in ten are missing at random
        let there = |i: &i32| i % 1000 == 0 || (i * i % 1009 * 7919) % 97 < 58;
        let found = time_base((0..=10_000).filter(there).map(|i| (f64::from(i) * 2.5).floor())).unwrap();
        assert!((found.rate_hz * 2.5 - 1.0).abs() < 1e-4, "{}", found.rate_hz);
    }

    #[test]
    fn clocks_without_a_steady_interval_are_refused() {
        assert!(time_base([0.0]).unwrap_err().contains("fewer than two rows"));
        assert!(time_base([]).unwrap_err().contains("fewer than two rows"));
        // rows that arrive in bursts of ten
        let bursts = (0..1000).map(|i| f64::from(i / 10) + f64::from(i % 10) * 0.002);
        let said = time_base(bursts).unwrap_err();
        assert!(said.contains("unsteady: intervals of 0.002000 s to 0.982000 s around 0.002000 s"), "{said}");
        assert!(said.contains("samples would be missing in 99 places") && said.contains("give rate"), "{said}");
        // a clock that was set while it ran
        let said = time_base((0..1000).map(|i| f64::from(i) + if i < 600 { 0.0 } else { 1.7e9 })).unwrap_err();
        assert!(said.contains("leaps forward by 1700000001.000 s at row 600"), "{said}");
        // intervals of random length
        let random = normal(5000).scan(0.0, |sum, z| {
            *sum += z * z;
            Some(*sum)
        });
        let said = time_base(random).unwrap_err();
        assert!(said.contains("% of an interval (at most 50 %)"), "{said}");
    }
}
