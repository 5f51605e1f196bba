//! The ambient temperature of a simulated part over simulated time. The part pauses until the next segment is known.

use crate::Stop;
use adis16130_twin::Twin;
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

/// The ambient temperature of a simulated part ([`Setup`](crate::Setup)). Clones share one profile. The
/// [`ProfileWriter`] adds segments in order. After the first sample at or beyond the end of a segment, the part waits
/// for the next segment. So a measurement in a simulated chamber is reproducible, whatever the timing of the threads.
///
/// The part reads its first sample without any segment, and pauses before its second sample.
#[derive(Clone, Debug)]
pub struct AmbientProfile(Arc<Mutex<Receiver<Segment>>>);

/// A linear ramp from the current temperature.
#[derive(Clone, Copy, Debug)]
struct Segment {
    to_c: f64,
    until_ns: u64,
}

/// Adds segments to the profile. After it is dropped, the part keeps the temperature of the last segment.
#[derive(Debug)]
pub struct ProfileWriter(Sender<Segment>);

/// Longest delay until a stop is noticed.
const LONGEST_WAIT: Duration = Duration::from_millis(100);

impl AmbientProfile {
    /// Makes a profile that has no segment yet, and its writer.
    #[must_use]
    pub fn with_writer() -> (Self, ProfileWriter) {
        let (writer, segments) = channel();
        (Self(Arc::new(Mutex::new(segments))), ProfileWriter(writer))
    }

    /// Waits for the next segment. `None` if none is left and the profile is complete or a stop was requested.
    fn next(&self, stop: &Stop) -> Option<Segment> {
        let segments = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            match segments.recv_timeout(LONGEST_WAIT) {
                Ok(segment) => return Some(segment),
                Err(RecvTimeoutError::Timeout) if !stop.asked() => {}
                Err(_) => return None,
            }
        }
    }
}

impl ProfileWriter {
    /// Adds a linear ramp that reaches `to_c`, °C, at the part's time `until_ns`.
    pub fn ramp_to(&self, to_c: f64, until_ns: u64) {
        // an error means that the part is gone
        let _ = self.0.send(Segment { to_c, until_ns });
    }
}

pub(crate) struct ProfileFollower {
    profile: AmbientProfile,
    stop: Stop,
    until_ns: u64,
    /// Time of the last sample, ns; `None` before the first.
    last_ns: Option<u64>,
}

impl ProfileFollower {
    pub fn new(profile: AmbientProfile, stop: &Stop) -> Self {
        Self { profile, stop: stop.clone(), until_ns: 0, last_ns: None }
    }

    /// Call this before each sample. If the last sample is at or beyond the end of the segment, waits for the next
    /// segment and starts its ramp in all units. `first` gives the clock that all units share. The time of the last
    /// sample decides, not the clock, because the writer of the profile sees only samples.
    #[inline]
    pub fn before_sample<'a>(&mut self, first: &'a Twin, others: impl Iterator<Item = &'a Twin>) {
        if self.last_ns.is_some_and(|last_ns| last_ns >= self.until_ns) {
            self.wait(first.now_ns(), core::iter::once(first).chain(others));
        }
    }

    /// Call this after each sample.
    #[inline]
    pub fn after_sample(&mut self, t_ns: u64) {
        self.last_ns = Some(t_ns);
    }

    fn wait<'a>(&mut self, now_ns: u64, units: impl Iterator<Item = &'a Twin>) {
        let Some(segment) = self.profile.next(&self.stop) else {
            self.until_ns = u64::MAX;
            return;
        };
        let over_s = segment.until_ns.saturating_sub(now_ns) as f64 * 1e-9;
        units.for_each(|unit| unit.set_ambient(segment.to_c, over_s));
        self.until_ns = segment.until_ns.max(now_ns + 1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use adis16130_twin::Spec;

    fn after(follower: &mut ProfileFollower, twin: &Twin, ns: u64) {
        twin.advance_ns(ns);
        follower.after_sample(twin.now_ns());
    }

    #[test]
    fn a_part_reads_nothing_beyond_what_is_known() {
        let ((profile, writer), stop) = (AmbientProfile::with_writer(), Stop::default());
        let twin = Twin::new(Spec { noise: false, warmup_c: 0.0, ..Spec::from_seed(1) });
        let mut follower = ProfileFollower::new(profile, &stop);
        follower.before_sample(&twin, core::iter::empty());
        writer.ramp_to(35.0, 1_000_000_000);
        after(&mut follower, &twin, 1000);
        follower.before_sample(&twin, core::iter::empty());
        twin.advance_ns(500_000_000);
        assert!((twin.truth().ambient_c - 30.0).abs() < 0.1, "{:?}", twin.truth());
        after(&mut follower, &twin, 600_000_000);
        let waiting = std::thread::spawn(move || {
            std::thread::sleep(Duration::from_millis(20));
            writer.ramp_to(35.0, 5_000_000_000);
            writer
        });
        follower.before_sample(&twin, core::iter::empty());
        assert_eq!(follower.until_ns, 5_000_000_000);
        drop(waiting.join().expect("no panic"));
        after(&mut follower, &twin, 5_000_000_000);
        follower.before_sample(&twin, core::iter::empty());
        assert_eq!(follower.until_ns, u64::MAX, "no segment follows");
    }
}
