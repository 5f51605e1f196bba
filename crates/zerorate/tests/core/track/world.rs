//! A unit of the twin on a robot: an hour of calibration at rest, then motion, with rest for a twentieth of the time.
//!
//! The motions and all other random numbers come from the seed of the unit, too, through generators in this file.

use adis16130_twin::{Means, Spec};
use std::collections::VecDeque;
use std::f64::consts::TAU;
use zerorate::noise::WeightedMean;
use zerorate::track::{BLOCK_S, Prior, Tracker, TrackerConfig};
use zerorate::{Axis, Correction};

/// Random numbers: SplitMix64.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// A uniform random number in [0, 1).
    pub fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Standard normal, by Box and Muller.
    pub fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (TAU * self.uniform()).cos()
    }

    fn sign(&mut self) -> f64 {
        if self.uniform() < 0.5 { -1.0 } else { 1.0 }
    }
}

/// A motion that the platform keeps for seconds to minutes, with its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Motion {
    Rest,
    /// A turn at `dps`, °/s, with ramps of one second at its beginning and end.
    Turn {
        dps: f64,
    },
    Sway {
        dps: f64,
        hz: f64,
    },
    /// A steady, slow rotation: quiet, but not at rest.
    SlowTurn {
        dps: f64,
    },
    /// Shaking while the platform drives straight on. `dps` is the rms of the means over 0.1 s.
    Shaking {
        dps: f64,
    },
}

/// Shortest and longest rest, then shortest and longest time between two rests, s. So 5 % of the time is rest.
const REST_S: (f64, f64) = (15.0, 105.0);
const BETWEEN_S: (f64, f64) = (300.0, 1980.0);

/// Number of slow rotations for 21 motions of other kinds. With this number, they fill a twentieth of the moving time.
pub const SELDOM: f64 = 1.0;
/// Slow rotations fill a quarter of the moving time: one takes 60 s on average, the 21 other motions 1055 s in all.
pub const OFTEN: f64 = 1055.0 / (3.0 * 60.0);
/// Slow rotations fill half of the moving time.
pub const HALF: f64 = 1055.0 / 60.0;

/// A robot or vehicle that rests, turns, sways and drives straight on at random.
pub struct Platform {
    slow_turns: f64,
    random: Random,
    motion: Motion,
    left_s: f64,
    length_s: f64,
    until_rest_s: f64,
}

impl Platform {
    /// A platform that drives straight on at first. `slow_turns` is the number of slow rotations for 21 other motions.
    pub fn new(seed: u64, slow_turns: f64) -> Self {
        let mut random = Random::new(seed ^ 0x7472_6163_6B00_0000);
        let until_rest_s = random.between(BETWEEN_S.0, BETWEEN_S.1);
        Self { slow_turns, random, motion: Motion::Shaking { dps: 0.5 }, left_s: 10.0, length_s: 10.0, until_rest_s }
    }

    /// The next 0.1 s: the motion and the mean rate, °/s.
    pub fn step(&mut self) -> (Motion, f64) {
        if self.left_s <= 0.0 {
            self.go_on();
        }
        self.left_s -= BLOCK_S;
        let (since_s, motion) = (self.length_s - self.left_s, self.motion);
        let dps = match motion {
            Motion::Rest => 0.0,
            Motion::Turn { dps } => dps * since_s.min(self.left_s + BLOCK_S).min(1.0),
            Motion::Sway { dps, hz } => dps * (TAU * hz * since_s).sin(),
            Motion::SlowTurn { dps } => dps,
            Motion::Shaking { dps } => dps * self.random.normal(),
        };
        (motion, dps)
    }

