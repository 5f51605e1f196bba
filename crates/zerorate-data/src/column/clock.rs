//! The time column of a log: how fast it was sampled, and where samples are missing.

use super::Gap;
use super::series::{join, missing_in};
use super::unit::TimeUnit;

/// Root mean square of what may be between a timestamp and an even clock, in sampling intervals. A clock that counts
/// in steps of 0.69 intervals has as much from rounding alone.
const MAX_JITTER: f64 = 0.2;

/// A timestamp may be this much of an interval early before the sample before it counts as missing no more.
const EARLY: f64 = 0.35;

/// More gaps than this share of the rows, with more samples missing than are there, are no gaps: rows that arrive in
/// bursts look so.
const MAX_GAPS: f64 = 0.05;

/// How fast the even clock follows the timestamps: it forgets an offset within some ten samples.
const FOLLOW: f64 = 0.1;

/// Times of rows, relative to the first, in the unit of the file.
pub struct Times {
    origin: Option<Origin>,
    since_first: Vec<f64>,
    /// The unit that the type of the column states.
    pub unit: Option<TimeUnit>,
}

/// The first time: as exact as the file has it, because an epoch in nanoseconds does not fit an f64.
#[derive(Clone, Copy)]
enum Origin {
    Integer(i64),
    Number(f64),
}

impl Times {
    /// No row yet.
    pub fn new() -> Self {
        Self { origin: None, since_first: Vec::new(), unit: None }
    }

    /// Adds the time of the next row; `Err` tells why that cannot be one.
    pub fn push_integer(&mut self, time: i64) -> Result<(), String> {
        match *self.origin.get_or_insert(Origin::Integer(time)) {
            Origin::Integer(first) => self.push((i128::from(time) - i128::from(first)) as f64, &time),
            Origin::Number(first) => self.push(time as f64 - first, &time),
        }
    }

    /// The same, of a time that is no integer.
    pub fn push_number(&mut self, time: f64) -> Result<(), String> {
        if !time.is_finite() {
            return Err("no time; every row must have one".to_owned());
        }
        match *self.origin.get_or_insert(Origin::Number(time)) {
            Origin::Integer(first) => self.push(time - first as f64, &time),
            Origin::Number(first) => self.push(time - first, &time),
        }
    }

    fn push(&mut self, since_first: f64, time: &dyn std::fmt::Display) -> Result<(), String> {
        match self.since_first.last() {
            Some(last) if since_first == *last => Err(format!(
                "the time stands still at {time}; give --rate HZ and no time column if the samples are evenly spaced \
                 all the same"
            )),
            Some(last) if since_first < *last => Err(format!(
                "the time goes back by {} to {time} (a counter that wrapped around, or two logs in one file?); cut \
                 the log there, or give --rate HZ and no time column",
                last - since_first
            )),
            _ => {
                self.since_first.push(since_first);
                Ok(())
            }
        }
    }

    /// Time of each row in ns, since the origin of the file's clock or, where that cannot be told in ns, since the
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

    /// Rate and gaps, if the clock is even enough for both to be beyond doubt.
    pub fn beat(&self, unit: TimeUnit) -> Result<Beat, String> {
        let interval = self.interval().ok_or("a time column of a single row tells no rate; give --rate HZ")?;
        let mut beat = Tracking { interval, even: 0.0, steps: 0, squares: 0.0, gaps: Vec::new() };
        for (row, time) in self.since_first.iter().enumerate().skip(1) {
            beat.step(row, *time);
        }
        let jitter = (beat.squares / (self.since_first.len() - 1) as f64).sqrt();
        if jitter > MAX_JITTER {
            let (off, most) = (jitter * 100.0, MAX_JITTER * 100.0);
            return Err(self.unsteady(
                unit,
                &format!("the timestamps are off an even clock by {off:.0} % of an interval (at most {most:.0} %)"),
            ));
        }
        let (rows, missing) = (self.since_first.len(), missing_in(&beat.gaps));
        if missing > rows as u64 && beat.gaps.len() as f64 > MAX_GAPS * rows as f64 {
            return Err(self.unsteady(
                unit,
                &format!("{missing} samples would be missing in {} places among {rows}", beat.gaps.len()),
            ));
        }
        Ok(Beat { rate_hz: beat.steps as f64 * unit.per_s() / self.since_first[rows - 1], gaps: beat.gaps })
    }

    /// The usual interval: the mean of those near the median, which is exact for a clock that rounds, too.
    fn interval(&self) -> Option<f64> {
        let mut intervals: Vec<f64> = self.intervals().collect();
        let middle = intervals.len().checked_sub(1)? / 2;
        let median = *intervals.select_nth_unstable_by(middle, f64::total_cmp).1;
        let near = |interval: &f64| (0.5 * median..=1.5 * median).contains(interval);
        let (sum, count) = intervals.into_iter().filter(near).fold((0.0, 0u32), |(sum, n), dt| (sum + dt, n + 1));
        Some(sum / f64::from(count))
    }

