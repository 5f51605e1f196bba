//! The grid of the times at which edges can come, and the kind of update that an edge announces.

use super::{FRACTION_BITS, LOOP_GEAR, TOP_GEAR};
use crate::quotient::quotient;

/// The pattern in which edges follow each other.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
pub(crate) enum Pattern {
    /// The edges announce one kind of update, rate or temperature, as long as the host reads in time.
    Steady,
    /// The edges may announce any update, and begin with a temperature after an initialisation.
    Mixed,
    /// Each update has its own edge, and the first edge announces a rate.
    Each,
    /// The edges come from a counter that divides RDY, too far apart for a phase to be followed. Each edge is a tick.
    Divided,
}

/// The expected times of the updates: a rate update at each tick, a temperature update in between.
#[derive(Clone, Debug)]
pub(crate) struct EdgeGrid {
    /// Nominal time from one tick to the next, in 2⁻¹⁶ ns.
    pub(super) period: i64,
    /// Time from a tick to the temperature update after it, as a fraction of the period in 2⁻¹⁶. 0 if there is none.
    temp_fraction: i64,
    /// The time by which an edge may come early and still belong to its tick, in 2⁻¹⁶ ns. With the period T and the
    /// time r from the temperature update to the next tick, it is the larger of r/8 and min(T/16, r/2). From r = T/25
    /// on, an edge shifts less than this in a period if MCLK is off by 2 %. For divided edges it is T/2.
    pub(super) margin: i64,
    pattern: Pattern,
}

/// The nominal period is at most 2³⁶ ns, 69 s, so that no sum over the errors of a check overflows.
const LONGEST_PERIOD: u64 = 1 << (36 + FRACTION_BITS);

impl EdgeGrid {
    /// Makes a grid from the conversion times of rate and temperature in MCLK cycles, 0 for a disabled channel.
    pub(crate) fn new((rate_cycles, temp_cycles): (u32, u32), mclk_hz: u32, pattern: Pattern) -> Self {
        let cycles = u64::from((rate_cycles + temp_cycles).max(1));
        let period = quotient((cycles * 1_000_000_000) << FRACTION_BITS, mclk_hz.max(1_000).into()) as i64;
        let temp_fraction = quotient(u64::from(temp_cycles) << FRACTION_BITS, cycles) as i64;
        let mut grid = Self { period, temp_fraction, margin: 0, pattern };
        let from_temp = period - grid.share_of_temp(period);
        grid.margin = (from_temp >> 3).max((period >> 4).min(from_temp >> 1));
        grid
    }

    /// Makes the grid of edges that come from a counter, on average `numerator`/`denominator` periods of `self` apart.
    pub(crate) fn divided(self, numerator: u32, denominator: u32) -> Self {
        let ratio = quotient(u64::from(numerator) << FRACTION_BITS, denominator.into());
        let period = ((self.period >> FRACTION_BITS) as u64).saturating_mul(ratio).min(LONGEST_PERIOD) as i64;
        Self { period, temp_fraction: 0, margin: period >> 1, pattern: Pattern::Divided }
    }

    /// With both channels, the longest time in which this many edges come while nothing is read, plus 3/4 of the
    /// shorter conversion, in whole ns. After a read of rate and temperature, these edges take one conversion longer,
    /// because the first one comes after two conversions (F-56).
    pub(crate) fn unread_ns(&self, edges: u32) -> u64 {
        let (period, temp) = (self.period >> FRACTION_BITS, self.share_of_temp(self.period) >> FRACTION_BITS);
        let shorter = temp.min(period - temp);
        let odd = if edges % 2 == 1 { period - shorter } else { 0 };
        (i64::from(edges / 2) * period + odd + 3 * (shorter >> 2)) as u64
    }

    /// Whether the first edge after an initialisation announces a rate.
    pub(super) const fn begins_with_rate(&self) -> bool {
        matches!(self.pattern, Pattern::Each)
    }

    /// Whether there are edges that announce a temperature alone.
    pub(super) const fn announces_temps(&self) -> bool {
        self.begins_with_rate() && self.temp_fraction > 0
    }

    pub(super) const fn is_divided(&self) -> bool {
        matches!(self.pattern, Pattern::Divided)
    }

    /// The highest gear. Divided edges have no phase to follow, only a period. Their T̂ is the mean of the gaps in an
    /// exponential window of 1/β edges, 2048 in gear 5. The noise of T̂ is σ·β, from the two ends of a gap.
    pub(super) const fn top_gear(&self) -> u32 {
        if self.is_divided() { LOOP_GEAR } else { TOP_GEAR }
    }

    /// The time from a tick to the next temperature update, for this period of the ticks. Too short by at most 1 ns
    /// and 2⁻¹⁶ of the period. The function is not inlined, which saves flash.
    #[inline(never)]
    pub(super) const fn share_of_temp(&self, period: i64) -> i64 {
        (period >> FRACTION_BITS) * self.temp_fraction
    }

