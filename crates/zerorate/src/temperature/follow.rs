//! The temperature that the bias follows: the measured one, after a lag and a play.

use super::Block;
use alloc::vec::Vec;

/// The temperature that the bias follows at the last block, °C: `at_c` with play, `of_c` without play.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Held {
    pub(super) at_c: f64,
    pub(super) of_c: f64,
}

/// The way in which the bias follows the temperature sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LagAndPlay {
    /// Time constant of the lag of the sensing element, s.
    pub lag_s: f64,
    /// Half width of the play, °C: from the middle, the temperature may change by this much before the bias follows.
    pub play_c: f64,
}

impl LagAndPlay {
    /// Returns the temperature that the bias follows: for each block with play, and for the last block with and
    /// without play. Both start in balance and in the middle of the play.
    pub(super) fn temps_c(&self, blocks: &[Block]) -> (Vec<f64>, Held) {
        let Some(first) = blocks.first() else { return Default::default() };
        let mut followed = FollowedTemperature::new(*self, first.middle_s(), first.temp_c);
        let temps_c = blocks.iter().map(|block| followed.push(block.middle_s(), block.temp_c)).collect();
        (temps_c, Held { at_c: followed.held_c, of_c: followed.late_c })
    }
}

/// The temperature that the bias follows, from the temperatures that are read one after another.
#[derive(Clone, Copy, Debug)]
pub struct FollowedTemperature {
    following: LagAndPlay,
    late_c: f64,
    held_c: f64,
    last_s: f64,
    last_c: f64,
}

impl FollowedTemperature {
    /// Starts in balance with the first temperature, and in the middle of the play.
    #[must_use]
    pub fn new(following: LagAndPlay, at_s: f64, temp_c: f64) -> Self {
        Self { following, late_c: temp_c, held_c: temp_c, last_s: at_s, last_c: temp_c }
    }

    /// Takes the temperature at a time, s and °C, and returns the one that the bias follows, °C.
    pub fn push(&mut self, at_s: f64, temp_c: f64) -> f64 {
        self.late_c = self.late_c_at(at_s, temp_c);
        let play_c = self.following.play_c;
        self.held_c = self.held_c.clamp(self.late_c - play_c, self.late_c + play_c);
        (self.last_s, self.last_c) = (at_s, temp_c);
        self.held_c
    }

    /// The solution of lag · late' = T − late with T as a straight line since the last temperature.
    fn late_c_at(&self, at_s: f64, temp_c: f64) -> f64 {
        let (passed_s, lag_s) = (at_s - self.last_s, self.following.lag_s);
        if lag_s <= 0.0 || passed_s <= 0.0 {
            return temp_c;
        }
        let behind_c = (temp_c - self.last_c) / passed_s * lag_s;
        let decay = libm::exp(-passed_s / lag_s);
        temp_c - behind_c + (self.late_c - self.last_c + behind_c) * decay
    }
}
