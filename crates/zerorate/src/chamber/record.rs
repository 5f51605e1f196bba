//! The record of a measurement in a chamber: the means over each second, and the soak points.

use crate::notice::Warning;
use alloc::vec::Vec;
use core::ops::Range;

/// Means over whole seconds. `temp_c`, `at_rest` and each list in `rates_dps` are as long as `start_s`. A second in
/// which an axis lacks its rate or temperature is in none of them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Beginning of each second, s from the start of the measurement.
    pub start_s: Vec<f64>,
    /// Mean of the part's own temperature, °C.
    pub temp_c: Vec<f64>,
    /// Mean rate of each axis, °/s.
    pub rates_dps: Vec<Vec<f64>>,
    /// Whether the part was at rest, judged by its rate.
    pub at_rest: Vec<bool>,
    /// The means at the soak points.
    pub soaks: Vec<Soak>,
    /// Rate samples that were read.
    pub samples: u64,
    /// Rate samples lost.
    pub lost: u64,
    /// Number of impossible rates and temperatures of the axis with the most. No mean includes impossible values.
    pub impossible: u64,
}

/// The mean readings of a soak point: over the average of a step, or over the end of a timed step.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "file", derive(serde::Serialize, serde::Deserialize))]
pub struct Soak {
    /// Index of the step, from 0.
    pub step: usize,
    /// Set point, °C.
    pub set_c: f64,
    /// Beginning, s from the start of the measurement.
    pub start_s: f64,
    /// End, s from the start of the measurement.
    pub end_s: f64,
    /// Mean of the part's own temperature, °C.
    pub temp_c: f64,
    /// Drift of the part's own temperature, °C/min.
    pub drift_c_per_min: f64,
    /// Whether the drift was below the limit of the plan.
    pub settled: bool,
    /// Mean rate of each axis, °/s.
    pub rates_dps: Vec<f64>,
}

impl Record {
    pub(super) fn new(axes: usize) -> Self {
        Self { rates_dps: alloc::vec![Vec::new(); axes], ..Self::default() }
    }

    /// Returns the warnings of the record, whatever its outcome. `earth_dps` is the subtracted component of the
    /// Earth's rotation, °/s.
    pub fn warnings(&self, earth_dps: Option<f64>) -> impl Iterator<Item = Warning> {
        let earth = earth_dps.map_or(Warning::EarthIncluded, |earth_dps| Warning::EarthSubtracted { earth_dps });
        let Self { samples, lost, impossible, .. } = *self;
        let share = move |count: u64| count as f64 / (samples + lost).max(1) as f64;
        let lost = (lost > 0).then(|| Warning::Lost { lost, fraction: share(lost) });
        let faulty = (impossible > 0).then(|| Warning::Impossible { count: impossible, fraction: share(impossible) });
        [Some(earth), lost, faulty].into_iter().flatten()
    }

    /// Number of seconds in the record.
    #[must_use]
    pub fn len(&self) -> usize {
        self.start_s.len()
    }

    /// Lowest and highest temperature, °C. `None` if the record is empty.
    #[must_use]
    pub fn span_c(&self) -> Option<(f64, f64)> {
        let low_c = self.temp_c.iter().copied().reduce(f64::min)?;
        Some((low_c, self.temp_c.iter().copied().reduce(f64::max)?))
    }

