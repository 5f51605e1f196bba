//! Judges which readings of a stream are valid.

use super::freeze::{Freeze, Frozen};
use super::plausible::{Plausible, Verdict};
use crate::part::{Axis, Reading};
use core::fmt;

/// The faults of a reading. A valid reading has none. `Display` names them, for scripts: `impossible+frozen`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flags(u8);

impl Flags {
    /// No fault.
    pub const NONE: Self = Self(0);
    /// The part cannot have measured this rate, given the readings next to it: a bit error.
    pub const IMPOSSIBLE: Self = Self(1);
    /// The rate is beyond the range of the converter (F-35).
    pub const OUT_OF_RANGE: Self = Self(2);
    /// The readings have stopped changing.
    pub const FROZEN: Self = Self(4);
    /// The temperature differs too much from those before it, or the first from those after it: a bit error.
    pub const IMPOSSIBLE_TEMP: Self = Self(8);

    const NAMES: [(Self, &str); 4] = [
        (Self::IMPOSSIBLE, "impossible"),
        (Self::OUT_OF_RANGE, "out-of-range"),
        (Self::FROZEN, "frozen"),
        (Self::IMPOSSIBLE_TEMP, "impossible-temperature"),
    ];

    /// The flags as a number: 1 impossible, 2 out of range, 4 frozen, 8 temperature impossible.
    #[must_use]
    pub fn bits(self) -> u8 {
        self.0
    }

    /// The union of two sets of flags.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Whether all flags of `other` are set.
    #[must_use]
    pub fn has(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// Whether the rate is valid.
    #[must_use]
    pub fn rate_is_good(self) -> bool {
        self.0 & (Self::IMPOSSIBLE.0 | Self::OUT_OF_RANGE.0 | Self::FROZEN.0) == 0
    }

    /// Whether the temperature, if one was read, is valid.
    #[must_use]
    pub fn temp_is_good(self) -> bool {
        self.0 & Self::IMPOSSIBLE_TEMP.0 == 0
    }
}

impl fmt::Display for Flags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut names = Self::NAMES.iter().filter(|(flag, _)| self.has(*flag)).map(|(_, name)| name);
        names.next().map_or(Ok(()), |first| f.write_str(first))?;
        names.try_for_each(|name| write!(f, "+{name}"))
    }
}

/// A reading with its faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Judged {
    /// The reading, untouched.
    pub reading: Reading,
    /// The faults of the reading.
    pub flags: Flags,
}

impl Judged {
    /// Code of the rate less the zero code, if the rate is valid.
    #[must_use]
    #[inline]
    pub fn rate(&self) -> Option<i32> {
        self.flags.rate_is_good().then_some(self.reading.rate)
    }

    /// Code of the temperature less the zero code, if one was read and is valid.
    #[must_use]
    #[inline]
    pub fn temp(&self) -> Option<i32> {
        self.reading.temp.filter(|_| self.flags.temp_is_good())
    }

    pub(crate) fn is_faulty(&self) -> bool {
        self.flags.has(Flags::IMPOSSIBLE) || self.flags.has(Flags::IMPOSSIBLE_TEMP)
    }
}

/// Number of readings with each fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FaultCounts {
    /// Rates that the part cannot have measured.
    pub impossible: u64,
    /// Rates beyond the range.
    pub out_of_range: u64,
    /// Readings after the part had stopped.
    pub frozen: u64,
    /// Temperatures with a bit error, as in [`Flags::IMPOSSIBLE_TEMP`].
    pub impossible_temps: u64,
    /// Rates that could not be judged: readings beside them are missing or too far in time, or limits are not known.
    pub unjudged: u64,
}

impl FaultCounts {
    /// Number of impossible rates and temperatures. No mean includes them.
    #[must_use]
    pub fn faulty(&self) -> u64 {
        self.impossible + self.impossible_temps
    }
}

