//! The temperature that the bias follows, where it is not the one that is measured: late, or with play.

use super::Block;
use alloc::vec::Vec;

/// How the bias follows the temperature sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Following {
    /// Time constant by which the sensing element is late, s.
    pub lag_s: f64,
    /// Half width of the play: the temperature may change by so much before the bias follows, °C.
    pub play_c: f64,
}

impl Following {
    /// The temperature that the bias is at, for each block. Both start in balance and in the middle of the play.
    pub(super) fn temps_c(&self, blocks: &[Block]) -> Vec<f64> {
        let Some(first) = blocks.first() else { return Vec::new() };
        let (mut late_c, mut held_c, mut last) = (first.temp_c, first.temp_c, *first);
        let follow = |block: &Block| {
            late_c = self.late_c(late_c, &last, block);
            held_c = held_c.clamp(late_c - self.play_c, late_c + self.play_c);
            last = *block;
            held_c
        };
        blocks.iter().map(follow).collect()
    }

    /// The solution of lag · late' = T − late where T is a straight line from a block to the next.
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
