//! What the procedure keeps of its samples, and what it asks of that.

use crate::block_means::Adjacent;
use crate::health::Judged;
use crate::part::Axis;
use crate::states::{STATES, State};
use crate::stationarity::Verdict;

/// Keeps the samples of each step: all of them as sums over blocks ([`Blocks`](crate::blocks::Blocks)), or as much as
/// fits into fixed memory ([`Running`](crate::running::Running)). Times count from the start of the procedure.
pub trait Ledger: Clone + core::fmt::Debug {
    /// An empty one, for readings of this axis.
    fn new(axis: &Axis) -> Self;

    /// A step begins.
    fn open(&mut self, state: State, start_ns: u64, end_ns: u64);

    /// A sample of the step that was opened last.
    fn push(&mut self, state: State, at_ns: u64, judged: &Judged);

    /// The step is over, at this time.
    fn close(&mut self, state: State, end_ns: u64);

    /// A step in numbers.
    fn summary(&self, state: State) -> Summary;

    /// Whether the part was at rest during the step that was closed last.
    fn verdict(&self, state: State) -> Verdict;

    /// Every step in numbers.
    fn summaries(&self) -> [Summary; STATES] {
        State::ALL.map(|state| self.summary(state))
    }
}

/// A step of the procedure in numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Summary {
    pub(crate) start_s: f64,
    pub(crate) end_s: f64,
    pub(crate) samples: u64,
    pub(crate) lost: u64,
    pub(crate) overranged: u64,
    /// Readings that are impossible, and are in no sum.
    pub(crate) spoilt: u64,
    /// Mean rate, °/s: the exact sum of the codes, divided once.
    pub(crate) rate_dps: Option<f64>,
    /// Mean temperature, °C.
    pub(crate) temp_c: Option<f64>,
    /// Block means of the rate: adjacent ones.
    pub(crate) rates: Adjacent,
    /// Block means of the temperature, adjacent ones, °C.
    pub(crate) temps: Adjacent,
    /// The rate again, in averages of an eighth of the step.
    pub(crate) eighths: Adjacent,
    /// Lowest and highest block mean of the temperature, °C; the lowest above the highest where there is none.
    pub(crate) temp_range_c: (f64, f64),
}
