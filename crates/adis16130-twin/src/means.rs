//! Averages of a unit, computed without its converter and bus. They are hundreds of times faster than the twin.

use crate::gyro::slow::Slow;
use crate::normal::{Layers, Normal, Process};
use crate::spec::{Motion, Spec};
use crate::truth::Truth;
use alloc::rc::Rc;

/// The tick of the slow processes, in ps. Between two ticks, flicker and temperature are straight lines.
const TICK_PS: u64 = 100_000_000_000;

/// Averages of both channels over blocks that follow each other, from the moment of switching on.
///
/// White noise of one-sided density N (per √Hz) has the variance N²/(2T) in a mean over T, for the rate (F-02) and
/// the temperature (M-05). The resonance, the quantisation and the effects of a bus are left out. [`Spec`] defines
/// the unit. Its noise is another realisation than in [`Twin`](crate::Twin), since the tick is longer.
///
/// ```
/// use adis16130_twin::{Means, Spec};
///
/// let mut means = Means::new(&Spec { bias_dps: 0.8, ..Spec::from_seed(7) }, 10);
/// let second = means.next_mean();
/// assert_eq!(second.length_s, 1.0);
/// assert!((second.rate_dps - means.truth().bias_dps(second.temp_c)).abs() < 0.05);
/// ```
pub struct Means {
    spec: Spec,
    slow: Slow,
    white: Normal,
    temperature: Normal,
    ticks: u32,
    now_ps: u64,
}

/// The averages of both channels over a block.
#[derive(Copy, Clone, Debug, PartialEq)]
pub struct Mean {
    /// Start of the block, in s from power-on.
    pub start_s: f64,
    /// Length of the block, in s.
    pub length_s: f64,
    /// Rate at the output, in °/s.
    pub rate_dps: f64,
    /// Temperature as the part reports it, in °C.
    pub temp_c: f64,
}

impl Means {
    /// Switches a unit on. Each average covers a block of `ticks` times 0.1 s.
    #[must_use]
    pub fn new(spec: &Spec, ticks: u32) -> Self {
        let layers = Rc::new(Layers::new());
        Self {
            slow: Slow::new(spec, TICK_PS, &layers),
            white: Normal::with_layers(spec.seed, Process::Rate, &layers),
            temperature: Normal::with_layers(spec.seed, Process::Temperature, &layers),
            spec: spec.clone(),
            ticks: ticks.max(1),
            now_ps: 0,
        }
    }

    /// Returns the averages of the next block.
    pub fn next_mean(&mut self) -> Mean {
        let start_ps = self.now_ps;
        let (mut rate_dps, mut temp_c) = (0.0, 0.0);
        for _ in 0..self.ticks {
            let middle_ps = self.now_ps + TICK_PS / 2;
            rate_dps += self.slow.rate_dps(middle_ps);
            temp_c += self.slow.sensor_c(middle_ps);
            self.now_ps += TICK_PS;
        }
        let (count, length_s) = (f64::from(self.ticks), (self.now_ps - start_ps) as f64 * 1e-12);
        let (mut rate_noise, mut temp_noise) = (0.0, 0.0);
        if self.spec.noise {
            let per_rt_hz = 1.0 / libm::sqrt(2.0 * length_s);
            rate_noise = self.spec.white_dps_per_rt_hz * per_rt_hz * self.white.sample();
            temp_noise = self.spec.temp_noise_c_per_rt_hz * per_rt_hz * self.temperature.sample();
        }
        Mean {
            start_s: start_ps as f64 * 1e-12,
            length_s,
            rate_dps: rate_dps / count + rate_noise,
            temp_c: temp_c / count + temp_noise,
        }
    }

    /// The truth about the slow bias at the end of the last block.
    #[must_use]
    pub fn truth(&mut self) -> Truth {
        Truth::new(&self.spec, self.now_ps, &self.slow.at(self.now_ps))
    }

    /// Switches the supply off or on, so that the part cools or warms. The averages go on without supply, too.
    pub fn set_powered(&mut self, powered: bool) {
        self.slow.set_powered(powered, self.now_ps);
    }

    /// Changes the ambient temperature linearly to `temp_c`, in °C, within `over_s` seconds, as
    /// [`Twin::set_ambient`](crate::Twin::set_ambient) does. The change begins within 0.2 s.
    pub fn set_ambient(&mut self, temp_c: f64, over_s: f64) {
        self.slow.set_ambient(temp_c, over_s, self.now_ps);
    }

    /// Sets the motion of the platform. The change begins within 0.2 s.
    pub fn set_motion(&mut self, motion: Motion) {
        self.slow.platform.set_motion(motion, self.now_ps as f64 * 1e-12);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::facts;

    /// With white noise alone, the standard deviation of the means is N/√(2T) (F-02, M-05).
    #[test]
    fn means_have_the_noise_of_the_facts() {
        let quiet = Spec {
            flicker_floor_dps: 0.0,
            rrw_dps_per_rt_s: 0.0,
            warmup_c: 0.0,
            ambient_wander_c: 0.0,
            ..Spec::typical()
        };
        let mut means = Means::new(&quiet, 10);
        let (mut rate, mut temp) = (0.0, 0.0);
        let count = 4000;
        for _ in 0..count {
            let mean = means.next_mean();
            rate += mean.rate_dps * mean.rate_dps;
            temp += (mean.temp_c - 25.0) * (mean.temp_c - 25.0);
        }
        let sd = |sum: f64| libm::sqrt(sum / f64::from(count));
        assert!((sd(rate) / (facts::WHITE_DPS_PER_RT_HZ / libm::sqrt(2.0)) - 1.0).abs() < 0.04, "{}", sd(rate));
        assert!((sd(temp) / (facts::TEMP_NOISE_C_PER_RT_HZ / libm::sqrt(2.0)) - 1.0).abs() < 0.04, "{}", sd(temp));
    }

    #[test]
    fn means_follow_the_part() {
        let spec = Spec { noise: false, ..Spec::from_seed(3) };
        let mut means = Means::new(&spec, 10);
        let last = (0..3600).map(|_| means.next_mean()).last().unwrap();
        let twin = crate::Twin::new(spec);
        twin.advance_ns(3600 * 1_000_000_000);
        let (ours, truth) = (means.truth(), twin.truth());
        assert!((ours.sensor_c - truth.sensor_c).abs() < 1e-3, "{} {}", ours.sensor_c, truth.sensor_c);
        assert!((ours.bias_dps(last.temp_c) - truth.bias_dps(last.temp_c)).abs() < 1e-4);
        assert!((last.rate_dps - truth.bias_dps(last.temp_c)).abs() < 1e-4);
    }
}
