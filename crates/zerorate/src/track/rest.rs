//! The test whether a part is quiet: its rate varies no more than its own noise, over 0.1 s to 64 s.
//!
//! Quiet does not mean at rest, because a steady rotation is quiet as well. `level.rs` judges the level of the rate.

use super::hypothesis_bank::Mean;
use crate::noise::NoiseModel;
use libm::sqrt;

/// Length of the means that a tracker takes in, s.
pub const BLOCK_S: f64 = 0.1;
pub(super) const BLOCKS_PER_S: u32 = 10;
/// Length of a window, whose mean is kept, s.
pub(super) const WINDOW_S: u32 = 4;
/// Number of windows that are kept: 32 for the longest test of [`STEPS`], and 32 that `mod.rs` may not have used yet.
const WINDOWS: usize = 64;
/// Largest number of windows until a change of the rate is found.
pub(super) const MOST_LATE: u32 = 32;

/// Tests of adjacent means: the number of windows in each, and the ratio of their difference to its standard deviation
/// beyond which noise does not explain it. Noise exceeds these in one of 10 000, 4600 and 2100 differences, which come
/// every 4 s.
const STEPS: [(u32, f64); 3] = [(1, 3.9), (4, 3.7), (16, 3.5)];
/// Ratio of the difference of adjacent seconds to its standard deviation beyond which the part moves. Noise exceeds it
/// in one of 16 000 differences.
const SECOND_FACTOR: f64 = 4.0;
/// Limit of χ², nine degrees of freedom, for the ten means of 0.1 s. Noise exceeds it in one of 35 000 seconds.
const SECOND_CHI2: f32 = 36.8;
/// Largest valid rate, °/s, and distance of the temperature from T3, °C.
const LARGEST: f32 = 1e5;

/// The result after a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Seen {
    /// There is no result yet.
    Open,
    /// Another mean over four quiet seconds is complete.
    Window,
    /// The part moves, or a block is missing.
    Moving,
    /// The rate stepped by more than noise explains, within this number of the newest windows.
    Step(u32),
}

/// Detects quiet periods, on fixed memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quiet {
    block_dps2: f32,
    second_dps: f32,
    steps_dps: [f32; STEPS.len()],
    blocks: u32,
    /// Sum of squares about the first block of the second, so that nothing is lost by cancellation.
    squares_dps2: f32,
    first_dps: f32,
    shifted_dps: f32,
    temps_c: f32,
    last_second_dps: Option<f32>,
    seconds: u32,
    window_dps: f32,
    window_c: f32,
    /// Rate, °/s, and T − T3, °C, of each of the newest windows.
    ring: [(f32, f32); WINDOWS],
    /// Number of windows since the present quiet period began.
    filled: u32,
}

impl Quiet {
    pub(super) fn new(noise: &NoiseModel) -> Self {
        let difference = |length_s: f64| sqrt(2.0 * noise.allan_variance(length_s));
        let white = noise.white_dps_per_rt_hz;
        Self {
            block_dps2: (white * white / (2.0 * BLOCK_S)) as f32,
            second_dps: (SECOND_FACTOR * difference(1.0)) as f32,
            steps_dps: STEPS
                .map(|(windows, factor)| (factor * difference(f64::from(WINDOW_S) * f64::from(windows))) as f32),
            blocks: 0,
            squares_dps2: 0.0,
            first_dps: 0.0,
            shifted_dps: 0.0,
            temps_c: 0.0,
            last_second_dps: None,
            seconds: 0,
            window_dps: 0.0,
            window_c: 0.0,
            ring: [(0.0, 0.0); WINDOWS],
            filled: 0,
        }
    }

    /// Takes in the mean of a block, less the calibrated bias. `None` means that the block is missing. After a motion,
    /// the caller must call [`Quiet::begin_anew`].
    pub(super) fn push(&mut self, rate_dps: Option<f32>, d_c: f32) -> Seen {
        let Some(rate_dps) = rate_dps.filter(|rate| rate.abs() < LARGEST && d_c.abs() < LARGEST) else {
            return Seen::Moving;
        };
        if self.blocks == 0 {
            (self.first_dps, self.squares_dps2, self.shifted_dps, self.temps_c) = (rate_dps, 0.0, 0.0, 0.0);
        }
        let shifted = rate_dps - self.first_dps;
        self.shifted_dps += shifted;
        self.squares_dps2 += shifted * shifted;
        self.temps_c += d_c;
        self.blocks += 1;
        if self.blocks < BLOCKS_PER_S { Seen::Open } else { self.second() }
    }

    /// Begins another quiet period, in which no earlier block counts.
    pub(super) fn begin_anew(&mut self) {
        (self.blocks, self.seconds, self.filled, self.last_second_dps) = (0, 0, 0, None);
    }

    /// Begins another quiet period with the next window. The part is as quiet as before.
    pub(super) fn begin_stretch(&mut self) {
        self.filled = 0;
    }

    fn second(&mut self) -> Seen {
        let count = BLOCKS_PER_S as f32;
        let (mean_dps, mean_c) = (self.first_dps + self.shifted_dps / count, self.temps_c / count);
        let spread_dps2 = self.squares_dps2 - self.shifted_dps * self.shifted_dps / count;
        self.blocks = 0;
        let jumped = self.last_second_dps.is_some_and(|last| (mean_dps - last).abs() > self.second_dps);
        if jumped || spread_dps2 > SECOND_CHI2 * self.block_dps2 {
            return Seen::Moving;
        }
        // the first second may hold the end of a motion
        if self.last_second_dps.replace(mean_dps).is_none() {
            return Seen::Open;
        }
        if self.seconds == 0 {
            (self.window_dps, self.window_c) = (0.0, 0.0);
        }
        self.window_dps += mean_dps / WINDOW_S as f32;
        self.window_c += mean_c / WINDOW_S as f32;
        self.seconds += 1;
        if self.seconds < WINDOW_S { Seen::Open } else { self.window() }
    }

    fn window(&mut self) -> Seen {
        self.seconds = 0;
        self.ring[self.filled as usize % WINDOWS] = (self.window_dps, self.window_c);
        self.filled = self.filled.saturating_add(1);
        for ((windows, _), most_dps) in STEPS.into_iter().zip(self.steps_dps) {
            let mean_dps = |newer| self.mean(newer, windows).rate_dps;
            if self.filled >= 2 * windows && (mean_dps(0) - mean_dps(windows)).abs() > most_dps {
                return Seen::Step(2 * windows);
            }
        }
        Seen::Window
    }

    pub(super) fn windows(&self) -> u32 {
        self.filled
    }

    /// Mean of `windows` windows before the `newer` newest ones. All of them must be among the last [`WINDOWS`].
    pub(super) fn mean(&self, newer: u32, windows: u32) -> Mean {
        let end = self.filled.wrapping_sub(newer);
        let place = |back: u32| self.ring[end.wrapping_sub(back) as usize % WINDOWS];
        let sums = (1..=windows).map(place).fold((0.0, 0.0), |(a, b), (rate_dps, d_c)| (a + rate_dps, b + d_c));
        let count = windows as f32;
        Mean { rate_dps: sums.0 / count, d_c: sums.1 / count, length_s: count * WINDOW_S as f32 }
    }
}
