//! Learns the times of the rate updates from the edges of RDY.
//!
//! # The loop
//!
//! A digital phase-locked loop of second order, with one step per edge. T̂ is the estimated period and τ̂ the
//! estimated time of the newest tick, both in ns. e is how much later an edge came than its point of the [`EdgeGrid`]:
//!
//! ```text
//! τ̂ ← τ̂ + α·e,   T̂ ← T̂ + β·e,   α = 2^−g,   β = α²/2 = 2^−(2g+1)
//! ```
//!
//! The gear g sets everything else. Since β = α²/2 the damping is ζ = α/(2√β) = 1/√2 in every gear, the value without
//! a peak in the error. This is an α-β filter. For α ≪ 1 the formulas of a loop in continuous time hold (F. M.
//! Gardner, *Phaselock Techniques*, 3rd ed., chapter 2). The noise of T̂ is exact to first order in α. In the table, σ
//! is the jitter of the timestamps, as standard deviation. The last two columns are gears 5 and 10 at 5693 edges a
//! second (F-31).
//!
//! | what | in general | gear 5 | gear 10 |
//! |---|---|---|---|
//! | natural frequency ω_n | α/√2 per edge | 20 Hz | 0.63 Hz |
//! | error that is left of a wander of the timestamps with ω_n | 1/(2ζ) = 71 % | | |
//! | with ω_n/10 | 1.0 % | | |
//! | largest error after a step Δ of the period | 2·e^(−π/4)·sin(π/4)·Δ/α = 0.645·Δ/α | | |
//! | edges until then | π/(2α) | 50 | 1608 |
//! | what is left of Δ in T̂ after n edges, x = α·n/2 | e^(−x)·(cos x + sin x) | | |
//! | noise of T̂ | σ·√(α³/8) = σ·2^(−3(g+1)/2) | σ/512 | σ/92 682 |
//!
//! With σ = 15 µs the period is thus known to 1 part in 10⁶ in gear 10. T̂ has steps of 2⁻¹⁶ ns: in gear 10 an error
//! moves it by one step for each 32 ns, rounded down. The unit tests measure each row.
//!
//! # From the first edge to gear 10
//!
//! The jitter of one edge is larger than the tolerance of MCLK (F-31). So in gears 1 to 4 the loop does not move T̂:
//! it is the mean of the gaps, taken after 16, 32, 64 and 128 of them. It is then good to √2·σ/128 (with σ = 15 µs to
//! σ/64, because some gaps look too long and are left out). From gear 5 on each gear lasts 4/α edges, in which an
//! error of T̂ dies down to e^(−2)·(cos 2 + sin 2), 7 %. Gear 10 begins after 128 + 3968 edges, 0.72 s (F-31).
//!
//! *Lock range*: T̂ stays within 1/16 of the nominal period, three times the tolerance of MCLK (F-31). Every clock in
//! that range is acquired. In gear 1, with T̂ still nominal, an offset of T/16 leaves an error of at most (T/16)/α =
//! T/8, half of the T/4 beyond which the other point is nearer. A clock outside belongs to another part or another
//! configuration, and is not followed.
//!
//! *Gaps*: T̂ carries the phase over up to 4/α periods. Over these its noise grows to 4/α·σ·√(α³/8) = σ·√(2α), less
//! than the jitter itself. In gear 1 the tolerance of 2 % grows to 16 % of a period. Over a longer gap the phase is
//! lost (`Timeline::leap`).

mod edge_grid;
mod lock;
#[cfg(test)]
mod tests;

use crate::quotient::quotient;
use crate::sample::Edge;
use edge_grid::EdgeKind;
pub(crate) use edge_grid::{EdgeGrid, Pattern};
use lock::{Gaps, Grip, Lock};

/// Times are kept in units of 2⁻¹⁶ ns, so that a period is good to 10⁻⁹ without floating point.
const FRACTION_BITS: u32 = 16;

/// The longest gap: 2⁴⁶ ns are 19.5 hours. A longer gap counts as this one.
const LONGEST_GAP_NS: i64 = 1 << 46;

/// α = 1/2: after two edges with the nominal period the phase is known to T/8 (lock range).
const FIRST_GEAR: u32 = 1;

/// From this gear on the loop moves T̂. The mean of 128 gaps is as good as T̂ of the loop in gear 3, σ/64, and the
/// phase noise of gear 5, σ·√(3α/4) = 0.15·σ, no longer matters against the jitter.
const LOOP_GEAR: u32 = 5;

/// ω_n = 0.63 Hz (F-31). With a lower ω_n the loop would follow MCLK too slowly when the part warms. With a higher one
/// it would pass more jitter.
const TOP_GEAR: u32 = 10;

/// Whether it is known which edges announce rates.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Phase {
    Assumed,
    /// Assumed, too. The edge of the first sample had two possible numbers, and the samples count from the higher one.
    AnchoredHigh,
    Known,
}

