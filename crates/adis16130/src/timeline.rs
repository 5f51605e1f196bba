//! Where the rate updates lie in time, learned from the edges of RDY.

use crate::quotient::quotient;
use crate::sample::Edge;

/// Times are kept in units of 2⁻¹⁶ ns, so that a period is good to 10⁻⁹ without floating point.
const FRACTION_BITS: u32 = 16;

/// A gap beyond this counts as this: 2⁴⁶ ns are 19.5 hours.
const LONGEST_GAP_NS: i64 = 1 << 46;

const FIRST_GEAR: u32 = 1;

/// From this gear on the loop tracks the period; before, it is the mean of the gaps seen so far.
const LOOP_GEAR: u32 = 5;

const TOP_GEAR: u32 = 10;

/// Edges after which the loop asks itself whether it is locked.
const LOCK_EDGES: u32 = 256;

/// Checks without a lock before it learns anew.
const HELD_CHECKS: u8 = 16;

/// Learns phase and period of the rate updates from the edges, and numbers them.
///
/// Every honest edge lies on a tooth of the [`Comb`], because RDY only falls when a data register has been updated
/// (F-32). The loop has gears g = 1 … 10, each lasting twice as long as the one before. The phase takes 2^−g of each
/// error. The period is the mean of the gaps up to gear 4, since the jitter of a single edge is larger than the
/// tolerance of the clock; then it takes 2^−(2g+1) of each error, so that the memory ends up some thousand edges long.
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    comb: Comb,
    tooth: Tooth,
    /// By how much an edge may come before its rate update and still belong to it.
    margin: i64,
    /// Time from the newest rate update to the edge before.
    since_update: i64,
    /// Running number of the newest rate update.
    index: u64,
    last: Option<Edge>,
    gear: u32,
    edges_in_gear: u32,
    gaps: Gaps,
    lock: Lock,
    grip: Grip,
    /// The phase is known from more than an assumption.
    aligned: bool,
    /// The conversions have been started anew since the edge before.
    restarted: bool,
}

impl Timeline {
    /// `cycles` are the conversion times of rate and temperature in MCLK cycles, 0 for a disabled channel. `steady` =
    /// edges keep to one kind of update as long as the host is prompt.
    pub(crate) fn new(cycles: (u32, u32), mclk_hz: u32, steady: bool) -> Self {
        let comb = Comb::new(cycles, mclk_hz);
        Self {
            tooth: Tooth::new(steady),
            margin: (comb.period - comb.temp) >> 3,
            comb,
            since_update: 0,
            index: 0,
            last: None,
            gear: FIRST_GEAR,
            edges_in_gear: 0,
            gaps: Gaps::default(),
            lock: Lock::default(),
            grip: Grip::Firm,
            aligned: false,
            restarted: false,
        }
    }

    /// Takes the next edge and returns the number of the newest rate update at that time; `None` if it is the edge
    /// before again.
    ///
    /// As long as nobody knows whether the first edge was that of a rate or of a temperature update, this is the lower of
    /// the two numbers that are possible.
    #[inline]
    pub(crate) fn advance(&mut self, edge: Edge) -> Option<u64> {
        let Some(last) = self.last else {
            self.last = Some(edge);
            self.assume_temp_edge();
            return Some(self.number());
        };
        let edges = edge.seq.wrapping_sub(last.seq);
        if edges == 0 {
            return None;
        }
        self.last = Some(edge);
        let elapsed_ns = edge.t_ns.wrapping_sub(last.t_ns) as i64;
        if 0 < elapsed_ns && elapsed_ns <= self.reach_ns() && !self.restarted {
            self.track(elapsed_ns << FRACTION_BITS);
        } else {
            self.leap(elapsed_ns, edges);
        }
        Some(self.number())
    }

    /// Whether the two possible numbers differ: the edges have changed from one kind of update to the other, and it is
    /// not known which is which.
    #[inline]
    pub(crate) fn is_ambiguous(&self) -> bool {
        self.tooth.on_rate && !self.aligned
    }

