//! The temperature that the bias follows, where it is not the one that is measured: late, or with play.

use super::Block;
use alloc::vec::Vec;

/// Where the bias is held by the play, and where it would be without.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Held {
    pub(super) at_c: f64,
    pub(super) of_c: f64,
}

/// How the bias follows the temperature sensor.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Following {
    /// Time constant by which the sensing element is late, s.
    pub lag_s: f64,
    /// Half width of the play: the temperature may change by so much before the bias follows, °C.
    pub play_c: f64,
}

impl Following {
    /// The temperature that the bias is at, for each block, and at the end how far the play holds it from that of the
    /// sensing element. Both start in balance and in the middle of the play.
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