    fn go_on(&mut self) {
        let random = &mut self.random;
        if self.until_rest_s <= 0.0 && self.motion != Motion::Rest {
            (self.motion, self.length_s) = (Motion::Rest, random.between(REST_S.0, REST_S.1));
            self.until_rest_s = random.between(BETWEEN_S.0, BETWEEN_S.1);
        } else {
            let (motion, length_s) = match random.uniform() * (21.0 + self.slow_turns) {
                ..10.0 => {
                    let dps = random.sign() * random.between(5.0, 90.0);
                    (Motion::Turn { dps }, random.between(2.0, 10.0))
                }
                ..14.0 => {
                    let (dps, hz) = (random.between(0.1, 5.0), random.between(0.05, 2.0));
                    (Motion::Sway { dps, hz }, random.between(10.0, 120.0))
                }
                // a slow rotation lasts as long as a rest, and every fourth has the slowest rate that must be detected
                kind if kind < 14.0 + self.slow_turns => {
                    let dps = if random.uniform() < 0.25 { 0.02 } else { random.between(0.02, 0.2) };
                    (Motion::SlowTurn { dps: random.sign() * dps }, random.between(REST_S.0, REST_S.1))
                }
                _ => (Motion::Shaking { dps: random.between(0.1, 2.0) }, random.between(10.0, 200.0)),
            };
            (self.motion, self.length_s) = (motion, length_s);
            self.until_rest_s -= length_s;
        }
        self.left_s = self.length_s;
    }
}

/// A unit that was calibrated by AN-1042, with the uncertainties that the calibration states.
pub struct Unit {
    means: Means,
    gain: f64,
    pub correction: Correction,
    pub prior: Prior,
}

/// The readings of a unit in a block of 0.1 s, and its true bias.
#[derive(Clone, Copy, Debug)]
pub struct Block {
    pub rate_dps: f64,
    pub temp_c: f64,
    /// Slow part of the true bias at the end of the block, °/s.
    pub bias_dps: f64,
}

impl Unit {
    /// Switches a unit on, and calibrates it by F-51 in 53 minutes.
    pub fn calibrated(spec: &Spec) -> Self {
        let mut unit = Self {
            means: Means::new(spec, 1),
            gain: 1.0 + spec.sensitivity_error,
            correction: Correction::line(0.0, 0.0, 25.0),
            prior: Prior::default(),
        };
        let (b1, t1) = unit.average(10.0);
        unit.average(600.0);
        let (b2, t2) = unit.average(10.0);
        unit.average(2400.0);
        let (b3, mean_c) = unit.average(150.0);
        let (_, t3_c) = unit.average(1.0);
        let btc_dps_per_c = -(b2 - b1) / (t2 - t1);
        unit.correction = Correction::line(-b3, btc_dps_per_c, t3_c);
        unit.prior = stated([t1, t2, t3_c], btc_dps_per_c * (t3_c - mean_c));
        unit
    }

    fn average(&mut self, seconds: f64) -> (f64, f64) {
        let count = (seconds / BLOCK_S).round();
        let (mut rate, mut temp) = (0.0, 0.0);
        for _ in 0..count as u32 {
            let mean = self.means.next_mean();
            (rate, temp) = (rate + mean.rate_dps, temp + mean.temp_c);
        }
        (rate / count, temp / count)
    }

    /// Reads the next block while the platform turns at `motion_dps`.
    pub fn next(&mut self, motion_dps: f64) -> Block {
        let mean = self.means.next_mean();
        let truth = self.means.truth();
        let bias_dps = truth.bias_dps(truth.sensor_c);
        Block { rate_dps: mean.rate_dps + self.gain * motion_dps, temp_c: mean.temp_c, bias_dps }
    }
}

