//! Compares the tracked bias with the true bias of the twin. `cargo xtask methods` does this for hundreds of units.

use crate::track::world::{Day, HALF, OFTEN, Random, SELDOM, Unit, day};
use adis16130_twin::Spec;
use zerorate::track::{BLOCK_S, Filter, Phase, Prior, Saved, Tracker, TrackerConfig, Unsound};
use zerorate::{Axis, Correction};

const NOISE_DPS: f64 = 0.0125; // F-02
const CORRECTION: Correction = Correction::line(-0.25, -0.04, 33.0);
const PRIOR: Prior =
    Prior { u_pbc_dps: 0.003, u_btc_dps_per_c: 0.003, cov_pbc_btc_dps2_per_c: 0.0, u_curvature_dps_per_c2: 0.0005 };

fn tracker() -> Tracker {
    Tracker::new(TrackerConfig::of(&Axis::ADIS16130, CORRECTION, PRIOR))
}

/// Pushes blocks at T3 for `seconds`. The rate is the calibrated bias, plus `dps` at the time in s, plus white noise.
fn push(tracker: &mut Tracker, random: &mut Random, seconds: f64, mut dps: impl FnMut(f64) -> f64) {
    for block in 0..(seconds / BLOCK_S).round() as u32 {
        let noise_dps = NOISE_DPS / (2.0 * BLOCK_S).sqrt() * random.normal();
        tracker.push(Some(0.25 + dps(f64::from(block) * BLOCK_S) + noise_dps), Some(33.0), true);
    }
}

fn moving(since_s: f64) -> f64 {
    20.0 * (since_s * 3.0).sin()
}

/// Over a day with 5 % of rest, the rms error is less than a third of the error with the calibration alone. The true
/// bias lies within 1.96 u for 90 to 99 % of the time.
#[test]
fn a_tracked_bias_is_three_times_better() {
    let days: Vec<Day> = (1..=6).map(|seed| day(&Spec::from_seed(seed), 24.0, SELDOM)).collect();
    let mean = |of: fn(&Day) -> f64| days.iter().map(of).sum::<f64>() / days.len() as f64;
    let [alone, tracked] = [|day: &Day| day.static_dps.powi(2), |day: &Day| day.tracked_dps.powi(2)].map(mean);
    assert!((alone / tracked).sqrt() > 3.0, "{alone} against {tracked}");
    assert!((0.90..0.99).contains(&mean(|day| day.covered)), "{}", mean(|day| day.covered));
    assert!((0.03..0.07).contains(&(mean(|day| day.rest_s) / 86_400.0)));
    assert!(mean(|day| day.learned_s) > 0.7 * mean(|day| day.rest_s));
    assert!(mean(|day| day.turning_learned_s) < 0.05 * mean(|day| day.turning_s));
    assert_eq!(mean(|day| day.moving_learned_s), 0.0);
}

/// Slow rotations fill a quarter or half of the moving time. The seeds are the hardest cases: units whose bias wanders
/// least, so that the calibration alone leaves a small error, or units that met the worst rotations.
#[test]
fn where_slow_rotations_are_frequent_no_unit_gets_worse() {
    for (often, share, seeds) in [(OFTEN, 0.25, [1, 2, 24, 146]), (HALF, 0.5, [11, 22, 25, 79])] {
        let days: Vec<Day> = seeds.map(|seed| day(&Spec::from_seed(seed), 24.0, often)).into();
        let mean = |of: fn(&Day) -> f64| days.iter().map(of).sum::<f64>() / days.len() as f64;
        let turning = mean(|day| day.turning_s) / mean(|day| 86_400.0 - day.rest_s);
        assert!((turning / share - 1.0).abs() < 0.1, "{turning}");
        for (seed, day) in seeds.iter().zip(&days) {
            assert!(day.tracked_dps < 1.02 * day.static_dps, "seed {seed}, {share}: {day:?}");
            assert!(day.covered > 0.85, "seed {seed}, {share}: {day:?}");
        }
        assert!(mean(|day| day.covered) > 0.93, "{share}: {}", mean(|day| day.covered));
        assert!(mean(|day| day.turning_learned_s) < 0.08 * mean(|day| day.turning_s));
        assert_eq!(mean(|day| day.moving_learned_s), 0.0);
    }
}

/// Over 20 hours at rest, noise is taken for motion in less than 2 % of the blocks. docs/tracking.md states the share.
#[test]
fn rest_is_seldom_taken_for_motion() {
    let (mut lost, mut all) = (0u32, 0u32);
    for seed in 1..=10 {
        let mut unit = Unit::calibrated(&Spec::from_seed(seed));
        let mut tracker = Tracker::new(TrackerConfig::of(&Axis::ADIS16130, unit.correction, unit.prior));
        for _ in 0..72_000 {
            let block = unit.next(0.0);
            lost += u32::from(tracker.push(Some(block.rate_dps), Some(block.temp_c), true) != Phase::Rest);
            all += 1;
        }
    }
    let share = f64::from(lost) / f64::from(all);
    assert!(share < 0.02, "{share}");
}

