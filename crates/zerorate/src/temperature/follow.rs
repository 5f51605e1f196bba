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
    /// Half width of the play, °C: the temperature may change by this much before the bias follows.
    pub play_c: f64,
}

impl LagAndPlay {
    /// Returns the temperature that the bias follows: for each block with play, and for the last block with and
    /// without play. Both start in balance and in the middle of the play.
    pub(super) fn temps_c(&self, blocks: &[Block]) -> (Vec<f64>, Held) {
        let Some(first) = blocks.first() else { return Default::default() };
        let (mut late_c, mut held_c, mut last) = (first.temp_c, first.temp_c, *first);
        let follow = |block: &Block| {
            late_c = self.late_c(late_c, &last, block);
            held_c = held_c.clamp(late_c - self.play_c, late_c + self.play_c);
            last = *block;
            held_c
        };
        let temps_c = blocks.iter().map(follow).collect();
        (temps_c, Held { at_c: held_c, of_c: late_c })
    }

    /// The solution of lag · late' = T − late with T as a straight line from a block to the next.
    fn late_c(&self, late_c: f64, last: &Block, block: &Block) -> f64 {
        let passed_s = block.middle_s() - last.middle_s();
        if self.lag_s <= 0.0 || passed_s <= 0.0 {
            return block.temp_c;
        }
        let behind_c = (block.temp_c - last.temp_c) / passed_s * self.lag_s;
        let decay = libm::exp(-passed_s / self.lag_s);
        block.temp_c - behind_c + (late_c - last.temp_c + behind_c) * decay
    }
}
