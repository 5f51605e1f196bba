//! The record of a measurement: exact integer sums of codes in blocks of 0.1 s, with a list of blocks for each step.

use super::window_sums::{Summary, WindowSums};
use crate::health::block_means::{Adjacent, BLOCK_NS, BLOCK_S, adjacent};
use crate::health::stationarity::{self, Verdict};
use crate::health::{Flags, Judged};
use crate::part::{Axis, CodeSum};
use crate::plan::{STATES, State};
use crate::temperature;
use alloc::vec::Vec;

/// Window sums that keep every block of 0.1 s: about a megabyte for the hour of F-51.
#[derive(Clone, Debug)]
pub struct Blocks {
    axis: Axis,
    segments: [Segment; STATES],
}

impl Blocks {
    /// Means over the whole seconds of all steps, in the order of time.
    pub(crate) fn seconds(&self) -> impl Iterator<Item = Second> + '_ {
        self.segments.iter().flat_map(|segment| segment.seconds(&self.axis))
    }

    /// Rate, °/s, and temperature, °C, of every block of a step. NaN for a value that the block lacks.
    #[cfg(feature = "std")]
    pub(crate) fn tenths(&self, state: State) -> impl Iterator<Item = (f64, f64)> + '_ {
        let or_none = |value: Option<f64>| value.unwrap_or(f64::NAN);
        let blocks = self.segments[state as usize].blocks.iter();
        blocks.map(move |block| (or_none(block.rate_dps(&self.axis)), or_none(block.temp_c(&self.axis))))
    }

    /// Returns `Summary::eighths` of a step after a disturbance was removed from the rate: `less` gives the mean
    /// of the disturbance between two times.
    pub(crate) fn eighths_less(&self, state: State, less: impl Fn(f64, f64) -> f64) -> Adjacent {
        let segment = &self.segments[state as usize];
        let start_s = |k: usize| segment.start_s() + k as f64 * BLOCK_S;
        let left = |(k, block): (usize, &Block)| Some(block.rate_dps(&self.axis)? - less(start_s(k), start_s(k + 1)));
        eighths(&segment.blocks.iter().enumerate().filter_map(left).collect::<Vec<f64>>())
    }
}

impl WindowSums for Blocks {
    fn new(axis: &Axis) -> Self {
        Self { axis: *axis, segments: Default::default() }
    }

    fn open(&mut self, state: State, start_ns: u64, end_ns: u64) {
        self.segments[state as usize] = Segment::new(start_ns, end_ns);
    }

    #[inline]
    fn push(&mut self, state: State, at_ns: u64, judged: &Judged) {
        self.segments[state as usize].push(at_ns, judged);
    }

    fn close(&mut self, state: State, end_ns: u64) {
        self.segments[state as usize].end_ns = end_ns;
    }

    fn summary(&self, state: State) -> Summary {
        self.segments[state as usize].summary(&self.axis)
    }

    fn verdict(&self, state: State) -> Verdict {
        let segment = &self.segments[state as usize];
        match state {
            State::Recording => segment.verdict_of_stretches(&self.axis),
            _ => {
                let (rates_dps, slope) = (segment.block_rates_dps(&self.axis), segment.temp_slope_c_per_s(&self.axis));
                stationarity::judge(&self.axis, &rates_dps, slope)
            }
        }
    }
}

/// Sums of the codes of one axis over a block of 0.1 s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Block {
    rate: CodeSum,
    temp: CodeSum,
}

impl Block {
    #[inline]
    pub(crate) fn push(&mut self, judged: &Judged) {
        if let Some(rate) = judged.rate() {
            self.rate.push(rate);
        }
        if let Some(temp) = judged.temp() {
            self.temp.push(temp);
        }
    }

    pub(crate) fn merged<'a>(blocks: impl IntoIterator<Item = &'a Block>) -> Block {
        let add = |all: Block, block: &Block| Block { rate: all.rate.and(block.rate), temp: all.temp.and(block.temp) };
        blocks.into_iter().fold(Block::default(), add)
    }

    pub(crate) fn rate_dps(&self, axis: &Axis) -> Option<f64> {
        self.rate.mean(&axis.rate)
    }

    pub(crate) fn temp_c(&self, axis: &Axis) -> Option<f64> {
        self.temp.mean(&axis.temp)
    }
}

fn eighths(rates_dps: &[f64]) -> Adjacent {
    adjacent(rates_dps, (rates_dps.len() / 8).max(1))
}

/// Number of blocks in each window in which rest is judged: 150 s.
const STRETCH_BLOCKS: usize = 1500;