/// A rotation of 0.02 to 0.1 °/s that is steady for ten minutes moves the bias by less than 0.002 °/s.
#[test]
fn a_slow_rotation_is_not_taken_for_bias() {
    for (seed, dps) in (1..=40).zip([0.02, -0.02, 0.03, 0.1].into_iter().cycle()) {
        let (mut tracker, mut random) = (tracker(), Random::new(seed));
        push(&mut tracker, &mut random, 60.0, moving);
        push(&mut tracker, &mut random, 600.0, |_| dps);
        push(&mut tracker, &mut random, 60.0, moving);
        let tracked = tracker.tracked(33.0);
        assert!(tracked.change_dps.abs() < 0.002, "seed {seed}, {dps}: {tracked:?}");
        assert!(tracker.counts().learned_s < 60 && tracker.counts().doubtful_s > 500, "{:?}", tracker.counts());
    }
}

#[test]
fn a_turn_that_begins_at_rest_is_found() {
    let mut rolled_back = 0;
    for seed in 1..=40 {
        let (mut tracker, mut random) = (tracker(), Random::new(seed));
        push(&mut tracker, &mut random, 120.0, |_| 0.0);
        push(&mut tracker, &mut random, 300.0, |_| 0.02);
        let tracked = tracker.tracked(33.0);
        assert!(tracked.change_dps.abs() < 0.004, "seed {seed}: {tracked:?} {:?}", tracker.counts());
        rolled_back += u32::from(tracker.counts().rolled_back > 0);
    }
    // up to 4 of the 40 turns are found by the mean rate of the whole quiet period instead
    assert!(rolled_back >= 36, "{rolled_back}");
}

#[test]
fn motion_is_not_learned_from() {
    let mut sum_dps = 0.0;
    for seed in 1..=20 {
        let (mut tracker, mut random) = (tracker(), Random::new(seed));
        push(&mut tracker, &mut random, 300.0, |t_s| 0.2 * (t_s * 0.7).sin());
        push(&mut tracker, &mut random, 300.0, |t_s| 0.1 * t_s);
        assert_eq!(tracker.counts().learned_s, 0, "seed {seed}");
        push(&mut tracker, &mut random, 60.0, |_| 0.005);
        sum_dps += tracker.tracked(33.0).change_dps;
        push(&mut tracker, &mut random, 1.0, moving);
        assert!(tracker.counts().learned_s >= 40, "seed {seed}: {:?}", tracker.counts());
    }
    // the tracker attributes the other part of the 0.005 °/s to flicker noise
    assert!((0.001..0.004).contains(&(sum_dps / 20.0)), "{sum_dps}");
}

/// Another axis that moves, or a missing reading, ends a rest. A rate without any temperature is ignored.
#[test]
fn missing_samples_are_not_taken_for_rest() {
    let mut random = Random::new(1);
    for (rate_dps, temp_c, still) in [(Some(0.25), Some(33.0), false), (None, None, true)] {
        let mut tracker = tracker();
        push(&mut tracker, &mut random, 60.0, |_| 0.0);
        assert_eq!(tracker.tracked(33.0).phase, Phase::Rest);
        assert_eq!(tracker.push(rate_dps, temp_c, still), Phase::Moving);
        assert!(tracker.counts().learned_s > 30);
    }
    let mut tracker = tracker();
    for _ in 0..600 {
        assert_eq!(tracker.push(Some(0.25), None, true), Phase::Moving);
    }
    let known = tracker.tracked(33.0).u_dps;
    tracker.wait(3600.0);
    let walked = (known * known + 3600.0 * 1e-8).sqrt(); // M-04
    assert!((tracker.tracked(33.0).u_dps / walked - 1.0).abs() < 1e-5);
}

/// Compares bias and state with a golden file after rest, motion, rest at another rate and temperature, a slow turn,
/// and motion again. A gap of 60 s follows each of them.
#[test]
fn a_learned_bias_stays_as_it_is() {
    let mut tracker = tracker();
    let mut known = String::new();
    for (seconds, level_dps, sway_dps, temp_c) in [
        (200, 0.0, 0.0, 33.0),
        (30, 0.0, 5.0, 33.0),
        (100, 0.006, 0.0, 29.0),
        (40, 0.05, 0.0, 30.0),
        (5, 0.0, 5.0, 30.0),
    ] {
        for block in 0..seconds * 10 {
            let noise_dps = f64::from(block * 7_919 % 101 - 50) * 8e-4;
            let sway_dps = if block % 4 < 2 { sway_dps } else { -sway_dps };
            tracker.push(Some(0.25 + level_dps + sway_dps + noise_dps), Some(temp_c), true);
        }
        known += &format!("{:?}\n{:?}\n", tracker.tracked(33.0), tracker.save());
        tracker.wait(60.0);
    }
    crate::golden::unchanged("track.txt", &known);
}