/// The uncertainties that a measurement by F-51 states, from the typical noise, curvature and hysteresis.
fn stated([t1_c, t2_c, t3_c]: [f64; 3], drift_dps: f64) -> Prior {
    let axis = Axis::ADIS16130;
    let (noise, bias) = (axis.typical_noise(), axis.bias);
    let window = |start_s, end_s, weight| WeightedMean { start_s, end_s, weight };
    let change = [window(0.0, 10.0, -1.0), window(610.0, 620.0, 1.0)];
    let level = noise.without_random_walk().sd(&[window(0.0, 150.0, 1.0)]);
    // from the mean of step 8 to its end
    let walk = noise.rate_random_walk_dps_per_rt_s * (150.0_f64 / 3.0).sqrt();
    let (curvature, hysteresis) = (bias.curvature_dps_per_c2.unwrap(), bias.hysteresis_dps.unwrap());
    let span_c = t2_c - t1_c;
    let parts =
        [noise.sd(&change) / span_c, curvature * (t1_c + t2_c - 2.0 * t3_c), 2.0 * hysteresis / 3f64.sqrt() / span_c];
    Prior {
        u_pbc_dps: level.hypot(walk).hypot(drift_dps),
        u_btc_dps_per_c: parts.iter().fold(0.0, |sum: f64, part| sum.hypot(*part)),
        cov_pbc_btc_dps2_per_c: 0.0,
        u_curvature_dps_per_c2: curvature,
    }
}

/// The errors of calibration and tracker over some hours of motion and rest.
#[derive(Clone, Copy, Debug, Default)]
pub struct Day {
    /// Rms of the bias that the calibration alone leaves, °/s.
    pub static_dps: f64,
    /// Rms of the bias that the tracker leaves, °/s.
    pub tracked_dps: f64,
    /// Share of the time in which the true bias was within 1.96 u of the tracked bias.
    pub covered: f64,
    /// Whether the true bias was within 1.96 u of the tracked bias at the end.
    pub covered_at_end: bool,
    pub rest_s: f64,
    /// Seconds that were learned as rest, and were rest.
    pub learned_s: f64,
    /// Seconds that were learned as rest, but were a slow turn. `moving_learned_s` counts those of other motions.
    pub turning_learned_s: f64,
    pub moving_learned_s: f64,
    pub turning_s: f64,
}

pub fn day(spec: &Spec, hours: f64, slow_turns: f64) -> Day {
    let mut unit = Unit::calibrated(spec);
    let mut tracker = Tracker::new(TrackerConfig::of(&Axis::ADIS16130, unit.correction, unit.prior));
    let mut platform = Platform::new(spec.seed, slow_turns);
    let blocks = (hours * 3600.0 / BLOCK_S) as u64;
    // learning counts for the motion 10 s before, because a mean is learned when it is over
    let mut past = VecDeque::from(vec![Motion::Rest; 100]);
    let (mut day, mut learned_s, mut covered) = (Day::default(), 0.0, 0u64);
    for _ in 0..blocks {
        let (motion, dps) = platform.step();
        past.push_back(motion);
        let block = unit.next(dps);
        tracker.push(Some(block.rate_dps), Some(block.temp_c), true);
        let tracked = tracker.tracked(block.temp_c);
        let left_dps = block.bias_dps + unit.correction.apply(0.0, block.temp_c);
        let error_dps = left_dps - tracked.change_dps;
        day.static_dps += left_dps * left_dps / blocks as f64;
        day.tracked_dps += error_dps * error_dps / blocks as f64;
        day.covered_at_end = error_dps.abs() < 1.96 * tracked.u_dps;
        covered += u64::from(day.covered_at_end);
        // a quiet period that turns out to be doubtful lowers the learned time again
        let more_s = f64::from(tracker.counts().learned_s) - learned_s;
        learned_s += more_s;
        match past.pop_front() {
            Some(Motion::Rest) => day.learned_s += more_s,
            Some(Motion::SlowTurn { .. }) => day.turning_learned_s += more_s,
            _ => day.moving_learned_s += more_s,
        }
        day.rest_s += if motion == Motion::Rest { BLOCK_S } else { 0.0 };
        day.turning_s += if matches!(motion, Motion::SlowTurn { .. }) { BLOCK_S } else { 0.0 };
    }
    day.covered = covered as f64 / blocks as f64;
    (day.static_dps, day.tracked_dps) = (day.static_dps.sqrt(), day.tracked_dps.sqrt());
    day
}
