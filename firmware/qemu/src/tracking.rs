//! The series of 0.1 s means that the controller and the host both track from a seed. The part rests, rotates slowly,
//! moves, rests again, gives no rates for a second, and rests. Then it has no power for a day.
//!
//! The host includes this file too (`lab/src/firmware/`).

use zerorate::track::{BLOCK_S, Counts, Prior, Tracked, Tracker, TrackerConfig};
use zerorate::{Axis, Correction};

const CORRECTION: Correction = Correction::line(-0.25, -0.04, 26.0);

/// The bias that `CORRECTION` leaves, °/s.
const CHANGE_DPS: f64 = 0.004;

/// White noise of a mean of 0.1 s, °/s (1 σ): 0.0125 °/s/√Hz (F-02) times √5.
const WHITE_DPS: f64 = 0.028;

/// The periods of the series: number of means, and rate of rotation, °/s. `None` if there are no mean rates. The first
/// rest is longer than the tracker's longest test, 128 s. All periods are whole seconds, as in the tracker.
const STRETCHES: [(u32, Option<f64>); 6] =
    [(1_600, Some(0.0)), (600, Some(0.03)), (20, Some(5.0)), (400, Some(0.0)), (10, None), (300, Some(0.0))];

const OFF_S: f64 = 86_400.0;

/// The tracker's knowledge after a mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TrackerState {
    /// The bits of the bias beyond the correction, an f64 in °/s.
    pub change_bits: u64,
    /// The bits of the standard uncertainty of that bias, an f64 in °/s.
    pub u_bits: u64,
    /// The motion of the part, a [`Phase`](zerorate::track::Phase) as a number.
    pub phase: u8,
}

/// A mean over [`BLOCK_S`].
#[derive(Clone, Copy, Debug)]
pub struct Mean {
    /// The mean rate, °/s. `None` if it is missing.
    pub rate_dps: Option<f64>,
    /// The mean temperature, °C.
    pub temp_c: f64,
}

/// The means of the series. The seed determines their noise.
pub fn means(seed: u64) -> impl Iterator<Item = Mean> {
    let turns = STRETCHES.into_iter().flat_map(|(count, turn_dps)| (0..count).map(move |_| turn_dps));
    let mut state = seed;
    turns.enumerate().map(move |(index, turn_dps)| {
        // the part warms by 0.6 °C a minute
        let temp_c = 27.0 + 0.01 * BLOCK_S * index as f64;
        let bias_dps = 0.25 + 0.04 * (temp_c - CORRECTION.t3_c) + CHANGE_DPS;
        let noise_dps = WHITE_DPS * normal(&mut state);
        Mean { rate_dps: turn_dps.map(|turn_dps| bias_dps + turn_dps + noise_dps), temp_c }
    })
}

/// A tracker that has seen nothing yet.
pub fn tracker() -> Tracker {
    Tracker::new(config()).aged(0.0)
}

/// Tracks the series of a seed. Calls `take` with the knowledge after each mean, and finally after the time without
/// power. Returns `None` if the tracker refuses its saved state.
pub fn run(seed: u64, mut take: impl FnMut(TrackerState)) -> Option<Counts> {
    let mut tracker = tracker();
    let mut last_c = CORRECTION.t3_c;
    for Mean { rate_dps, temp_c } in means(seed) {
        tracker.push(rate_dps, Some(temp_c), true);
        take(known(&tracker, temp_c));
        last_c = temp_c;
    }
    let resumed = Tracker::resume(config(), &tracker.save(), OFF_S).ok()?;
    take(known(&resumed, last_c));
    Some(tracker.counts())
}

fn known(tracker: &Tracker, temp_c: f64) -> TrackerState {
    let Tracked { change_dps, u_dps, phase } = tracker.tracked(temp_c);
    TrackerState { change_bits: change_dps.to_bits(), u_bits: u_dps.to_bits(), phase: phase as u8 }
}

fn config() -> TrackerConfig {
    let prior = Prior {
        u_pbc_dps: 0.003,
        u_btc_dps_per_c: 0.003,
        cov_pbc_btc_dps2_per_c: 0.0,
        u_curvature_dps_per_c2: 0.0005, // M-02
    };
    TrackerConfig::of(&Axis::ADIS16130, CORRECTION, prior)
}

/// A number that is almost normal (its tails end at 6 σ): a sum of twelve numbers of SplitMix64, exact on any machine.
fn normal(state: &mut u64) -> f64 {
    let mut uniform = || {
        *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mixed = (*state ^ (*state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        let mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (mixed ^ (mixed >> 31)) >> 48
    };
    let sum: u64 = (0..12).map(|_| uniform()).sum();
    (sum as f64 - 6.0 * 65_535.0) / 65_536.0
}