/// Judges a stream of readings of one axis, and returns each reading with its faults, two readings late.
///
/// [`plausible`](crate::health::plausible) says what counts as impossible, and how often that is a false alarm.
///
/// ```
/// use zerorate::health::{Flags, Health};
/// use zerorate::{Axis, Reading};
/// let mut health = Health::new(&Axis::ADIS16130);
/// for k in 0..20 {
///     let rate = if k == 10 { 1 << 18 } else { k as i32 % 3 };
///     let (t_ns, temp) = (u64::from(k) * 175_667, None);
///     let reading = Reading { t_ns, seq: k, rate, temp, out_of_range: false, lost: 0 };
///     if let Some(judged) = health.push(&reading) {
///         assert_eq!(judged.flags == Flags::IMPOSSIBLE, judged.reading.seq == 10);
///     }
/// }
/// while health.finish().is_some() {}
/// assert_eq!(health.fault_counts().impossible, 1);
/// ```
#[derive(Clone, Debug)]
pub struct Health {
    plausible: Plausible,
    freeze: Freeze,
    frozen: Option<Frozen>,
    fault_counts: FaultCounts,
}

impl Health {
    /// Makes a judge for readings of this axis.
    #[must_use]
    pub fn new(axis: &Axis) -> Self {
        let fault_counts = FaultCounts::default();
        Self { plausible: Plausible::new(axis), freeze: Freeze::default(), frozen: None, fault_counts }
    }

    /// Whether enough is known of the axis (range, bandwidth, noise) to tell impossible rates from motion.
    #[must_use]
    pub fn can_judge(&self) -> bool {
        self.plausible.has_limits()
    }

    /// Takes a reading in, and returns the reading that came two before it.
    #[inline]
    pub fn push(&mut self, reading: &Reading) -> Option<Judged> {
        self.frozen = self.freeze.watch(reading);
        let judged = self.plausible.push(reading);
        judged.map(|(reading, finding)| self.judged(reading, finding.rate, finding.temp_impossible))
    }

    /// Returns the next waiting reading, judged by the neighbours that it has. Call this at the end of a record,
    /// or where a mean ends.
    pub fn finish(&mut self) -> Option<Judged> {
        let judged = self.plausible.early();
        judged.map(|(reading, finding)| self.judged(reading, finding.rate, finding.temp_impossible))
    }

    /// Number of readings that are not returned yet: two at most.
    #[must_use]
    pub fn waiting(&self) -> u64 {
        self.plausible.waiting as u64
    }

    /// The time since which the part has been frozen. `None` if it is not frozen.
    #[must_use]
    pub fn frozen(&self) -> Option<Frozen> {
        self.frozen
    }

    /// Like [`Health::frozen`], but at the end of a record, where a shorter time without change is enough.
    #[must_use]
    pub fn frozen_at_end(&self) -> Option<Frozen> {
        self.frozen.or_else(|| self.freeze.at_end())
    }

    /// Counts of the faults so far.
    #[must_use]
    pub fn fault_counts(&self) -> &FaultCounts {
        &self.fault_counts
    }

    #[inline]
    fn judged(&mut self, reading: Reading, rate: Verdict, temp_impossible: bool) -> Judged {
        if rate == Verdict::Possible && !temp_impossible && self.frozen.is_none() {
            return Judged { reading, flags: Flags::NONE };
        }
        self.flagged(reading, rate, temp_impossible)
    }

    #[inline(never)]
    fn flagged(&mut self, reading: Reading, rate: Verdict, temp_impossible: bool) -> Judged {
        let (counts, mut flags) = (&mut self.fault_counts, Flags::NONE);
        let mut note = |applies: bool, count: &mut u64, flag: Flags| {
            *count += u64::from(applies);
            flags = if applies { flags.and(flag) } else { flags };
        };
        note(rate == Verdict::Impossible, &mut counts.impossible, Flags::IMPOSSIBLE);
        note(rate == Verdict::OutOfRange, &mut counts.out_of_range, Flags::OUT_OF_RANGE);
        note(rate == Verdict::Unjudged, &mut counts.unjudged, Flags::NONE);
        note(temp_impossible, &mut counts.impossible_temps, Flags::IMPOSSIBLE_TEMP);
        let frozen = self.frozen.is_some_and(|frozen| reading.t_ns >= frozen.since_ns);
        note(frozen, &mut counts.frozen, Flags::FROZEN);
        Judged { reading, flags }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn flags_have_names_for_scripts() {
        assert_eq!(std::format!("{}", Flags::NONE), "");
        assert_eq!(std::format!("{}", Flags::IMPOSSIBLE.and(Flags::FROZEN)), "impossible+frozen");
        assert!(Flags::IMPOSSIBLE_TEMP.rate_is_good() && !Flags::IMPOSSIBLE_TEMP.temp_is_good());
    }
}
