//! What a measurement leaves behind: exact integer sums of codes in blocks of 0.1 s, one run of blocks for each step.

use crate::code_sum::CodeSum;
use adis16130::Sample;
use alloc::vec::Vec;

/// Length of a block, s. Long against the filter of the part (F-03, F-04), short against everything that drifts.
pub(crate) const BLOCK_S: f64 = 0.1;
const BLOCK_NS: u64 = 100_000_000;

/// Sums over one block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Block {
    rate: CodeSum,
    temp: CodeSum,
}

impl Block {
    fn merged<'a>(blocks: impl IntoIterator<Item = &'a Block>) -> Block {
        let add = |all: Block, block: &Block| Block { rate: all.rate.and(block.rate), temp: all.temp.and(block.temp) };
        blocks.into_iter().fold(Block::default(), add)
    }

    fn rate_dps(&self) -> Option<f64> {
        self.rate.rate_dps()
    }

    fn temp_c(&self) -> Option<f64> {
        self.temp.temp_c()
    }
}

/// The samples of one step of the procedure.
#[derive(Clone, Debug, Default)]
pub(crate) struct Segment {
    start_ns: u64,
    end_ns: u64,
    blocks: Vec<Block>,
    pub(crate) samples: u64,
    pub(crate) lost: u64,
    pub(crate) overranged: u64,
}

/// The mean over a second: when, which rate, which temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Second {
    pub(crate) at_s: f64,
    pub(crate) rate_dps: f64,
    pub(crate) temp_c: f64,
}

impl Segment {
    /// An empty segment over times that count from the start of the procedure.
    pub(crate) fn new(start_ns: u64, end_ns: u64) -> Self {
        Self { start_ns, end_ns, ..Self::default() }
    }

    pub(crate) fn start_s(&self) -> f64 {
        self.start_ns as f64 * 1e-9
    }

    pub(crate) fn end_s(&self) -> f64 {
        self.end_ns as f64 * 1e-9
    }

    #[inline]
    pub(crate) fn push(&mut self, at_ns: u64, sample: &Sample) {
        let index = (at_ns.saturating_sub(self.start_ns) / BLOCK_NS) as usize;
        if index >= self.blocks.len() {
            self.blocks.resize(index + 1, Block::default());
        }
        let block = &mut self.blocks[index];
        block.rate.push(sample.rate.code24());
        if let Some(temp) = sample.temp {
            block.temp.push(temp.code24());
        }
        self.samples += 1;
        self.lost += u64::from(sample.lost);
        self.overranged += u64::from(is_overranged(sample));
    }

    /// Mean rate, °/s: the exact sum of the codes, divided once.
    pub(crate) fn rate_dps(&self) -> Option<f64> {
        Block::merged(&self.blocks).rate_dps()
    }

    /// Mean temperature, °C.
    pub(crate) fn temp_c(&self) -> Option<f64> {
        Block::merged(&self.blocks).temp_c()
    }

    pub(crate) fn temperatures(&self) -> u32 {
        Block::merged(&self.blocks).temp.count()
    }

    /// Mean rates of the blocks that hold samples, °/s.
    pub(crate) fn block_rates_dps(&self) -> Vec<f64> {
        self.blocks.iter().filter_map(Block::rate_dps).collect()
    }

    /// Mean temperatures of the blocks that hold one, °C.
    pub(crate) fn block_temps_c(&self) -> impl Iterator<Item = f64> + '_ {
        self.blocks.iter().filter_map(Block::temp_c)
    }

    /// Change of temperature over the segment, °C/s, from the means of its two halves.
    pub(crate) fn temp_slope_c_per_s(&self) -> f64 {
        let (first, second) = self.blocks.split_at(self.blocks.len() / 2);
        let halves = (Block::merged(first).temp_c(), Block::merged(second).temp_c());
        let half_s = (self.end_s() - self.start_s()) / 2.0;
        if let (Some(first), Some(second)) = halves { (second - first) / half_s } else { 0.0 }
    }

    /// Means over whole seconds; a second without rate or temperature is left out.
    pub(crate) fn seconds(&self) -> impl Iterator<Item = Second> + '_ {
        self.blocks.chunks_exact(10).enumerate().filter_map(|(k, blocks)| {
            let second = Block::merged(blocks);
            let at_s = self.start_s() + k as f64;
            Some(Second { at_s, rate_dps: second.rate_dps()?, temp_c: second.temp_c()? })
        })
    }
}

/// F-35: OVR in the channel status; where no status was read, a code at the rail.
fn is_overranged(sample: &Sample) -> bool {
    sample.status.map_or_else(|| sample.rate.is_at_rail(), |status| status.out_of_range())
}
