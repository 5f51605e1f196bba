//! Detection of readings that no longer change: a part that has stopped, while data ready goes on.

use crate::part::Reading;

/// Time without a change of the rate after which a part with noise is frozen, given [`FROZEN_READINGS`] repeats too.
const FROZEN_NS: u64 = 100_000_000;
/// Number of repeats of the last code that [`FROZEN_NS`] requires. Noise repeats a code with a probability below
/// 0.2, even in 16 bits and behind the filter of F-04. So this many repeats have a probability below 10⁻²².
const FROZEN_READINGS: u64 = 32;
/// A rate and a temperature that never change count as frozen after this time, and this many readings after the first.
const DEAD_NS: u64 = 2_000_000_000;
const DEAD_READINGS: u64 = 100;
/// Time after which a rate that has never changed counts as frozen, if there is no temperature.
const DEAD_ALONE_NS: u64 = 10_000_000_000;

/// The time since which the rate has not changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frozen {
    /// Time of the first reading with the present code of the rate, ns.
    pub since_ns: u64,
    /// Whether the temperature has stopped changing too.
    pub both: bool,
}

/// Looks for readings that no longer change. A real part changes its code at almost every reading. A simulation
/// without noise does not, so it counts as frozen only if neither its rate nor its temperature has ever changed.
#[derive(Clone, Copy, Debug, Default)]
pub struct Freeze {
    rate: Channel,
    temp: Channel,
}

#[derive(Clone, Copy, Debug, Default)]
struct Channel {
    code: i32,
    readings: u64,
    changes: u64,
    changed_ns: u64,
    /// Number of readings up to the last change.
    readings_at_change: u64,
}

impl Channel {
    #[inline]
    fn watch(&mut self, now_ns: u64, code: i32) {
        self.readings += 1;
        if code != self.code || self.changes == 0 {
            *self = Self {
                code,
                changes: self.changes + 1,
                changed_ns: now_ns,
                readings_at_change: self.readings,
                ..*self
            };
        }
    }

    fn is_noisy(&self) -> bool {
        self.changes > 20 && self.changes * 2 > self.readings_at_change
    }

    /// Whether the code has never changed. The first reading counts as a change.
    fn never_changed(&self) -> bool {
        self.changes <= 1
    }

    fn same_readings(&self) -> u64 {
        self.readings - self.readings_at_change
    }
}

impl Freeze {
    #[inline]
    pub fn watch(&mut self, reading: &Reading) -> Option<Frozen> {
        let now_ns = reading.t_ns;
        self.rate.watch(now_ns, reading.rate);
        if let Some(temp) = reading.temp {
            self.temp.watch(now_ns, temp);
        }
        if now_ns.saturating_sub(self.rate.changed_ns) < FROZEN_NS { None } else { self.judge(now_ns) }
    }

    /// Judges at the end of a record, by the number of repeats of the last code and not by their time.
    #[must_use]
    pub fn at_end(&self) -> Option<Frozen> {
        let same = self.rate.same_readings();
        let stopped = self.rate.is_noisy() && same >= FROZEN_READINGS;
        let dead = self.rate.never_changed() && self.temp.never_changed() && same >= DEAD_READINGS;
        (stopped || dead).then(|| self.frozen())
    }

    #[inline(never)]
    fn judge(&self, now_ns: u64) -> Option<Frozen> {
        let (same, same_ns) = (self.rate.same_readings(), now_ns - self.rate.changed_ns);
        let noisy = self.rate.is_noisy() || self.temp.is_noisy();
        let stopped = noisy && same >= FROZEN_READINGS;
        let never = self.rate.never_changed() && self.temp.never_changed() && same >= DEAD_READINGS;
        let dead_ns = if self.temp.readings > 0 { DEAD_NS } else { DEAD_ALONE_NS };
        (stopped || never && same_ns >= dead_ns).then(|| self.frozen())
    }

    fn frozen(&self) -> Frozen {
        Frozen { since_ns: self.rate.changed_ns, both: self.temp.same_readings() >= FROZEN_READINGS }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Time after which a part counts as frozen if it gives one code 100 times a second, s.
    fn frozen_after_s(temp: Option<i32>) -> u64 {
        let mut freeze = Freeze::default();
        let reading = |seq: u32| {
            let t_ns = u64::from(seq) * 10_000_000;
            Reading { t_ns, seq, rate: 5, temp, out_of_range: false, lost: 0 }
        };
        let first = (0..2000).find(|seq| freeze.watch(&reading(*seq)).is_some()).expect("frozen");
        u64::from(first) / 100
    }

    #[test]
    fn a_rate_alone_has_five_times_as_long_to_change() {
        assert_eq!((frozen_after_s(Some(7)), frozen_after_s(None)), (2, 10));
    }
}
