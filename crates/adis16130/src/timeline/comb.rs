//! Where edges can lie: what is known of them beforehand, and which tooth one is taken for.

use super::{FRACTION_BITS, LOOP_GEAR, TOP_GEAR};
use crate::quotient::quotient;

/// How the edges follow each other.
#[derive(Copy, Clone, Debug, PartialEq, Eq)]
enum Pattern {
    /// They keep to one kind of update, that of rate or that of temperature, as long as the host is prompt.
    Steady,
    /// They may announce any update.
    Mixed,
    /// They come from a counter that divides RDY: far apart, so that each has a phase of its own, and each is a tick.
    Divided,
}

/// When updates come, as far as it is known beforehand: those of rate at each tick, one of temperature in between.
#[derive(Clone, Debug)]
pub(crate) struct Comb {
    /// Nominal time from one tick to the next.
    pub(super) period: i64,
    /// Time from a tick to the temperature update after it, as a fraction of the period in 2⁻¹⁶; 0 = there is none.
    temp_fraction: i64,
    /// By how much an edge may come before its tick and still belong to it: an eighth of the time from the temperature
    /// update to it, which is more than MCLK, off by 2 %, makes of a period. Half a period where edges have a phase of
    /// their own.
    pub(super) margin: i64,
    pattern: Pattern,
}

/// The nominal period is at most 2³⁶ ns, 69 s, so that no sum over the errors of a check overflows.
const LONGEST_PERIOD: u64 = 1 << (36 + FRACTION_BITS);

impl Comb {
    /// The first argument has the conversion times of rate and temperature in MCLK cycles, 0 for a disabled channel.
    /// `steady` = edges keep to one kind of update.
    pub(crate) fn new((rate_cycles, temp_cycles): (u32, u32), mclk_hz: u32, steady: bool) -> Self {
        let pattern = if steady { Pattern::Steady } else { Pattern::Mixed };
        let cycles = u64::from((rate_cycles + temp_cycles).max(1));
        let period = quotient((cycles * 1_000_000_000) << FRACTION_BITS, mclk_hz.max(1_000).into()) as i64;
        let temp_fraction = quotient(u64::from(temp_cycles) << FRACTION_BITS, cycles) as i64;
        let mut comb = Self { period, temp_fraction, margin: 0, pattern };
        comb.margin = (period - comb.share_of_temp(period)) >> 3;
        comb
    }

    /// The comb of edges that come from a counter, in the mean so many periods of this one apart (a fraction).
    pub(crate) fn divided(self, numerator: u32, denominator: u32) -> Self {
        let ratio = quotient(u64::from(numerator) << FRACTION_BITS, denominator.into());
        let period = ((self.period >> FRACTION_BITS) as u64).saturating_mul(ratio).min(LONGEST_PERIOD) as i64;
        Self { period, temp_fraction: 0, margin: period >> 1, pattern: Pattern::Divided }
    }

    /// So many eighths of the nominal period, in whole ns.
    pub(crate) const fn nominal_eighths_ns(&self, eighths: u32) -> u64 {
        (self.period >> (FRACTION_BITS + 3)) as u64 * eighths as u64
    }

    pub(super) const fn is_divided(&self) -> bool {
        matches!(self.pattern, Pattern::Divided)
    }

    /// Divided edges have no phase to follow, only a period: T̂ is the mean of the gaps with a memory of 1/β edges,
    /// which in gear 5 is 2048 of them. Its noise is σ·β, that of the two ends of a gap.
    pub(super) const fn top_gear(&self) -> u32 {
        if self.is_divided() { LOOP_GEAR } else { TOP_GEAR }
    }

    /// Where the temperature tooth is with this period, to half a ns. A function of its own, for flash.
    #[inline(never)]
    pub(super) const fn share_of_temp(&self, period: i64) -> i64 {
        (period >> FRACTION_BITS) * self.temp_fraction
    }

