//! Checks `lost`: its sum must be the number of conversions of the twin, less the number of samples.
//!
//! The documentation of `Sampler` promises that each reported loss is real, and that each loss is reported within five
//! samples. A host that reads late gets a newer conversion than the edge announced. So only samples that were read at
//! once count among these five. In these cases the driver can count only approximately:
//!
//! * A gap that is too long for the learned period is counted by the clock, to within one at either end.
//! * A restart stops the conversions. The loss is counted by the clock, to within three.
//! * Before the period is learned, a gap over which the clock moves an edge past its margin costs one sample.
//! * A reading outside the sampler changes the kind of the edges (rate or temperature), which costs one sample.
//! * With RDYFN = 0, or with conversions of two lengths, a wrong guess at the kind of the first edge costs one sample.
//! * A first sample that was read late counts from its edge, or from its reading. An edge whose data was overwritten
//!   looks late. So the losses between the first two samples need not be reported.
//!
//! Once all losses are reported, the difference between reported and true losses changes by at most two.

use adis16130_twin::Conversion;

/// Number of samples after which a loss must have been reported.
const REPORTED_WITHIN: u32 = 5;

/// Up to a gap of this many periods, losses are counted exactly from the first edge on: 4/α = 8 periods between edges
/// in gear 1, and one less between conversions.
const REACH_AT_FIRST: f64 = 8.0 - 1.0;

/// Up to a gap of this many periods, losses are counted exactly after [`SAMPLES_TO_LEARN`] samples without a longer
/// gap: 4/α = 128 periods in gear 5, less one.
const REACH: f64 = 128.0 - 1.0;
const SAMPLES_TO_LEARN: u32 = 300;

/// Margin of the edge grid with F-30, in periods: an edge may come this much early.
const MARGIN: f64 = 1.0 / 16.0;

/// Number of periods over which an offset of the clock adds up in the phase: twice 1/α in gear 1.
const LAG: f64 = 4.0;

/// Largest ratio of the true period to the nominal one, or its inverse. The master clock is at most 6 % off.
const MOST_CLOCK: f64 = 1.0 / 0.94;

const ROUNDING: f64 = 1e-6;

#[derive(Copy, Clone, Debug)]
pub struct SampleRecord {
    pub lost: u32,
    /// Time of the sample's edge on the twin's clock, in ns.
    pub edge_ns: u64,
    /// The conversion whose rate the twin sent.
    pub conversion: Conversion,
}

/// Compares reported and true losses, in samples.
#[derive(Clone, Debug, Default)]
pub struct Ledger {
    last: Option<SampleRecord>,
    /// Reported losses less true losses.
    balance: f64,
    /// Bounds of `balance` once all losses have been reported. Before that, `balance` may be lower.
    lowest: f64,
    highest: f64,
    /// Number of samples in a row that were read at once, with nothing lost.
    calm: u32,
    samples: u64,
    /// Number of samples since a gap that was counted by the clock.
    learned: u32,
    /// The largest relative error of the learned period since the last sample.
    clock_off: f64,
    restarted: bool,
    read_beside: bool,
}

impl Ledger {
    /// Makes the ledger of a new sampler. `knows_edges`: whether the sampler can find out which edges announce rates.
    pub fn new(knows_edges: bool) -> Self {
        let mut ledger = Self::default();
        ledger.doubt(if knows_edges { 0.0 } else { 1.0 });
        ledger
    }

    /// Notes that the part was initialised anew, and that `Sampler::restarted` was called.
    pub fn restarted(&mut self) {
        self.restarted = true;
    }

    /// Notes that a call outside the sampler may have read a data register.
    pub fn read_beside(&mut self) {
        self.read_beside = true;
    }

    /// Notes the true period and the sampler's period, in ns. Call it before each edge.
    pub fn period(&mut self, period_ns: f64, learned_ns: f64) {
        self.clock_off = self.clock_off.max((period_ns / learned_ns - 1.0).abs());
    }

    /// Enters a sample, and checks the losses. `period_ns` is the true period.
    pub fn enter(&mut self, sample: SampleRecord, period_ns: f64) -> Result<(), String> {
        let at_once = sample.conversion.t_ns <= sample.edge_ns;
        let restarted = std::mem::take(&mut self.restarted);
        let missing = match self.last.replace(sample) {
            None => self.begin(&sample, period_ns),
            Some(last) => self.missing(&last, &sample, restarted, period_ns),
        };
        if self.samples == 1 {
            self.lowest -= missing.max(0.0);
        }
        self.balance += f64::from(sample.lost) - missing;
        self.calm = if at_once && missing == 0.0 && sample.lost == 0 { self.calm + 1 } else { 0 };
        self.samples += 1;
        self.learned += 1;
        self.judge()
    }

    fn begin(&mut self, sample: &SampleRecord, period_ns: f64) -> f64 {
        let late_ns = sample.conversion.t_ns.saturating_sub(sample.edge_ns);
        if late_ns > 0 {
            self.doubt(2.0 + MOST_CLOCK * late_ns as f64 / period_ns);
        }
        0.0
    }

    /// Number of conversions lost between two samples.
    fn missing(&mut self, last: &SampleRecord, sample: &SampleRecord, restarted: bool, period_ns: f64) -> f64 {
        let periods = (sample.conversion.t_ns - last.conversion.t_ns) as f64 / period_ns;
        let reach = if self.learned > SAMPLES_TO_LEARN { REACH } else { REACH_AT_FIRST };
        let clock_off = std::mem::take(&mut self.clock_off);
        if restarted || periods > reach {
            self.doubt(if restarted { 3.0 } else { 2.0 } + periods * clock_off);
            self.learned = 0;
        } else if std::mem::take(&mut self.read_beside) || (periods + LAG) * clock_off > MARGIN {
            self.doubt(1.0);
        }
        if restarted { periods - 1.0 } else { (sample.conversion.number - last.conversion.number - 1) as f64 }
    }

    fn doubt(&mut self, samples: f64) {
        self.lowest -= samples;
        self.highest += samples;
    }

    fn judge(&mut self) -> Result<(), String> {
        let (balance, lowest, highest) = (self.balance, self.lowest, self.highest);
        let verdict =
            |what| Err(format!("{what}: reported less true losses are {balance}, not {lowest} to {highest}"));
        if balance > highest + ROUNDING {
            return verdict("a loss was reported that did not happen");
        }
        if self.calm >= REPORTED_WITHIN {
            if balance < lowest - ROUNDING {
                return verdict("a loss was not reported");
            }
            self.lowest = lowest.max(balance - 2.0);
            self.highest = highest.min(balance + 2.0);
        }
        Ok(())
    }
}