    /// Number of periods in which this many edges come while nothing is read. With both channels and RDYFN = 1, the
    /// first edge comes after two conversions, and each later one after one. With one channel, each takes a period.
    pub(super) fn periods_of_edges(&self, edges: u32) -> u32 {
        if self.temp_fraction > 0 { edges.div_ceil(2) } else { edges }
    }

    /// Brings a period into the lock range.
    pub(super) fn clamped(&self, period: i64) -> i64 {
        let sixteenth = self.period >> 4;
        period.max(self.period - sixteenth).min(self.period + sixteenth)
    }

    /// The regular gap between two neighbouring edges that comes nearest to `gap`, with its learned and its nominal
    /// length. A regular gap is a period or, if edges announce both kinds of update, a conversion.
    pub(super) fn nearest_gap(&self, (period, temp): (i64, i64), gap: i64) -> (i64, i64) {
        let mut nearest = (period, self.period);
        if self.temp_fraction > 0 && matches!(self.pattern, Pattern::Mixed | Pattern::Each) {
            let nominal_temp = self.share_of_temp(self.period);
            for conversion in [(temp, nominal_temp), (period - temp, self.period - nominal_temp)] {
                if (gap - conversion.0).abs() < (gap - nearest.0).abs() {
                    nearest = conversion;
                }
            }
        }
        nearest
    }

    /// The difference from a regular gap up to which a gap counts as regular: 3/8 of a period. If edges announce one
    /// kind of update, a gap in which the kind changes must not count as regular. The limit is then 3/4 of the time
    /// that such a change adds or takes away.
    pub(super) fn nearness(&self, (period, temp): (i64, i64)) -> i64 {
        let shift = if matches!(self.pattern, Pattern::Steady) { temp.min(period - temp) } else { period >> 1 };
        3 * (shift >> 2)
    }

    /// Whether this sum of 256 absolute errors shows that the edges do not lie on the grid.
    ///
    /// Edges that lie anywhere are off by T/4 on average, or by T/8 if the nearest of two grid points is taken. The
    /// limits are T/6 and T/9. T/6 is two thirds of T/4, since the kind of the edges is not changed at once. T/9 is
    /// three standard deviations of a mean of 256 below T/8. Normal jitter reaches the limits with a standard
    /// deviation of 0.21·T and 0.14·T.
    pub(super) fn is_missed(&self, error_of_256: i64) -> bool {
        match self.pattern {
            Pattern::Mixed | Pattern::Each => 9 * error_of_256 > self.period << 8,
            Pattern::Steady | Pattern::Divided => 3 * error_of_256 > self.period << 7,
        }
    }
}

/// The kind of update that the edges announce: rate or temperature.
///
/// As long as the edges announce one kind, a deviation of up to half a period is jitter. The kind changes when the
/// host is late (F-33). Then all edges that follow deviate from the grid points of the old kind. With
/// [`Pattern::Steady`], a change is accepted at once if the jitter is small, otherwise after [`DOUBTS`] edges. With
/// the other patterns, a change is always accepted at once.
#[derive(Clone, Debug, Default)]
pub(super) struct EdgeKind {
    pub(super) is_rate: bool,
    doubts: u8,
    /// Mean absolute error of about 16 edges.
    jitter: i64,
}

/// Number of edges in a row that must lie nearer to the other grid point before they count as a change. Normal jitter
/// of T/9 puts one of 41 there, and eight in a row once in 10¹³ edges.
const DOUBTS: u8 = 8;

/// A change is accepted at once if the mean absolute error is at most T/48. With normal jitter of this size, an edge
/// is nearer to the other grid point, T/2 away, only if its deviation exceeds 9.6 standard deviations.
const SURE: i64 = 48;

impl EdgeKind {
    /// Assigns an edge to rate or temperature, and returns its distance from the grid point of that kind.
    pub(super) fn error(&mut self, grid: &EdgeGrid, (period, temp): (i64, i64), position: i64) -> i64 {
        let (own, to_other) = if self.is_rate { (position, -temp) } else { (position - temp, temp) };
        let own = wrapped(own, period);
        let other = wrapped(own + to_other, period);
        if own.abs() <= other.abs() {
            self.doubts = 0;
            self.jitter += (own.abs() - self.jitter) >> 4;
            return own;
        }
        self.doubts += 1;
        let sure = SURE * self.jitter <= grid.period;
        if matches!(grid.pattern, Pattern::Steady) && self.doubts < DOUBTS && !sure {
            return own;
        }
        self.is_rate = !self.is_rate;
        self.doubts = 0;
        other
    }
}

/// Adds or subtracts a period, so that the distance is at most half a period.
fn wrapped(distance: i64, period: i64) -> i64 {
    if 2 * distance > period {
        distance - period
    } else if 2 * distance < -period {
        distance + period
    } else {
        distance
    }
}
