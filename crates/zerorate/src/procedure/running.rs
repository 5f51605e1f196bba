//! Window sums in fixed memory, with running Allan variances instead of blocks.

use super::window_sums::{Summary, WindowSums};
use crate::health::block_means::{Adjacent, BLOCK_NS};
use crate::health::stationarity::{self, Verdict};
use crate::health::{Flags, Judged};
use crate::part::{Axis, CodeSum};
use crate::plan::{STATES, State};

/// Number of averaging times of the test for rest: 2, 4, … 2¹⁴ blocks. A window longer than 1.8 h is not tested at
/// longer times.
const RUNGS: usize = 14;

/// Window sums of about 3 KB that never grow.
///
/// Means and refusals agree with [`Blocks`](super::blocks::Blocks), with one exception. A single small step of the
/// rate in a window is refused as motion, because only all blocks together tell a step from motion.
#[derive(Clone, Debug)]
pub struct Running {
    axis: Axis,
    closed: [Totals; STATES],
    live: Live,
}

/// Sums over a step that is over, or over the present one so far.
#[derive(Clone, Copy, Debug, Default)]
struct Totals {
    start_ns: u64,
    end_ns: u64,
    samples: u64,
    lost: u64,
    overranged: u64,
    faulty: u64,
    rate: CodeSum,
    temp: CodeSum,
    rates: Adjacent,
    temps: Adjacent,
    eighths: Adjacent,
    temp_range_c: Option<(f64, f64)>,
}

/// Sums of the present block, and running averages over the present step.
#[derive(Clone, Debug, Default)]
struct Live {
    block: u64,
    rate: CodeSum,
    temp: CodeSum,
    /// Sum of the temperatures up to the middle of the step.
    first_half: CodeSum,
    rates: Averages,
    temps: Averages,
    eighths: Averages,
    rungs: [Averages; RUNGS],
}

/// Non-overlapping averages of `m` values and the squares of their differences.
#[derive(Clone, Copy, Debug, Default)]
struct Averages {
    m: usize,
    sum: f64,
    in_sum: usize,
    last: f64,
    count: usize,
    squares: f64,
}

impl Averages {
    fn of(m: usize) -> Self {
        Self { m, ..Self::default() }
    }

    fn push(&mut self, value: f64) {
        self.sum += value;
        self.in_sum += 1;
        if self.in_sum < self.m {
            return;
        }
        let mean = self.sum / self.m as f64;
        if self.count > 0 {
            self.squares += (mean - self.last) * (mean - self.last);
        }
        (self.sum, self.in_sum, self.last, self.count) = (0.0, 0, mean, self.count + 1);
    }

    fn adjacent(&self) -> Adjacent {
        let variance = self.squares / (2.0 * (self.count.max(2) - 1) as f64);
        Adjacent { m: self.m, count: self.count, variance }
    }
}

impl Live {
    fn new(start_ns: u64, end_ns: u64) -> Self {
        let blocks = (end_ns - start_ns) / BLOCK_NS;
        let mut rungs = [Averages::default(); RUNGS];
        for (exponent, rung) in rungs.iter_mut().enumerate() {
            *rung = Averages::of(2 << exponent);
        }
        Self {
            rates: Averages::of(1),
            temps: Averages::of(1),
            eighths: Averages::of(usize::try_from(blocks / 8).unwrap_or(usize::MAX).max(1)),
            rungs,
            ..Self::default()
        }
    }

    fn end_block(&mut self, axis: &Axis, totals: &mut Totals) {
        if let Some(rate_dps) = core::mem::take(&mut self.rate).mean(&axis.rate) {
            self.rates.push(rate_dps);
            self.eighths.push(rate_dps);
            self.rungs.iter_mut().for_each(|rung| rung.push(rate_dps));
        }
        if let Some(temp_c) = core::mem::take(&mut self.temp).mean(&axis.temp) {
            self.temps.push(temp_c);
            let (low, high) = totals.temp_range_c.unwrap_or((temp_c, temp_c));
            totals.temp_range_c = Some((low.min(temp_c), high.max(temp_c)));
        }
    }

