//! Checks that the bridge's clock advances. Otherwise a capture, which ends by that clock, would never end.

use anyhow::{Result, ensure};
use std::time::Duration;

/// Time that the host spends waiting for samples between two checks of the bridge's clock.
const WINDOW: Duration = Duration::from_secs(2);
/// Largest allowed ratio of the host's waiting time to the bridge's time. An emulated bridge is within this limit.
const SLOWEST: u32 = 64;

#[derive(Debug, Default)]
pub struct Progress {
    /// Time of the first sample in the current check, ns.
    since_ns: Option<u64>,
    waited: Duration,
    samples: u64,
}

impl Progress {
    /// Adds a sample with the timestamp `t_ns`, for which the host waited for `waited`. Returns an error if the
    /// bridge's clock stands still or is more than [`SLOWEST`] times too slow.
    pub fn require(&mut self, t_ns: u64, waited: Duration) -> Result<()> {
        let since_ns = *self.since_ns.get_or_insert(t_ns);
        self.waited += waited;
        self.samples += 1;
        if self.waited < WINDOW {
            return Ok(());
        }
        let gone_on = Duration::from_nanos(u64::try_from(t_ns.wrapping_sub(since_ns) as i64).unwrap_or(0));
        ensure!(
            gone_on >= self.waited / SLOWEST,
            "the clock of the bridge does not run: {} samples came within {:.1} s, but by their time stamps only \
             {:.6} s went by; reset the bridge, and check the timer that stamps the edges in its firmware",
            self.samples,
            self.waited.as_secs_f64(),
            gone_on.as_secs_f64()
        );
        *self = Self::default();
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAIR: Duration = Duration::from_nanos(175_667);

    /// Adds samples whose timestamps are `step_ns` apart. Returns the index of the sample at which the clock counts as
    /// stopped; `None` if 100 000 samples pass.
    fn found_after(step_ns: u64, waited: Duration) -> Option<u32> {
        let mut progress = Progress::default();
        (0..100_000).find(|&k| {
            progress.require((u64::MAX - 5_000_000_000).wrapping_add(u64::from(k) * step_ns), waited).is_err()
        })
    }

    #[test]
    fn a_clock_that_stands_still_or_creeps_is_found_in_two_seconds() {
        for step_ns in [0, 1, 2_000] {
            let samples = found_after(step_ns, PAIR).expect("found");
            assert!((11_000..12_000).contains(&samples), "{step_ns} ns a sample: {samples}");
        }
    }

    #[test]
    fn a_slow_emulator_and_a_busy_host_are_tolerated() {
        assert_eq!(found_after(30_000, 8 * PAIR), None, "a bridge in an emulator, 47 times slower than real time");
        assert_eq!(found_after(175_667, Duration::ZERO), None, "a host that never waits, since it is late");
    }
}