    /// Whether it is known which edges are those of rate updates.
    pub(crate) fn is_aligned(&self) -> bool {
        self.aligned
    }

    #[inline]
    fn number(&self) -> u64 {
        self.index.saturating_sub(self.is_ambiguous().into())
    }

    /// States that the edge just taken was a rate update, not one of temperature. Only the first time counts: from then
    /// on the phase is tracked. Returns whether its number is thereby known to be the higher of two.
    #[inline]
    pub(crate) fn align(&mut self) -> bool {
        let was_ambiguous = self.is_ambiguous();
        if !self.aligned {
            self.aligned = true;
            self.since_update = 0;
            self.tooth.on_rate = true;
        }
        was_ambiguous
    }

    /// States that the edge just taken counts as the first, and returns its number.
    pub(crate) fn begin(&mut self) -> u64 {
        self.assume_temp_edge();
        self.index
    }

    /// States that the conversions start anew: the next edge has a phase of its own.
    pub(crate) fn restart(&mut self) {
        self.restarted = true;
    }

    /// The period in ns.
    pub(crate) fn period_ns(&self) -> f64 {
        self.comb.period as f64 / (1u64 << FRACTION_BITS) as f64
    }

    /// So many eighths of the period, in whole ns.
    pub(crate) fn eighths_of_period_ns(&self, eighths: u32) -> u64 {
        (self.comb.period as u64 * u64::from(eighths)) >> (FRACTION_BITS + 3)
    }

    /// The longest gap over which the period is known well enough to keep the phase: 2^(g+2) periods.
    #[inline]
    fn reach_ns(&self) -> i64 {
        (self.comb.period >> FRACTION_BITS) << (self.gear + 2)
    }

    #[inline]
    fn track(&mut self, elapsed: i64) {
        let position = self.since_update + elapsed;
        let periods = self.periods_in(position);
        let position = position - periods as i64 * self.comb.period;
        let error = self.tooth.error(&self.comb, position);
        self.index += periods;
        self.since_update = position - (error >> self.gear);
        if matches!(self.grip, Grip::Held(_)) {
            // nothing can be learned
        } else if self.gear < LOOP_GEAR {
            self.acquire(elapsed);
        } else {
            self.follow(error, periods);
        }
        self.lock.push(error);
        if self.lock.edges == LOCK_EDGES {
            self.check_lock();
        }
    }

    /// The period is the mean of the gaps, after 16, 32, 64 and 128 of them.
    fn acquire(&mut self, elapsed: i64) {
        self.gaps.push(&self.comb, self.tooth.steady, elapsed);
        if self.gaps.count >= 8 << self.gear {
            self.comb.scale(self.gaps.parts_per_million());
            self.gear += 1;
        }
    }

    /// The period takes part of the error, spread over the periods in which it arose.
    #[inline]
    fn follow(&mut self, error: i64, periods: u64) {
        let spread = if periods > 1 { periods.ilog2() } else { 0 };
        self.comb.correct(error >> (2 * self.gear + 1 + spread));
        if self.gear < TOP_GEAR {
            self.edges_in_gear += 1;
            if self.edges_in_gear >= 4 << self.gear {
                self.gear += 1;
                self.edges_in_gear = 0;
            }
        }
    }

    /// Learns anew if the edges do not lie on the comb; if that does not help, the nominal period holds for a while.
    #[cold]
    fn check_lock(&mut self) {
        let lost = self.lock.is_lost(&self.comb, self.tooth.steady);
        let (grip, gear) = match self.grip {
            Grip::Held(0) => (Grip::Loose, FIRST_GEAR),
            Grip::Held(checks) => (Grip::Held(checks - 1), LOOP_GEAR),
            Grip::Firm if lost => (Grip::Loose, FIRST_GEAR),
            Grip::Loose if lost => (Grip::Held(HELD_CHECKS), LOOP_GEAR),
            Grip::Firm | Grip::Loose => (Grip::Firm, self.gear),
        };
        self.grip = grip;
        if gear != self.gear {
            self.gear = gear;
            self.edges_in_gear = 0;
            self.gaps = Gaps::default();
        }
        if matches!(grip, Grip::Held(_)) {
            self.comb.period = self.comb.nominal;
        }
        self.lock = Lock::default();
        self.comb.settle();
    }

