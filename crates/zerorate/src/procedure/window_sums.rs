//! Sums over the samples of each step of the procedure, and their summaries.

use crate::health::Judged;
use crate::health::block_means::Adjacent;
use crate::health::stationarity::Verdict;
use crate::part::Axis;
use crate::plan::State;

/// Sums over the windows of the procedure, one for each step. [`Blocks`](super::blocks::Blocks) keeps every block,
/// and [`Running`](super::running::Running) needs only fixed memory. Times count from the start of the procedure.
pub trait WindowSums: Clone + core::fmt::Debug {
    fn new(axis: &Axis) -> Self;

    fn open(&mut self, state: State, start_ns: u64, end_ns: u64);

    /// Takes in a sample of the step that was opened last.
    fn push(&mut self, state: State, at_ns: u64, judged: &Judged);

    fn close(&mut self, state: State, end_ns: u64);

    fn summary(&self, state: State) -> Summary;

    /// Judges whether the part was at rest during the step that was closed last.
    fn verdict(&self, state: State) -> Verdict;
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
    pub(crate) samples: u64,
    pub(crate) lost: u64,
    pub(crate) overranged: u64,
    /// Readings with an impossible rate or temperature. No sum includes the impossible value.
    pub(crate) faulty: u64,
    /// Mean rate, °/s: the exact sum of the codes with a single division.
    pub(crate) rate_dps: Option<f64>,
    pub(crate) temp_c: Option<f64>,
    /// Allan variance of adjacent block means of the rate, (°/s)².
    pub(crate) rates: Adjacent,
    /// Allan variance of adjacent block means of the temperature, °C².
    pub(crate) temps: Adjacent,
    /// Allan variance of the rate in averages over an eighth of the step, (°/s)².
    pub(crate) eighths: Adjacent,
    /// Lowest and highest block mean of the temperature, °C. Without one, the lowest is +∞ and the highest −∞.
    pub(crate) temp_range_c: (f64, f64),
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::health::Flags;
    use crate::part::Reading;

    pub(crate) const RISE_C_PER_S: f64 = 0.5;

    pub(crate) fn rising<S: WindowSums>(axis: &Axis, state: State) -> S {
        let (start_ns, end_ns) = (3_000_000_000, 14_000_000_000);
        let mut sums = S::new(axis);
        sums.open(state, start_ns, end_ns);
        for seq in 0..1100_u32 {
            let t_ns = start_ns + u64::from(seq) * 10_000_000;
            let temp_c = 25.0 + 0.01 * RISE_C_PER_S * f64::from(seq);
            let temp = Some((axis.temp.nearest_code(temp_c) - axis.temp.zero_code) as i32);
            let reading = Reading { t_ns, seq, rate: 0, temp, out_of_range: false, lost: 0 };
            sums.push(state, t_ns, &Judged { reading, flags: Flags::default() });
        }
        sums.close(state, end_ns);
        sums
    }
}