    fn intervals(&self) -> impl Iterator<Item = f64> {
        self.since_first.windows(2).map(|pair| pair[1] - pair[0])
    }

    fn unsteady(&self, unit: TimeUnit, why: &str) -> String {
        let shortest = self.intervals().fold(f64::INFINITY, f64::min);
        let longest = self.intervals().fold(0.0, f64::max);
        let [shortest, usual, longest] =
            [shortest, self.interval().unwrap_or_default(), longest].map(|dt| dt / unit.per_s());
        format!(
            "the clock is unsteady: intervals of {shortest:.6} s to {longest:.6} s around {usual:.6} s, and {why}; \
             give --rate HZ and no time column if the samples themselves are evenly spaced"
        )
    }
}

/// What a clock tells.
#[derive(Debug, PartialEq)]
pub struct Beat {
    /// Mean rate, lost samples included.
    pub rate_hz: f64,
    /// Before row `at`, `missing` samples were lost.
    pub gaps: Vec<Gap>,
}

/// An even clock that follows the timestamps, so that one late row is no lost sample.
struct Tracking {
    interval: f64,
    even: f64,
    steps: u64,
    squares: f64,
    gaps: Vec<Gap>,
}

impl Tracking {
    fn step(&mut self, row: usize, time: f64) {
        let steps = ((time - self.even) / self.interval + EARLY).floor().max(1.0);
        self.even += steps * self.interval;
        let off = time - self.even;
        self.squares += (off / self.interval).powi(2);
        self.even += FOLLOW * off;
        // saturates; a gap as long as that is refused later
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

    fn beat(times: impl IntoIterator<Item = f64>) -> Result<Beat, String> {
        let mut all = Times::new();
        for time in times {
            all.push_number(time)?;
        }
        all.beat(TimeUnit::S)
    }

    #[test]
    fn an_even_clock() {
        let found = beat((0..1000).map(|i| 1.7e9 + f64::from(i) / 200.0)).unwrap();
        assert!((found.rate_hz - 200.0).abs() < 1e-4 && found.gaps.is_empty());
    }

    #[test]
    fn an_epoch_in_nanoseconds_is_exact() {
        let mut times = Times::new();
        for i in 0..100 {
            times.push_integer(1_700_000_000_000_000_000 + i * 175_439).unwrap();
        }
        assert!((times.beat(TimeUnit::Ns).unwrap().rate_hz * 175_439e-9 - 1.0).abs() < 1e-15);
    }

    /// Rows 300..305 and 700 are missing.
    #[test]
    fn gaps_are_counted() {
        let there = (0..1000).filter(|i| !(300..305).contains(i) && *i != 700);
        let found = beat(there.map(|i| f64::from(i) * 0.01)).unwrap();
        assert_eq!(found.gaps, [Gap { at: 300, missing: 5 }, Gap { at: 695, missing: 1 }]);
        assert!((found.rate_hz - 100.0).abs() < 1e-9);
    }

    /// 400 Hz in whole milliseconds, and 640 Hz.
    #[test]
    fn a_clock_that_rounds() {
        for rate in [400.0, 640.0] {
            let found = beat((0..2000).map(|i| (f64::from(i) / rate * 1e3).floor() * 1e-3)).unwrap();
            assert!(found.gaps.is_empty(), "{rate} Hz: {:?}", found.gaps);
            assert!((found.rate_hz / rate - 1.0).abs() < 1e-3, "{}", found.rate_hz);
        }
    }

    /// A crystal that drifts by 200 ppm is followed.
    #[test]
    fn a_clock_that_drifts() {
        let found = beat((0..100_000).map(|i| f64::from(i) * 0.01 * (1.0 + 2e-9 * f64::from(i)))).unwrap();
        assert!(found.gaps.is_empty());
    }

    #[test]
    fn one_late_row_is_no_gap() {
        let found = beat((0..1000).map(|i| f64::from(i) + if i == 500 { 0.6 } else { 0.0 })).unwrap();
        assert!(found.gaps.is_empty());
    }

    #[test]
    fn clocks_without_a_beat_are_refused() {
        assert!(beat([0.0, 1.0, 2.0, 1.5]).unwrap_err().contains("goes back by 0.5 to 1.5"));
        assert!(beat([0.0, 1.0, 1.0]).unwrap_err().contains("stands still at 1"));
        assert!(beat([0.0]).unwrap_err().contains("single row"));
        assert!(beat([]).unwrap_err().contains("single row"));
        // rows that arrive in bursts of ten
        let bursts = (0..1000).map(|i| f64::from(i / 10) + f64::from(i % 10) * 0.002);
        let said = beat(bursts).unwrap_err();
        assert!(said.contains("unsteady: intervals of 0.002000 s to 0.982000 s around 0.002000 s"), "{said}");
        let noise = (0..1000).map(|i| f64::from(i) + f64::from(i * 7919 % 13) / 13.0);
        assert!(beat(noise).unwrap_err().contains("% of an interval (at most 20 %)"));
    }
}