/// Learns phase and period of the rate updates from the edges, and numbers them.
///
/// Every real edge lies on a point of the [`EdgeGrid`]: RDY only falls when a data register has been updated (F-32).
#[derive(Clone, Debug)]
pub(crate) struct Timeline {
    grid: EdgeGrid,
    /// T̂: the learned time from one tick to the next, in 2⁻¹⁶ ns.
    period: i64,
    /// Time from a tick to the next temperature update, computed by [`settle`](Self::settle). 0 if there is none.
    temp: i64,
    kind: EdgeKind,
    /// Time from the newest tick to the previous edge.
    since_tick: i64,
    /// Ticks since the tick of the previous sample.
    ticks: i32,
    last: Option<Edge>,
    gear: u32,
    edges_in_gear: u32,
    gaps: Gaps,
    lock: Lock,
    grip: Grip,
    phase: Phase,
    /// Whether the conversions have been started anew since the previous edge.
    restarted: bool,
}

impl Timeline {
    pub(crate) fn new(grid: EdgeGrid) -> Self {
        Self {
            period: grid.period,
            temp: grid.share_of_temp(grid.period),
            kind: EdgeKind::default(),
            since_tick: 0,
            ticks: 0,
            last: None,
            gear: FIRST_GEAR,
            edges_in_gear: 0,
            gaps: Gaps::default(),
            lock: Lock::default(),
            grip: Grip::Firm,
            phase: Phase::Assumed,
            restarted: false,
            grid,
        }
    }

    /// Takes the next edge, and returns the ticks up to it since [`count_from`](Self::count_from). `None` if the edge
    /// is the previous one again.
    ///
    /// If the edge has two possible numbers ([`is_ambiguous`](Self::is_ambiguous)), returns the lower one.
    pub(crate) fn advance(&mut self, edge: Edge) -> Option<i32> {
        let Some(last) = self.last.replace(edge) else {
            self.assume_first_edge();
            self.restarted = false;
            return Some(self.number());
        };
        let edges = edge.seq.wrapping_sub(last.seq);
        if edges == 0 {
            self.last = Some(last);
            return None;
        }
        let elapsed_ns = edge.t_ns.wrapping_sub(last.t_ns) as i64;
        if 0 < elapsed_ns && elapsed_ns <= self.reach_ns() && !self.restarted {
            self.track(elapsed_ns << FRACTION_BITS);
        } else {
            self.leap(elapsed_ns, edges);
        }
        Some(self.number())
    }

    /// Whether the newest edge has two possible numbers. This is the case if the edges have changed from one kind of
    /// update to the other, and it is unknown which of the two kinds is the rate.
    pub(crate) fn is_ambiguous(&self) -> bool {
        self.kind.is_rate && self.phase != Phase::Known
    }

    pub(crate) fn is_aligned(&self) -> bool {
        self.phase == Phase::Known
    }

    fn number(&self) -> i32 {
        self.ticks.saturating_sub(self.is_ambiguous().into())
    }

    /// Counts ticks from a later tick than before: `ticks` later.
    pub(crate) fn count_from(&mut self, ticks: i32) {
        self.ticks = self.ticks.saturating_sub(ticks);
    }

    /// States that the edge just taken announced a rate update, not a temperature update. Has no effect while the
    /// phase is known. Returns whether one more tick has passed than was counted: this edge has the higher of its two
    /// possible numbers, or [`anchor`](Self::anchor) wrongly assumed the higher one.
    pub(crate) fn align(&mut self) -> bool {
        if self.phase == Phase::Known {
            return false;
        }
        let one_more = self.is_ambiguous() || self.phase == Phase::AnchoredHigh;
        self.phase = Phase::Known;
        self.since_tick = 0;
        self.kind.is_rate = true;
        one_more
    }

    /// States that the samples count from the edge just taken. If the edge has two possible numbers, the higher one
    /// counts, so that each reported loss is real. Returns whether the edge has two possible numbers.
    pub(crate) fn anchor(&mut self) -> bool {
        let is_ambiguous = self.is_ambiguous();
        if is_ambiguous {
            self.phase = Phase::AnchoredHigh;
        }
        is_ambiguous
    }

    /// States that the edge just taken brought no new rate, and counts as the first one. The call has no effect if
    /// edges may announce a temperature alone.
    pub(crate) fn begin(&mut self) {
        if self.grid.announces_temps() {
            return;
        }
        self.assume_first_edge();
        self.ticks = 0;
    }

    /// States that the conversions start anew: the next edge has a phase of its own.
    pub(crate) fn restart(&mut self) {
        self.restarted = true;
    }

    pub(crate) fn period_ns(&self) -> f64 {
        self.period as f64 / (1u64 << FRACTION_BITS) as f64
    }