/// A resumed tracker is less certain, by the random walk over the age of the state and by the change of the bias at a
/// power-up. An impossible state is refused.
#[test]
fn a_state_outlives_a_power_down() {
    let (mut before, mut random) = (tracker(), Random::new(5));
    push(&mut before, &mut random, 200.0, |_| 0.004);
    let (saved, config) = (before.save(), TrackerConfig::of(&Axis::ADIS16130, CORRECTION, PRIOR));
    let after = Tracker::resume(config, &saved, 86_400.0).unwrap();
    let (old, new) = (before.tracked(33.0), after.tracked(33.0));
    assert!(after.counts() == before.counts() && after.counts().learned_s > 150, "{:?}", after.counts());
    assert!((old.change_dps - new.change_dps).abs() < 1e-12);
    let aged = (old.u_dps.powi(2) + 86_400.0 * 1e-8 + TrackerConfig::POWER_UP_DPS.powi(2)).sqrt(); // M-04
    assert!((new.u_dps / aged - 1.0).abs() < 1e-5, "{new:?} {aged}");
    let spoilt = |change: fn(&mut Filter)| {
        let mut saved: Saved = saved;
        change(&mut saved.filter);
        Tracker::resume(config, &saved, 0.0).err()
    };
    assert_eq!(spoilt(|_| {}), None);
    assert_eq!(spoilt(|filter| filter.state[0] = f32::NAN), Some(Unsound));
    assert_eq!(spoilt(|filter| filter.covariance[0] = -1e-9), Some(Unsound));
    assert_eq!(spoilt(|filter| filter.covariance[1] = 1.0), Some(Unsound));
    assert_eq!(Tracker::resume(config, &saved, -1.0).err(), Some(Unsound));
}

/// After a week without power, one rest leaves the bias uncertain, and six rests determine it.
#[test]
fn a_bias_that_is_hardly_known_is_learned_by_several_rests() {
    let mut random = Random::new(8);
    let mut tracker = tracker().aged(7.0 * 86_400.0);
    let mut us_dps = Vec::new();
    for _ in 0..6 {
        push(&mut tracker, &mut random, 60.0, |_| 0.06);
        push(&mut tracker, &mut random, 60.0, moving);
        us_dps.push(tracker.tracked(33.0).u_dps);
    }
    let tracked = tracker.tracked(33.0);
    assert!((tracked.change_dps - 0.06).abs() < 2.0 * tracked.u_dps, "{tracked:?} {us_dps:?}");
    assert!(us_dps[0] > 0.02 && us_dps[5] < 0.008, "{us_dps:?}");
}

/// The part rests for two days while the temperature swings by ±20 °C. The covariance, kept in f32, stays valid, and
/// the bias is found at every temperature.
#[test]
fn a_long_rest_keeps_the_covariance_possible() {
    let (mut tracker, mut random) = (tracker(), Random::new(9));
    let beyond_dps = |d_c: f64| 0.003 + 0.0005 * d_c + 0.00002 * d_c * d_c;
    for block in 0..1_728_000 {
        let d_c = 20.0 * (f64::from(block) * BLOCK_S / 7200.0).sin();
        let bias_dps = CORRECTION.apply(0.0, 33.0 + d_c).mul_add(-1.0, beyond_dps(d_c));
        let noise_dps = NOISE_DPS / (2.0 * BLOCK_S).sqrt() * random.normal();
        tracker.push(Some(bias_dps + noise_dps), Some(33.0 + d_c), true);
        if block % 36_000 == 35_999 {
            let saved = tracker.save();
            let config = TrackerConfig::of(&Axis::ADIS16130, CORRECTION, PRIOR);
            assert!(Tracker::resume(config, &saved, 0.0).is_ok(), "{saved:?}");
        }
    }
    for d_c in [-20.0, -10.0, 0.0, 10.0, 20.0] {
        let tracked = tracker.tracked(33.0 + d_c);
        assert!((tracked.change_dps - beyond_dps(d_c)).abs() < 3.0 * tracked.u_dps, "{d_c}: {tracked:?}");
        assert!((0.001..0.02).contains(&tracked.u_dps), "{d_c}: {tracked:?}");
    }
    assert!(tracker.counts().learned_s > 160_000, "{:?}", tracker.counts());
}
