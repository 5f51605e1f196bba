//! Controls the speed of simulated or replayed time.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// The initial speed of simulated or replayed time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// As fast as the reader accepts samples.
    Free,
    /// No faster than the wall clock.
    RealTime,
}

impl Pace {
    pub(crate) fn factor(self) -> f64 {
        match self {
            Self::Free => 0.0,
            Self::RealTime => 1.0,
        }
    }
}

/// The speed of simulated or replayed time, as a multiple of real time; 0 means as fast as the reader accepts
/// samples, and is the default. Clones share one speed, which may change at any time.
#[derive(Clone, Debug, Default)]
pub struct Speed(Arc<AtomicU64>);

impl Speed {
    /// The largest speed.
    pub const MOST: f64 = 1000.0;

    /// Sets the speed, limited to 0 … [`Speed::MOST`].
    pub fn set(&self, factor: f64) {
        let factor = if factor.is_nan() { 0.0 } else { factor.clamp(0.0, Self::MOST) };
        self.0.store(factor.to_bits(), Ordering::Relaxed);
    }

    /// The speed as a multiple of real time; 0 means as fast as the reader accepts samples.
    #[inline]
    #[must_use]
    pub fn factor(&self) -> f64 {
        f64::from_bits(self.bits())
    }

    /// Loads the bits with one relaxed access, which is cheap enough for every sample.
    #[inline]
    fn bits(&self) -> u64 {
        self.0.load(Ordering::Relaxed)
    }
}

pub(crate) trait Clock {
    /// Time since an arbitrary origin.
    fn now(&self) -> Duration;

    fn sleep(&self, time: Duration);
}

pub(crate) struct Monotonic(Instant);

impl Clock for Monotonic {
    fn now(&self) -> Duration {
        self.0.elapsed()
    }

    fn sleep(&self, time: Duration) {
        thread::sleep(time);
    }
}

/// Keeps the part's time from running faster than the speed allows. It looks at the wall clock about every [`PACE`].
pub(crate) struct WallClock<C = Monotonic> {
    clock: C,
    speed: Speed,
    /// The bits of the speed that has applied since `started`.
    bits: u64,
    /// Wall-clock time, and the part's time in ns, when this speed took effect.
    started: Option<(Duration, u64)>,
    due_ns: u64,
}

/// Wall-clock time between two checks of the clock, if the part's time keeps the speed.
const PACE: Duration = Duration::from_millis(10);
/// Longest delay until a stop or a higher speed takes effect.
const LONGEST_SLEEP: Duration = Duration::from_millis(100);

impl WallClock {
    pub fn new(speed: Speed) -> Self {
        Self::by(Monotonic(Instant::now()), speed)
    }
}

impl<C: Clock> WallClock<C> {
    fn by(clock: C, speed: Speed) -> Self {
        let bits = speed.bits();
        Self { clock, speed, bits, started: None, due_ns: 0 }
    }

    /// The part's time that passes in this wall-clock time, ns; `None` if the speed is not limited.
    pub fn part_ns(&self, wall: Duration) -> Option<u64> {
        let factor = self.speed.factor();
        (factor > 0.0).then_some((wall.as_nanos() as f64 * factor) as u64)
    }

    #[inline]
    pub fn keep(&mut self, t_ns: u64, is_over: impl Fn() -> bool) {
        if t_ns >= self.due_ns || self.speed.bits() != self.bits {
            self.wait(t_ns, is_over);
        }
    }

    fn wait(&mut self, t_ns: u64, is_over: impl Fn() -> bool) {
        let bits = self.speed.bits();
        if std::mem::replace(&mut self.bits, bits) != bits {
            self.started = None;
        }
        let factor = f64::from_bits(bits);
        let Some(step_ns) = self.part_ns(PACE) else {
            self.due_ns = u64::MAX;
            return;
        };
        let (wall, part_ns) = *self.started.get_or_insert_with(|| (self.clock.now(), t_ns));
        let target = wall + Duration::from_nanos((t_ns.saturating_sub(part_ns) as f64 / factor) as u64);
        while let Some(early) = target.checked_sub(self.clock.now()).filter(|early| !early.is_zero()) {
            if is_over() || self.speed.bits() != bits {
                break;
            }
            self.clock.sleep(early.min(LONGEST_SLEEP));
        }
        self.due_ns = t_ns.saturating_add(step_ns);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::Cell;

    /// A simulated clock that advances only when `sleep` is called.
    #[derive(Default)]
    struct Slept(Cell<Duration>);

    impl Clock for &Slept {
        fn now(&self) -> Duration {
            self.0.get()
        }

        fn sleep(&self, time: Duration) {
            self.0.set(self.0.get() + time);
        }
    }

    #[test]
    fn part_time_goes_as_fast_as_it_is_told() {
        let (clock, speed) = (Slept::default(), Speed::default());
        let mut wall = WallClock::by(&clock, speed.clone());
        let mut t_ns = 0;
        for (factor, takes_s) in [(1.0, 10.0), (50.0, 0.2), (0.0, 0.0), (0.001, 10_000.0), (2.5, 4.0)] {
            speed.set(factor);
            let begun = clock.0.get();
            for _ in 0..=10_000 {
                t_ns += 1_000_000;
                wall.keep(t_ns, || false);
            }
            let took_s = (clock.0.get() - begun).as_secs_f64();
            assert!((took_s - takes_s).abs() <= PACE.as_secs_f64(), "{factor}: {took_s} s");
        }
    }

    #[test]
    fn a_wish_to_end_or_another_speed_ends_a_wait() {
        let (clock, speed) = (Slept::default(), Speed::default());
        let mut wall = WallClock::by(&clock, speed.clone());
        speed.set(0.001);
        wall.keep(1, || false);
        wall.keep(1_000_000_000, || clock.0.get() > Duration::from_secs(1));
        assert!(clock.0.get() <= Duration::from_secs(1) + LONGEST_SLEEP, "{:?}", clock.0.get());
        let faster = || {
            speed.set(1000.0);
            false
        };
        wall.keep(2_000_000_000, faster);
        assert!(clock.0.get() <= Duration::from_secs(1) + 2 * LONGEST_SLEEP, "{:?}", clock.0.get());
    }

    #[test]
    fn a_speed_has_bounds() {
        let speed = Speed::default();
        for (asked, factor) in [(f64::NAN, 0.0), (-1.0, 0.0), (1e9, Speed::MOST), (2.5, 2.5)] {
            speed.set(asked);
            assert_eq!(speed.factor(), factor);
        }
    }
}