    /// The Allan variance of averages of `m` blocks. `None` unless `m` is a power of two from 2 to 2¹⁴.
    fn rung(&self, m: usize) -> Option<Adjacent> {
        self.rungs.iter().find(|rung| rung.m == m).map(Averages::adjacent)
    }
}

impl Totals {
    fn summary(&self, axis: &Axis) -> Summary {
        Summary {
            start_s: self.start_ns as f64 * 1e-9,
            end_s: self.end_ns as f64 * 1e-9,
            samples: self.samples,
            lost: self.lost,
            overranged: self.overranged,
            faulty: self.faulty,
            rate_dps: self.rate.mean(&axis.rate),
            temp_c: self.temp.mean(&axis.temp),
            rates: self.rates,
            temps: self.temps,
            eighths: self.eighths,
            temp_range_c: self.temp_range_c.unwrap_or((f64::INFINITY, f64::NEG_INFINITY)),
        }
    }

    /// Change of temperature over the step, °C/s, from the means of its two halves.
    fn temp_slope_c_per_s(&self, axis: &Axis, first_half: CodeSum) -> f64 {
        let half_s = (self.end_ns - self.start_ns) as f64 * 0.5e-9;
        let halves = (first_half.mean(&axis.temp), self.temp.without(first_half).mean(&axis.temp));
        if let (Some(first), Some(second)) = halves { (second - first) / half_s } else { 0.0 }
    }
}

impl WindowSums for Running {
    fn new(axis: &Axis) -> Self {
        Self { axis: *axis, closed: Default::default(), live: Live::default() }
    }

    fn open(&mut self, state: State, start_ns: u64, end_ns: u64) {
        self.closed[state as usize] = Totals { start_ns, end_ns, ..Totals::default() };
        self.live = Live::new(start_ns, end_ns);
    }

    #[inline]
    fn push(&mut self, state: State, at_ns: u64, judged: &Judged) {
        let (totals, live) = (&mut self.closed[state as usize], &mut self.live);
        let since_start_ns = at_ns.saturating_sub(totals.start_ns);
        let in_block_ns = since_start_ns.saturating_sub(live.block * BLOCK_NS);
        if in_block_ns >= BLOCK_NS {
            live.end_block(&self.axis, totals);
            live.block = since_start_ns / BLOCK_NS;
        }
        if let Some(rate) = judged.rate() {
            live.rate.push(rate);
            totals.rate.push(rate);
        }
        if let Some(temp) = judged.temp() {
            live.temp.push(temp);
            totals.temp.push(temp);
            let blocks = (totals.end_ns - totals.start_ns) / BLOCK_NS;
            if live.block < blocks / 2 {
                live.first_half.push(temp);
            }
        }
        totals.samples += 1;
        totals.lost += u64::from(judged.reading.lost);
        totals.overranged += u64::from(judged.flags.has(Flags::OUT_OF_RANGE));
        totals.faulty += u64::from(judged.is_faulty());
    }

    fn close(&mut self, state: State, _: u64) {
        let (totals, live) = (&mut self.closed[state as usize], &mut self.live);
        live.end_block(&self.axis, totals);
        (totals.rates, totals.temps) = (live.rates.adjacent(), live.temps.adjacent());
        totals.eighths = live.eighths.adjacent();
    }

    fn summary(&self, state: State) -> Summary {
        self.closed[state as usize].summary(&self.axis)
    }

    fn verdict(&self, state: State) -> Verdict {
        let totals = &self.closed[state as usize];
        let slope = totals.temp_slope_c_per_s(&self.axis, self.live.first_half);
        stationarity::judge_variances(&self.axis, totals.rates, |m| self.live.rung(m), slope)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::procedure::window_sums::tests::{RISE_C_PER_S, rising};

    #[test]
    fn the_slope_is_the_change_of_temperature_over_the_time() {
        let axis = Axis::ADIS16130;
        let sums: Running = rising(&axis, State::Offset);
        let slope_c_per_s = sums.closed[State::Offset as usize].temp_slope_c_per_s(&axis, sums.live.first_half);
        assert!((slope_c_per_s - RISE_C_PER_S).abs() < 1e-3, "{slope_c_per_s}");
    }
}
