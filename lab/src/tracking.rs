//! `cargo xtask tracking`: runs `stream --track` on simulated days of many units that were calibrated by AN-1042, and
//! compares the bias with the truth. The simulated motion is the same as in the core's tests. The task prints the
//! table of docs/tracking.md.

#[path = "../../crates/zerorate/tests/core/track/world.rs"]
mod world;

use crate::residuals::{DPH_PER_DPS, median, rms};
use crate::seeds::{self, for_each_seed};
use adis16130_twin::Spec;
use std::ops::RangeInclusive;
pub use world::SELDOM;
use world::{Day, HALF, OFTEN};

const HOURS: f64 = 24.0;

/// The simulated worlds. Each has a label, which is the share of the moving time in slow rotations, and the number of
/// slow rotations per 21 other motions.
const WORLDS: [(&str, f64); 4] = [("none", 0.0), ("5 %", SELDOM), ("25 %", OFTEN), ("50 %", HALF)];

const HEADING: &str = "\
| slow rotations | calibration alone, °/h | tracked, °/h | ratio | least ratio of a unit | median | worse units | \
inside ±1.96 u | at the end | rest learned | rotations learned | other motion learned |
|---|---|---|---|---|---|---|---|---|---|---|---|";

#[derive(clap::Args)]
pub struct TrackingArgs {
    /// Units by their seeds, both ends included
    #[arg(long, default_value = "1..200", value_parser = seeds::parse, value_name = "A..B")]
    seeds: RangeInclusive<u64>,
}

pub fn run(args: &TrackingArgs) -> anyhow::Result<()> {
    println!("{HEADING}");
    for (share, slow_turns) in WORLDS {
        println!("{}", days(&args.seeds, slow_turns)?.row(share));
    }
    Ok(())
}

/// The results of tracking on the days of many units.
#[derive(Clone, Debug)]
pub struct Tracking {
    /// Residual bias with the calibration only, rms over units and time, °/h.
    pub static_dph: f64,
    pub tracked_dph: f64,
    /// Ratio of the residuals without and with tracking for each unit, ascending.
    pub ratios: Vec<f64>,
    /// Share of the time in which the bias was inside its 95 % interval, %.
    pub inside: f64,
    /// Share of the units whose bias was inside its 95 % interval at the end, %.
    pub inside_at_end: f64,
    /// Share of the time at rest in which the bias was learned, %.
    pub learned: f64,
    /// Share of the time of slow rotations that was mistaken for rest, %; `None` without slow rotations.
    pub turns_learned: Option<f64>,
    /// Other motion that was mistaken for rest, s: mean over all units.
    pub motion_learned_s: f64,
}

/// Simulates a day for each unit, with `slow_turns` slow rotations per 21 other motions.
pub fn days(seeds: &RangeInclusive<u64>, slow_turns: f64) -> anyhow::Result<Tracking> {
    let days = for_each_seed(seeds.clone(), |seed| Ok(world::day(&Spec::from_seed(seed), HOURS, slow_turns)))?;
    Ok(Tracking::of(&days))
}

impl Tracking {
    fn of(days: &[Day]) -> Self {
        let mean = |of: fn(&Day) -> f64| days.iter().map(of).sum::<f64>() / days.len().max(1) as f64;
        let mut ratios: Vec<f64> = days.iter().map(|day| day.static_dps / day.tracked_dps).collect();
        ratios.sort_by(f64::total_cmp);
        let turning_s = mean(|day| day.turning_s);
        Self {
            static_dph: DPH_PER_DPS * rms(days.iter().map(|day| day.static_dps)),
            tracked_dph: DPH_PER_DPS * rms(days.iter().map(|day| day.tracked_dps)),
            ratios,
            inside: 100.0 * mean(|day| day.covered),
            inside_at_end: 100.0 * mean(|day| f64::from(u8::from(day.covered_at_end))),
            learned: 100.0 * mean(|day| day.learned_s) / mean(|day| day.rest_s),
            turns_learned: (turning_s > 0.0).then(|| 100.0 * mean(|day| day.turning_learned_s) / turning_s),
            motion_learned_s: mean(|day| day.moving_learned_s),
        }
    }

    /// Ratio of the residuals of all units, rms, without and with tracking.
    pub fn ratio(&self) -> f64 {
        self.static_dph / self.tracked_dph
    }

    pub fn worse(&self) -> usize {
        self.ratios.iter().filter(|ratio| **ratio < 1.0).count()
    }

    fn row(&self, share: &str) -> String {
        let Self { static_dph, tracked_dph, ratios, inside, inside_at_end, learned, .. } = self;
        let least = ratios.first().copied().unwrap_or(f64::NAN);
        let median = median(ratios.clone());
        let turns = self.turns_learned.map_or("none".to_owned(), |share| format!("{share:.1} %"));
        format!(
            "| {share} | {static_dph:.1} | {tracked_dph:.1} | {:.2} | {least:.3} | {median:.2} | {} of {} | \
             {inside:.1} % | {inside_at_end:.1} % | {learned:.0} % | {turns} | {:.1} s |",
            self.ratio(),
            self.worse(),
            ratios.len(),
            self.motion_learned_s
        )
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
        assert_eq!((all.inside, all.worse(), all.ratios.as_slice()), (75.0, 1, [0.5, 3.0].as_slice()));
        assert_eq!(all.row("5 %").matches('|').count(), HEADING.lines().next().unwrap_or("").matches('|').count());
    }
}