    /// Whether the record has no seconds.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.start_s.is_empty()
    }

    /// Share of the seconds in which the part was not at rest.
    #[must_use]
    pub fn restless(&self) -> f64 {
        let moving = self.at_rest.iter().filter(|at_rest| !**at_rest).count();
        moving as f64 / self.len().max(1) as f64
    }

    /// Index of the first second that begins at or after a time.
    pub(super) fn index_of(&self, start_s: f64) -> usize {
        self.start_s.partition_point(|at_s| *at_s < start_s)
    }

    /// Returns the slope of a line through the temperatures from an index on, °C/s, and its standard uncertainty
    /// from the scatter about the line. `None` for fewer than ten seconds.
    pub(super) fn drift(&self, from: usize) -> Option<Drift> {
        self.drift_within(from..self.len())
    }

    fn drift_within(&self, seconds: Range<usize>) -> Option<Drift> {
        let (times, temps) = (self.start_s.get(seconds.clone())?, self.temp_c.get(seconds)?);
        let n = times.len() as f64;
        if times.len() < 10 {
            return None;
        }
        let mean = |values: &[f64]| values.iter().sum::<f64>() / n;
        let (mid_s, mean_c) = (mean(times), mean(temps));
        let spread: f64 = times.iter().map(|s| (s - mid_s) * (s - mid_s)).sum();
        let c_per_s = times.iter().zip(temps).map(|(s, c)| (s - mid_s) * (c - mean_c)).sum::<f64>() / spread;
        let left = |(s, c): (&f64, &f64)| {
            let off = c - mean_c - c_per_s * (s - mid_s);
            off * off
        };
        let variance = times.iter().zip(temps).map(left).sum::<f64>() / (n - 2.0);
        Some(Drift { c_per_s, u_c_per_s: libm::sqrt(variance / spread), mean_c })
    }

    /// Whether the temperature drifts by less than a limit from an index on. A temperature that turns round has no
    /// slope over the whole time, so the drift of the first half must not be above the limit either.
    pub(super) fn is_settled(&self, from: usize, limit_c_per_s: f64) -> bool {
        let half = from + (self.len() - from) / 2;
        let turns = self.drift_within(from..half).is_some_and(|drift| drift.is_above(limit_c_per_s));
        !turns && self.drift(from).is_some_and(|drift| drift.is_below(limit_c_per_s))
    }
}

/// The slope of a line through temperatures, its standard uncertainty, and the mean of the temperatures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Drift {
    pub c_per_s: f64,
    pub u_c_per_s: f64,
    pub mean_c: f64,
}

impl Drift {
    /// Whether the drift is below a limit, with a probability of 97.7 %.
    pub fn is_below(&self, limit_c_per_s: f64) -> bool {
        self.c_per_s.abs() + 2.0 * self.u_c_per_s <= limit_c_per_s
    }

    /// Whether the drift is above a limit, with a probability of 97.7 %.
    fn is_above(&self, limit_c_per_s: f64) -> bool {
        self.c_per_s.abs() - 2.0 * self.u_c_per_s > limit_c_per_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// For 40 s the temperature falls by 1 °C/s. Then it rises for 100 s by 0.01 °C/s, with an alternating error of
    /// ±0.1 °C.
    #[test]
    fn a_drift_is_the_slope_of_a_line_and_its_uncertainty_comes_from_the_scatter() {
        let (mut record, n) = (Record::new(1), 100.0);
        for k in 0..140_u32 {
            let (at_s, error_c) = (f64::from(k), if k % 2 == 0 { 0.1 } else { -0.1 });
            record.start_s.push(at_s);
            record.temp_c.push(if k < 40 { 80.0 - at_s } else { 20.0 + 0.01 * at_s + error_c });
        }
        let drift = record.drift(40).expect("enough seconds");
        let spread = n * (n * n - 1.0) / 12.0;
        assert!((drift.c_per_s - 0.01).abs() < 1e-4, "{drift:?}");
        assert!((drift.mean_c - (20.0 + 0.01 * 89.5)).abs() < 1e-9, "{drift:?}");
        let expected = libm::sqrt(n / (n - 2.0) * 0.01 / spread);
        assert!((drift.u_c_per_s / expected - 1.0).abs() < 1e-3, "{drift:?}, not {expected}");
        assert_eq!(record.drift(131), None);
    }

    #[test]
    fn a_temperature_that_turns_round_is_not_settled() {
        let settles = |bend_c: f64| {
            let mut record = Record::new(1);
            for k in 0..100_u32 {
                let (at_s, error_c) = (f64::from(k), if k % 2 == 0 { 0.1 } else { -0.1 });
                record.start_s.push(at_s);
                record.temp_c.push(20.0 + bend_c * (at_s - 49.5) * (at_s - 49.5) / 2500.0 + error_c);
            }
            record.is_settled(0, 0.01)
        };
        assert!(settles(0.0) && settles(0.2) && !settles(1.0));
    }
}
