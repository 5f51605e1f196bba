//! A rate limit.

use std::time::{Duration, Instant};

/// A token bucket: it allows `most` actions at once, and `per_s` actions per second in the long run.
#[derive(Debug)]
pub struct Bucket {
    most: f64,
    per_s: f64,
    left: f64,
    at: Instant,
}

impl Bucket {
    pub fn new(most: u32, per_s: f64, now: Instant) -> Self {
        Self { most: most.into(), per_s, left: most.into(), at: now }
    }

    pub fn has_one(&mut self, now: Instant) -> bool {
        self.fill(now);
        self.left >= 1.0
    }

    /// Counts an action, or returns the time until an action is allowed.
    pub fn take(&mut self, now: Instant) -> Result<(), Duration> {
        self.fill(now);
        if self.left < 1.0 {
            return Err(Duration::from_secs_f64((1.0 - self.left) / self.per_s));
        }
        self.left -= 1.0;
        Ok(())
    }

    /// Counts an action in any case, and returns the time at which all counted actions are allowed.
    pub fn borrow(&mut self, now: Instant) -> Instant {
        self.fill(now);
        self.left -= 1.0;
        now + Duration::from_secs_f64((-self.left).max(0.0) / self.per_s)
    }

    fn fill(&mut self, now: Instant) {
        let passed_s = now.saturating_duration_since(self.at).as_secs_f64();
        self.left = (self.left + passed_s * self.per_s).min(self.most);
        self.at = self.at.max(now);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_burst_is_allowed_and_then_a_rate() {
        let began = Instant::now();
        let at = |ms| began + Duration::from_millis(ms);
        let mut bucket = Bucket::new(3, 10.0, began);
        assert!((0..3).all(|_| bucket.take(at(0)).is_ok()));
        assert_eq!(bucket.take(at(0)), Err(Duration::from_millis(100)));
        assert_eq!(bucket.take(at(100)), Ok(()));
        assert!(bucket.take(at(150)).is_err());
        // the bucket holds no more than a burst, however long it was not used
        assert_eq!((0..10).filter(|_| bucket.take(at(3_600_000)).is_ok()).count(), 3);
        // a thread may hand in a time that it took before another thread's
        let mut shared = Bucket::new(1, 10.0, at(100));
        assert!(shared.take(at(100)).is_ok() && shared.take(at(0)).is_err() && shared.take(at(150)).is_err());
        let mut patient = Bucket::new(2, 10.0, began);
        let mut now = began;
        for _ in 0..12 {
            now = patient.borrow(now);
        }
        assert_eq!(now, at(1000), "two at once, and ten in a second");
    }
}