    /// Whole periods in `position`, where an edge up to `margin` early belongs to the update that it announces.
    #[inline]
    fn periods_in(&self, position: i64) -> u64 {
        let position = position + self.margin;
        if position < self.comb.period {
            0
        } else if position < 2 * self.comb.period {
            1
        } else {
            quotient(position as u64, self.comb.period as u64)
        }
    }

    /// A gap too long to keep the phase over, conversions started anew, or a clock that went back or does not run:
    /// counts the periods in it by the clock and, as a lower bound, by the number of edges, since each takes at least
    /// one conversion.
    #[cold]
    fn leap(&mut self, elapsed_ns: i64, edges: u32) {
        let elapsed = elapsed_ns.clamp(0, LONGEST_GAP_NS) << FRACTION_BITS;
        let by_time = self.periods_in(self.since_update + elapsed);
        let went_back = edges > u32::MAX / 2;
        let by_edges = if went_back { 1 } else { self.comb.periods_of_edges(edges) };
        self.index += by_time.max(by_edges.into());
        self.restarted = false;
        self.gear = self.gear.min(LOOP_GEAR);
        self.edges_in_gear = 0;
        self.assume_temp_edge();
    }

    /// The phase is unknown: the edge is taken for that of a temperature update, as the first one after an
    /// initialisation is, until [`align`](Self::align).
    fn assume_temp_edge(&mut self) {
        self.since_update = self.comb.temp;
        self.tooth.on_rate = false;
        self.aligned = false;
    }
}

/// When updates come: those of rate at 0 and at `period`, one of temperature in between.
#[derive(Clone, Debug)]
struct Comb {
    nominal: i64,
    /// Time from one rate update to the next, as learned.
    period: i64,
    /// `period` stays within these: MCLK is good to 2 %. Three times that is another part or another configuration, and
    /// is not followed.
    limits: (i64, i64),
    /// Time from a rate update to the temperature update after it, as a fraction of the period in 2⁻¹⁶; 0 = there is
    /// none.
    temp_fraction: i64,
    /// The same in units of time, as of the last [`settle`](Self::settle).
    temp: i64,
}

impl Comb {
    fn new((rate_cycles, temp_cycles): (u32, u32), mclk_hz: u32) -> Self {
        let cycles = (rate_cycles + temp_cycles).max(1);
        let cycles_ns = (u64::from(cycles) * 1_000_000_000) << FRACTION_BITS;
        let nominal = quotient(cycles_ns, mclk_hz.max(1_000).into()) as i64;
        let mut comb = Self {
            nominal,
            period: nominal,
            limits: (nominal - (nominal >> 4), nominal + (nominal >> 4)),
            temp_fraction: quotient(u64::from(temp_cycles) << FRACTION_BITS, cycles.into()) as i64,
            temp: 0,
        };
        comb.settle();
        comb
    }

    /// Moves the temperature tooth to where the period, which changes little by little, has got.
    fn settle(&mut self) {
        self.temp = self.share_of_temp(self.period);
    }

    fn share_of_temp(&self, period: i64) -> i64 {
        ((period >> 8) * self.temp_fraction) >> (FRACTION_BITS - 8)
    }

    /// A distance brought to within half a period.
    #[inline]
    fn wrapped(&self, distance: i64) -> i64 {
        if 2 * distance > self.period {
            distance - self.period
        } else if 2 * distance < -self.period {
            distance + self.period
        } else {
            distance
        }
    }

    /// Periods in a run of edges none of which was followed by a read, after the first: a pair of conversions, then one
    /// each.
    fn periods_of_edges(&self, edges: u32) -> u32 {
        if self.temp_fraction > 0 { edges.div_ceil(2) } else { edges }
    }

    fn scale(&mut self, parts_per_million: i64) {
        self.period = self.nominal;
        self.correct(millionth(self.nominal) * parts_per_million);
        self.settle();
    }