/// The blocks of one step of the procedure, and counts of its samples.
#[derive(Clone, Debug, Default)]
struct Segment {
    start_ns: u64,
    end_ns: u64,
    blocks: Vec<Block>,
    samples: u64,
    lost: u64,
    overranged: u64,
    faulty: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Second {
    pub(crate) at_s: f64,
    pub(crate) rate_dps: f64,
    pub(crate) temp_c: f64,
}

impl Segment {
    /// The times count from the start of the procedure.
    fn new(start_ns: u64, end_ns: u64) -> Self {
        Self { start_ns, end_ns, ..Self::default() }
    }

    fn start_s(&self) -> f64 {
        self.start_ns as f64 * 1e-9
    }

    fn end_s(&self) -> f64 {
        self.end_ns as f64 * 1e-9
    }

    #[inline]
    fn push(&mut self, at_ns: u64, judged: &Judged) {
        let index = (at_ns.saturating_sub(self.start_ns) / BLOCK_NS) as usize;
        if index >= self.blocks.len() {
            self.blocks.resize(index + 1, Block::default());
        }
        self.blocks[index].push(judged);
        self.samples += 1;
        self.lost += u64::from(judged.reading.lost);
        self.overranged += u64::from(judged.flags.has(Flags::OUT_OF_RANGE));
        self.faulty += u64::from(judged.is_faulty());
    }

    fn summary(&self, axis: &Axis) -> Summary {
        let all = Block::merged(&self.blocks);
        let (rates, temps) = (self.block_rates_dps(axis), self.block_temps_c(axis));
        let range = |(low, high): (f64, f64), temp: &f64| (low.min(*temp), high.max(*temp));
        Summary {
            start_s: self.start_s(),
            end_s: self.end_s(),
            samples: self.samples,
            lost: self.lost,
            overranged: self.overranged,
            faulty: self.faulty,
            rate_dps: all.rate_dps(axis),
            temp_c: all.temp_c(axis),
            eighths: eighths(&rates),
            rates: adjacent(&rates, 1),
            temp_range_c: temps.iter().fold((f64::INFINITY, f64::NEG_INFINITY), range),
            temps: adjacent(&temps, 1),
        }
    }

    /// Judges rest in windows as long as the longest average of F-51, without the part of the rate that follows
    /// the temperature. A part may warm much faster at the start than during any of the averages.
    fn verdict_of_stretches(&self, axis: &Axis) -> Verdict {
        let judged = self.blocks.chunks(STRETCH_BLOCKS).map(|blocks| {
            let block = |block: &Block| {
                let (rate_dps, temp_c) = (block.rate_dps(axis)?, block.temp_c(axis)?);
                Some(temperature::Block { start_s: 0.0, length_s: BLOCK_S, rate_dps, temp_c })
            };
            let blocks: Vec<temperature::Block> = blocks.iter().filter_map(block).collect();
            stationarity::judge_without_temperature(axis, &blocks)
        });
        let moves = |verdict: &Verdict| matches!(verdict, Verdict::Moving { .. } | Verdict::Noisy { .. });
        judged.into_iter().find(moves).unwrap_or(Verdict::AtRest)
    }

    fn block_rates_dps(&self, axis: &Axis) -> Vec<f64> {
        self.blocks.iter().filter_map(|block| block.rate_dps(axis)).collect()
    }

    fn block_temps_c(&self, axis: &Axis) -> Vec<f64> {
        self.blocks.iter().filter_map(|block| block.temp_c(axis)).collect()
    }

    /// Change of temperature over the segment, °C/s, from the means of its two halves.
    fn temp_slope_c_per_s(&self, axis: &Axis) -> f64 {
        let (first, second) = self.blocks.split_at(self.blocks.len() / 2);
        let halves = (Block::merged(first).temp_c(axis), Block::merged(second).temp_c(axis));
        let half_s = (self.end_s() - self.start_s()) / 2.0;
        if let (Some(first), Some(second)) = halves { (second - first) / half_s } else { 0.0 }
    }

    /// Means over whole seconds. A second without rate or temperature is left out.
    fn seconds<'a>(&'a self, axis: &'a Axis) -> impl Iterator<Item = Second> + 'a {
        self.blocks.chunks_exact(10).enumerate().filter_map(move |(k, blocks)| {
            let second = Block::merged(blocks);
            let at_s = self.start_s() + k as f64;
            Some(Second { at_s, rate_dps: second.rate_dps(axis)?, temp_c: second.temp_c(axis)? })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::procedure::window_sums::tests::{RISE_C_PER_S, rising};

    #[test]
    fn the_slope_is_the_change_of_temperature_over_the_time() {
        let axis = Axis::ADIS16130;
        let sums: Blocks = rising(&axis, State::Offset);
        let slope_c_per_s = sums.segments[State::Offset as usize].temp_slope_c_per_s(&axis);
        assert!((slope_c_per_s - RISE_C_PER_S).abs() < 1e-3, "{slope_c_per_s}");
    }
}
