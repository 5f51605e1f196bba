//! Code that the examples share: the polled loop, the correction that was exported from `unit.toml`, and the pauses
//! between attempts to restart the part.

#![no_std]

pub mod polled;
/// The correction of a unit, written by `zerorate export unit.toml --format rust`.
pub mod unit;

/// Pauses between attempts to restart the part: 10 ms, doubled up to 1.28 s, so that a dead part leaves the bus free.
#[derive(Clone, Copy, Debug, Default)]
pub struct BackOff {
    doublings: u32,
}

impl BackOff {
    /// Makes a back-off that starts with the shortest pause.
    #[must_use]
    pub const fn new() -> Self {
        Self { doublings: 0 }
    }

    /// Returns the pause before the next attempt, ms.
    pub fn pause_ms(&mut self) -> u32 {
        let pause_ms = 10 << self.doublings;
        self.doublings = (self.doublings + 1).min(7);
        pause_ms
    }

    /// Returns to the shortest pause, once the part gives readings again.
    pub fn done(&mut self) {
        self.doublings = 0;
    }
}

/// Stands for the code that uses the rate. Takes a corrected rate code, and whether the calibration holds at the
/// temperature of the reading.
pub fn control(rate_code: u32, calibrated: bool) {
    core::hint::black_box((rate_code, calibrated));
}

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use adis16130_twin::{Fault, Spec, Twin};
    use std::panic::{AssertUnwindSafe, catch_unwind};

    #[test]
    fn attempts_become_rare() {
        let mut back_off = BackOff::new();
        assert_eq!([0; 9].map(|_| back_off.pause_ms()), [10, 20, 40, 80, 160, 320, 640, 1280, 1280]);
        back_off.done();
        assert_eq!(back_off.pause_ms(), 10);
    }

    /// After a brown-out the loop gives rates again. During the brown-out it gives none.
    #[test]
    fn the_polled_loop_comes_back() {
        let twin = Twin::new(Spec::from_seed(1));
        let (mut taken, mut last_ns, mut longest_ns) = (0, 0, 0);
        let control = |rate_code: u32, _| {
            assert!(rate_code.abs_diff(1 << 23) < 3 * 23_488, "at rest: {rate_code}");
            let now_ns = twin.now_ns();
            longest_ns = (now_ns - last_ns).max(longest_ns);
            last_ns = now_ns;
            taken += 1;
            match taken {
                300 | 500 => twin.set_fault(Fault::Brownout),
                1_000 => panic!("enough"),
                _ => twin.set_fault(Fault::None),
            }
        };
        let ended = catch_unwind(AssertUnwindSafe(|| polled::run(twin.spi(), twin.rdy(), twin.delay(), control)));
        assert_eq!(ended.unwrap_err().downcast_ref(), Some(&"enough"));
        assert!((10_000_000..100_000_000).contains(&longest_ns), "{longest_ns} ns without a rate");
    }
}
