//! `stream --track`: a day of motion with rest for a twentieth of it, after a calibration by AN-1042. The motion is
//! the same as in the core's tests.

#[path = "../../../crates/zerorate/tests/track/world.rs"]
mod world;

use super::judged::{DPH_PER_DPS, rms};
use crate::seeds::for_each_seed;
use adis16130_twin::Spec;
use std::ops::RangeInclusive;
use world::{Day, SELDOM};

const HOURS: f64 = 24.0;

/// Results of tracking over the days of many units.
#[derive(Clone, Debug)]
pub struct Tracking {
    /// Residual of the calibration alone, rms over units and time, °/h.
    pub static_dph: f64,
    /// Residual with tracking.
    pub tracked_dph: f64,
    /// Share of the time that the bias was inside the stated 95 % interval, %.
    pub inside: f64,
    /// Units that tracking made worse.
    pub worse: usize,
    pub units: usize,
}

/// Units with everything drawn from their seeds.
pub fn days(seeds: &RangeInclusive<u64>, threads: usize) -> anyhow::Result<Tracking> {
    let days = for_each_seed(seeds, threads, |seed| Ok(world::day(&Spec::from_seed(seed), HOURS, SELDOM)))?;
    Ok(Tracking::of(&days))
}

impl Tracking {
    fn of(days: &[Day]) -> Self {
        Self {
            static_dph: DPH_PER_DPS * rms(days.iter().map(|day| day.static_dps)),
            tracked_dph: DPH_PER_DPS * rms(days.iter().map(|day| day.tracked_dps)),
            inside: 100.0 * days.iter().map(|day| day.covered).sum::<f64>() / days.len().max(1) as f64,
            worse: days.iter().filter(|day| day.tracked_dps > day.static_dps).count(),
            units: days.len(),
        }
    }

    /// Residual without tracking over residual with it.
    pub fn ratio(&self) -> f64 {
        self.static_dph / self.tracked_dph
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_taken_together() {
        let day = |static_dps, tracked_dps, covered| Day { static_dps, tracked_dps, covered, ..Day::default() };
        let all = Tracking::of(&[day(0.03, 0.01, 1.0), day(0.01, 0.02, 0.5)]);
        assert!((all.ratio() - 2f64.sqrt()).abs() < 1e-9, "{all:?}");
        assert_eq!((all.inside, all.worse, all.units), (75.0, 1, 2));
    }
}
