//! The air around a simulated part, which waits on its own simulated time until it is known where the air goes.

use crate::Stop;
use adis16130_twin::Twin;
use std::collections::VecDeque;
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Air that is given to a simulated part ([`Setup`](crate::Setup)); its clones are the same air. Its [`Lead`] says
/// where it goes, a stretch of time after the other, and the part reads no sample that lies beyond what was said. So a
/// measurement in a simulated chamber is the same each time, however fast the threads are.
///
/// The first sample comes before anything was said, and the part waits with the second.
#[derive(Clone, Debug, Default)]
pub struct Air(Arc<Course>);

#[derive(Debug, Default)]
struct Course {
    known: Mutex<Known>,
    changed: Condvar,
}

#[derive(Debug, Default)]
struct Known {
    legs: VecDeque<Leg>,
    /// Nobody leads any more.
    ended: bool,
}

/// A straight line from where the air is.
#[derive(Clone, Copy, Debug)]
struct Leg {
    to_c: f64,
    until_ns: u64,
}

/// The lead that says where the air goes. When it is dropped, the air stays and the part goes on.
#[derive(Debug)]
pub struct Lead(Air);

/// A stop is heeded at least this often.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

impl Air {
    fn known(&self) -> std::sync::MutexGuard<'_, Known> {
        self.0.known.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The next leg; none where there will be none, or a stop was asked.
    fn next(&self, stop: &Stop) -> Option<Leg> {
        let mut known = self.known();
        loop {
            if let Some(leg) = known.legs.pop_front() {
                return Some(leg);
            }
            if known.ended || stop.asked() {
                return None;
            }
            let waited = self.0.changed.wait_timeout(known, LONGEST_WAIT).unwrap_or_else(PoisonError::into_inner);
            known = waited.0;
        }
    }

    /// Makes the lead that says where the air goes.
    #[must_use]
    pub fn lead(&self) -> Lead {
        Lead(self.clone())
    }
}

impl Lead {
    /// The air goes in a straight line to a temperature, °C, which it reaches at this time of the part, ns.
    pub fn go(&self, to_c: f64, until_ns: u64) {
        self.0.known().legs.push_back(Leg { to_c, until_ns });
        self.0.0.changed.notify_all();
    }
}

impl Drop for Lead {
    fn drop(&mut self) {
        self.0.known().ended = true;
        self.0.0.changed.notify_all();
    }
}

/// The part's side of its air.
pub(crate) struct Follower {
    air: Air,
    stop: Stop,
    until_ns: u64,
    /// Time of the last sample, if there was one.
    last_ns: Option<u64>,
}

impl Follower {
    pub fn new(air: Air, stop: &Stop) -> Self {
        Self { air, stop: stop.clone(), until_ns: 0, last_ns: None }
    }

    /// To be called before each sample of the units, whose clock the first has. It waits behind a sample that is late
    /// enough, at any time of the clock: the lead of the air has seen samples, and no clock.
    #[inline]
    pub fn keep<'a>(&mut self, first: &'a Twin, others: impl Iterator<Item = &'a Twin>) {
        if self.last_ns.is_some_and(|last_ns| last_ns >= self.until_ns) {
            self.wait(first.now_ns(), core::iter::once(first).chain(others));
        }
    }

    /// To be called with the time of each sample.
    #[inline]
    pub fn took(&mut self, t_ns: u64) {
        self.last_ns = Some(t_ns);
    }

    fn wait<'a>(&mut self, now_ns: u64, units: impl Iterator<Item = &'a Twin>) {
        let Some(leg) = self.air.next(&self.stop) else {
            self.until_ns = u64::MAX;
            return;
        };
        let over_s = leg.until_ns.saturating_sub(now_ns) as f64 * 1e-9;
        units.for_each(|unit| unit.set_ambient(leg.to_c, over_s));
        self.until_ns = leg.until_ns.max(now_ns + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130_twin::Spec;

    fn after(follower: &mut Follower, twin: &Twin, ns: u64) {
        twin.advance_ns(ns);
        follower.took(twin.now_ns());
    }

    #[test]
    fn a_part_reads_nothing_beyond_what_is_known() {
        let (air, stop) = (Air::default(), Stop::default());
        let lead = air.lead();
        let twin = Twin::new(Spec { noise: false, warmup_c: 0.0, ..Spec::from_seed(1) });
        let mut follower = Follower::new(air, &stop);
        follower.keep(&twin, core::iter::empty());
        lead.go(35.0, 1_000_000_000);
        after(&mut follower, &twin, 1000);
        follower.keep(&twin, core::iter::empty());
        twin.advance_ns(500_000_000);
        assert!((twin.truth().ambient_c - 30.0).abs() < 0.1, "{:?}", twin.truth());
        after(&mut follower, &twin, 600_000_000);
        let waiting = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(20));
            lead.go(35.0, 5_000_000_000);
            lead
        });
        follower.keep(&twin, core::iter::empty());
        assert_eq!(follower.until_ns, 5_000_000_000);
        drop(waiting.join().expect("no panic"));
        after(&mut follower, &twin, 5_000_000_000);
        follower.keep(&twin, core::iter::empty());
        assert_eq!(follower.until_ns, u64::MAX, "nobody leads any more");
    }
}