    pub(crate) fn eighths_of_period_ns(&self, eighths: u32) -> u64 {
        ((self.period >> 3) as u64 * u64::from(eighths)) >> FRACTION_BITS
    }

    /// The longest gap over which the period is known well enough to keep the phase: 4/α periods.
    fn reach_ns(&self) -> i64 {
        (self.period >> FRACTION_BITS) << (self.gear + 2)
    }

    fn track(&mut self, elapsed: i64) {
        let position = self.since_tick + elapsed;
        let periods = self.periods_in(position);
        let position = position - periods as i64 * self.period;
        let error = self.kind.error(&self.grid, (self.period, self.temp), position);
        self.ticks = self.ticks.saturating_add(periods as i32);
        self.since_tick = if self.grid.is_divided() { 0 } else { position - (error >> self.gear) };
        if !matches!(self.grip, Grip::Held(_)) {
            let learned = if self.gear < LOOP_GEAR { self.acquire(elapsed) } else { self.follow(error, periods) };
            self.period = self.grid.clamped(learned);
        }
        let lost = self.lock.judge(&self.grid, error);
        if let Some(lost) = lost {
            self.hold(lost);
        }
        if self.gear <= LOOP_GEAR || lost.is_some() {
            self.settle();
        }
    }

    /// Takes the mean of the gaps as the period, after 16, 32, 64 and 128 of them.
    fn acquire(&mut self, elapsed: i64) -> i64 {
        self.gaps.push(&self.grid, (self.period, self.temp), elapsed);
        if self.gaps.count < 8 << self.gear {
            return self.period;
        }
        self.gear += 1;
        self.grid.period + self.gaps.offset(&self.grid)
    }

    /// Moves the period by part of the error, spread over the periods in which it arose.
    fn follow(&mut self, error: i64, periods: u64) -> i64 {
        if self.gear < self.grid.top_gear() {
            self.edges_in_gear += 1;
        }
        let spread = (periods as u32 | 1).ilog2();
        let learned = self.period + (error >> (2 * self.gear + 1 + spread));
        if self.edges_in_gear >= 4 << self.gear {
            self.gear += 1;
            self.edges_in_gear = 0;
        }
        learned
    }

    /// Learns the grid anew if the edges do not lie on it. If they do not lie on the new grid either, uses the nominal
    /// period for a while.
    #[cold]
    fn hold(&mut self, lost: bool) {
        self.grip = self.grip.after(lost);
        self.gear = match self.grip {
            Grip::Firm => return,
            Grip::Loose => FIRST_GEAR,
            Grip::Held(_) => {
                self.period = self.grid.period;
                LOOP_GEAR
            }
        };
        self.edges_in_gear = 0;
        self.gaps = Gaps::default();
    }

    /// Counts the whole periods in `position`. An edge early by up to the margin belongs to the update that it
    /// announces.
    fn periods_in(&self, position: i64) -> u64 {
        let position = position + self.grid.margin;
        if position < 2 * self.period {
            (position >= self.period).into()
        } else {
            quotient(position as u64, self.period as u64)
        }
    }

    /// Counts the periods in a gap over which the phase is lost: the gap is too long, the conversions started anew, or
    /// the clock went back or stands still. The clock gives the number of periods. The number of edges gives a lower
    /// bound, since each edge takes at least one conversion. Divided edges come faster while nothing is read, so their
    /// number is used only if the clock shows no period.
    #[cold]
    fn leap(&mut self, elapsed_ns: i64, edges: u32) {
        let elapsed = elapsed_ns.clamp(0, LONGEST_GAP_NS) << FRACTION_BITS;
        let by_time = self.periods_in(self.since_tick + elapsed);
        let went_back = edges > u32::MAX / 2;
        let by_clock_alone = went_back || self.grid.is_divided() && by_time > 0;
        let by_edges = if by_clock_alone { 1 } else { self.grid.periods_of_edges(edges) };
        let by_time = i32::try_from(by_time).unwrap_or(i32::MAX);
        self.ticks = self.ticks.saturating_add(by_time.max(by_edges as i32));
        self.restarted = false;
        self.gear = self.gear.min(LOOP_GEAR);
        self.edges_in_gear = 0;
        self.assume_first_edge();
    }

    /// Sets an unknown phase by assuming that the edge is the first one after an initialisation. If such an edge
    /// announces a temperature, the phase stays an assumption until [`align`](Self::align).
    fn assume_first_edge(&mut self) {
        let is_rate = self.grid.begins_with_rate();
        self.since_tick = if is_rate { 0 } else { self.temp };
        self.kind.is_rate = is_rate;
        self.phase = if is_rate { Phase::Known } else { Phase::Assumed };
    }

    fn settle(&mut self) {
        self.temp = self.grid.share_of_temp(self.period);
    }
}