    /// Periods in a run of edges none of which was followed by a read, after the first: a pair of conversions, then
    /// one each.
    pub(super) fn periods_of_edges(&self, edges: u32) -> u32 {
        if self.temp_fraction > 0 { edges.div_ceil(2) } else { edges }
    }

    /// A period brought into the lock range.
    pub(super) fn clamped(&self, period: i64) -> i64 {
        let sixteenth = self.period >> 4;
        period.max(self.period - sixteenth).min(self.period + sixteenth)
    }

    /// Which of the gaps between two neighbouring edges a gap is nearest to, as learned and nominal: a period or,
    /// where edges do not keep to one kind of update, a conversion.
    pub(super) fn nearest_gap(&self, (period, temp): (i64, i64), gap: i64) -> (i64, i64) {
        let mut nearest = (period, self.period);
        if matches!(self.pattern, Pattern::Mixed) {
            let nominal_temp = self.share_of_temp(self.period);
            for conversion in [(temp, nominal_temp), (period - temp, self.period - nominal_temp)] {
                if (gap - conversion.0).abs() < (gap - nearest.0).abs() {
                    nearest = conversion;
                }
            }
        }
        nearest
    }

    /// Whether so large a sum of 256 absolute errors shows that the edges do not lie on the comb.
    ///
    /// Edges that lie anywhere are T/4 off in the mean, or T/8 if the nearest of two teeth is taken. The limits are
    /// T/6 and T/9: two thirds of the one, since a tooth is believed for a while, and three standard deviations of a
    /// mean of 256 below the other. Normal jitter reaches them with a standard deviation of 0.21·T and 0.14·T.
    pub(super) fn is_missed(&self, error_of_256: i64) -> bool {
        match self.pattern {
            Pattern::Mixed => 9 * error_of_256 > self.period << 8,
            Pattern::Steady | Pattern::Divided => 3 * error_of_256 > self.period << 7,
        }
    }
}

/// Which kind of update the edges announce: that of rate, or that of temperature.
///
/// As long as they keep to one kind, a deviation of up to half a period is jitter. They change when the host is late
/// (F-33): then all edges that follow are off. That is believed at once if the jitter is small, or else after some
/// edges.
#[derive(Clone, Debug, Default)]
pub(super) struct Tooth {
    pub(super) on_rate: bool,
    doubts: u8,
    /// Mean absolute error of some 16 edges.
    jitter: i64,
}

/// So many edges in a row lie nearer to the other tooth before that is a change: normal jitter of T/9 puts one of 41
/// there, and eight in a row once in 10¹³ edges.
const DOUBTS: u8 = 8;

/// A change is believed at once where the mean absolute error is below T/48: with normal jitter of that size the other
/// tooth, T/4 away, is nearer by chance only beyond ten standard deviations.
const SURE: i64 = 48;

impl Tooth {
    /// The distance to the tooth that the edge is taken for.
    pub(super) fn error(&mut self, comb: &Comb, (period, temp): (i64, i64), position: i64) -> i64 {
        let (own, to_other) = if self.on_rate { (position, -temp) } else { (position - temp, temp) };
        let own = wrapped(own, period);
        let other = wrapped(own + to_other, period);
        if own.abs() <= other.abs() {
            self.doubts = 0;
            self.jitter += (own.abs() - self.jitter) >> 4;
            return own;
        }
        self.doubts += 1;
        let sure = SURE * self.jitter <= comb.period;
        if matches!(comb.pattern, Pattern::Steady) && self.doubts < DOUBTS && !sure {
            return own;
        }
        self.on_rate = !self.on_rate;
        self.doubts = 0;
        other
    }
}

/// A distance brought to within half a period.
fn wrapped(distance: i64, period: i64) -> i64 {
    if 2 * distance > period {
        distance - period
    } else if 2 * distance < -period {
        distance + period
    } else {
        distance
    }
}
