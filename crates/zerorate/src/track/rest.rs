//! The test whether a part is quiet: its rate varies no more than its own noise, over 0.1 s to 64 s.
//!
//! Quiet does not mean at rest, because a steady turn is quiet as well. `mod.rs` judges its level.

use crate::noise::NoiseModel;
use libm::sqrt;

/// Length of the means that are pushed, s.
pub const BLOCK_S: f64 = 0.1;
/// Number of blocks in a second.
const BLOCKS: u32 = 10;
/// Length of a quad, the means that are kept, s.
pub(super) const QUAD_S: u32 = 4;
/// Number of quads that are kept: twice 64 s.
const QUADS: usize = 32;

/// Tests of adjacent means: the number of quads in each, and the ratio of their difference to its standard deviation
/// beyond which noise does not explain it. Noise exceeds these in one of 10 000, 4600 and 2100 differences, which come
/// every 4 s.
const STEPS: [(usize, f64); 3] = [(1, 3.9), (4, 3.7), (16, 3.5)];
/// The same ratio for adjacent seconds, exceeded in one of 16 000.
const SECOND_FACTOR: f64 = 4.0;
/// χ² of nine degrees of freedom that noise exceeds in one of 33 000 seconds: variance of the ten means of 0.1 s.
const SECOND_CHI2: f64 = 36.8;

/// The finding after a block.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Seen {
    /// There is nothing to say yet.
    Open,
    /// Another mean over four quiet seconds is complete: rate and temperature.
    Quad(f64, f64),
    /// The part moves, or a block is missing.
    Moving,
    /// The rate stepped by more than noise explains.
    Step,
}

/// The detector, on fixed memory.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quiet {
    block_dps2: f64,
    second_dps: f64,
    steps_dps: [f64; STEPS.len()],
    blocks: u32,
    /// Sum of squares about the first block of the second, so that nothing is lost by cancellation.
    squares_dps2: f64,
    first_dps: f64,
    shifted_dps: f64,
    temps_c: f64,
    last_second_dps: Option<f64>,
    seconds: u32,
    quad_dps: f64,
    quad_c: f64,
    ring: [f64; QUADS],
    /// Number of quads since the last fresh start.
    filled: u32,
}

impl Quiet {
    pub(super) fn new(noise: &NoiseModel) -> Self {
        let difference = |length_s: f64| sqrt(2.0 * noise.allan_variance(length_s));
        Self {
            block_dps2: noise.white_dps_per_rt_hz * noise.white_dps_per_rt_hz / (2.0 * BLOCK_S),
            second_dps: SECOND_FACTOR * difference(1.0),
            steps_dps: STEPS.map(|(quads, factor)| factor * difference(f64::from(QUAD_S) * quads as f64)),
            blocks: 0,
            squares_dps2: 0.0,
            first_dps: 0.0,
            shifted_dps: 0.0,
            temps_c: 0.0,
            last_second_dps: None,
            seconds: 0,
            quad_dps: 0.0,
            quad_c: 0.0,
            ring: [0.0; QUADS],
            filled: 0,
        }
    }

    /// Takes in the mean of a block, less the calibrated bias. It is none if the block is missing.
    pub(super) fn push(&mut self, rate_dps: Option<f64>, temp_c: f64) -> Seen {
        let Some(rate_dps) = rate_dps.filter(|rate| rate.is_finite() && temp_c.is_finite()) else {
            self.begin_anew();
            return Seen::Moving;
        };
        if self.blocks == 0 {
            (self.first_dps, self.squares_dps2, self.shifted_dps, self.temps_c) = (rate_dps, 0.0, 0.0, 0.0);
        }
        let shifted = rate_dps - self.first_dps;
        self.shifted_dps += shifted;
        self.squares_dps2 += shifted * shifted;
        self.temps_c += temp_c;
        self.blocks += 1;
        if self.blocks < BLOCKS { Seen::Open } else { self.second() }
    }

    /// Starts afresh: everything before belongs to another stretch.
    pub(super) fn begin_anew(&mut self) {
        (self.blocks, self.seconds, self.filled, self.last_second_dps) = (0, 0, 0, None);
    }

    fn second(&mut self) -> Seen {
        let count = f64::from(BLOCKS);
        let (mean_dps, mean_c) = (self.first_dps + self.shifted_dps / count, self.temps_c / count);
        let spread_dps2 = self.squares_dps2 - self.shifted_dps * self.shifted_dps / count;
        self.blocks = 0;
        let jumped = self.last_second_dps.is_some_and(|last| (mean_dps - last).abs() > self.second_dps);
        if jumped || spread_dps2 > SECOND_CHI2 * self.block_dps2 {
            self.begin_anew();
            return Seen::Moving;
        }
        // the first second may hold the end of a motion
        if self.last_second_dps.replace(mean_dps).is_none() {
            return Seen::Open;
        }
        if self.seconds == 0 {
            (self.quad_dps, self.quad_c) = (0.0, 0.0);
        }
        self.quad_dps += mean_dps / f64::from(QUAD_S);
        self.quad_c += mean_c / f64::from(QUAD_S);
        self.seconds += 1;
        if self.seconds < QUAD_S { Seen::Open } else { self.quad() }
    }

    fn quad(&mut self) -> Seen {
        self.seconds = 0;
        self.ring[self.filled as usize % QUADS] = self.quad_dps;
        self.filled = self.filled.saturating_add(1);
        for ((quads, _), most_dps) in STEPS.into_iter().zip(self.steps_dps) {
            if self.filled as usize >= 2 * quads && (self.mean(0, quads) - self.mean(quads, quads)).abs() > most_dps {
                self.begin_anew();
                return Seen::Step;
            }
        }
        Seen::Quad(self.quad_dps, self.quad_c)
    }

    /// Mean of `quads` quads, behind `newer` newer ones.
    fn mean(&self, newer: usize, quads: usize) -> f64 {
        let last = self.filled as usize - 1;
        let sum: f64 = (newer..newer + quads).map(|back| self.ring[(last - back) % QUADS]).sum();
        sum / quads as f64
    }
}