    #[inline]
    fn correct(&mut self, by: i64) {
        let (lowest, highest) = self.limits;
        self.period = (self.period + by).max(lowest).min(highest);
    }
}

/// Which kind of update the edges announce: that of rate, or that of temperature.
///
/// As long as they keep to one kind, a deviation of up to half a period is jitter. They change when the host is late
/// (F-33): then all edges that follow are off. That is believed at once if the jitter is small, or else after some
/// edges.
#[derive(Clone, Debug)]
struct Tooth {
    steady: bool,
    on_rate: bool,
    doubts: u8,
    /// Mean absolute error.
    jitter: i64,
}

impl Tooth {
    /// In a row, so that jitter is not taken for a change.
    const DOUBTS: u8 = 8;

    fn new(steady: bool) -> Self {
        Self { steady, on_rate: false, doubts: 0, jitter: 0 }
    }

    /// The distance to the tooth that the edge is taken for.
    #[inline]
    fn error(&mut self, comb: &Comb, position: i64) -> i64 {
        let temp = comb.wrapped(position - comb.temp);
        let rate = comb.wrapped(position);
        let (own, other) = if self.on_rate { (rate, temp) } else { (temp, rate) };
        if own.abs() <= other.abs() {
            self.doubts = 0;
            self.jitter += (own.abs() - self.jitter) >> 4;
            return own;
        }
        self.doubts += 1;
        if self.steady && self.doubts < Self::DOUBTS && 48 * self.jitter > comb.nominal {
            return own;
        }
        self.on_rate = !self.on_rate;
        self.doubts = 0;
        other
    }
}

/// Gaps between neighbouring edges, and what they would be with the nominal clock.
#[derive(Clone, Debug, Default)]
struct Gaps {
    count: u32,
    nominal: i64,
    excess: i64,
    /// The gap before was not near.
    far: bool,
}

impl Gaps {
    /// Adds a gap if it is near a period or, where edges do not keep to one kind of update, near a conversion; and if the
    /// one before was, since after a longer one the first timestamp may be late.
    fn push(&mut self, comb: &Comb, steady: bool, gap: i64) {
        let mut nearest = (comb.period, comb.nominal);
        if !steady {
            let temp = (comb.temp, comb.share_of_temp(comb.nominal));
            for conversion in [temp, (comb.period - temp.0, comb.nominal - temp.1)] {
                if (gap - conversion.0).abs() < (gap - nearest.0).abs() {
                    nearest = conversion;
                }
            }
        }
        let (learned, nominal) = nearest;
        let far = (gap - learned).abs() > 3 * (comb.period >> 3);
        if !core::mem::replace(&mut self.far, far) && !far {
            self.count += 1;
            self.nominal += nominal;
            self.excess += gap - nominal;
        }
    }

    fn parts_per_million(&self) -> i64 {
        quotient(self.excess.unsigned_abs(), millionth(self.nominal).max(1) as u64) as i64 * self.excess.signum()
    }
}

/// How far the edges can be believed.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Grip {
    /// They lie on the comb.
    Firm,
    /// They did not, and the comb is learned anew.
    Loose,
    /// They lie anywhere: for so many more checks the period stays nominal, and the phase is hardly followed.
    Held(u8),
}

/// Tells whether the edges still lie on the comb.
#[derive(Clone, Debug, Default)]
struct Lock {
    edges: u32,
    error: i64,
}

impl Lock {
    #[inline]
    fn push(&mut self, error: i64) {
        self.edges += 1;
        self.error += error.abs();
    }

    /// Edges that lie anywhere are a quarter of a period off in the mean, or an eighth if the nearest of two teeth is
    /// taken.
    fn is_lost(&self, comb: &Comb, steady: bool) -> bool {
        let parts = if steady { 6 } else { 9 };
        parts * self.error > i64::from(self.edges) * comb.nominal
    }
}

/// A millionth of a time that is not negative.
fn millionth(time: i64) -> i64 {
    quotient(time as u64, 1_000_000) as i64
}
