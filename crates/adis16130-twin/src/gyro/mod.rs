//! The gyroscope in front of the converter: the rate and the temperature at any instant.

pub(crate) mod motion;
pub(crate) mod noise;
pub(crate) mod slow;
pub(crate) mod thermal;

use crate::facts;
use crate::normal::{Layers, Normal, Process};
use crate::spec::Spec;
use alloc::rc::Rc;
use noise::{Resonance, White};
use slow::Slow;

/// The analog side, sampled at the conversion instants.
pub(crate) struct Gyro {
    pub(crate) slow: Slow,
    white: White,
    resonance: Resonance,
    temperature: Normal,
    temp_noise_c_per_rt_hz: f64,
    temp_sd_c: f64,
    noise: bool,
    self_test_dps: f64,
    self_test: f64,
}

impl Gyro {
    pub(crate) fn new(spec: &Spec) -> Self {
        let layers = Rc::new(Layers::new());
        Self {
            slow: Slow::new(spec, slow::TICK_PS, &layers),
            white: White::new(spec, &layers),
            resonance: Resonance::new(spec),
            temperature: Normal::with_layers(spec.seed, Process::Temperature, &layers),
            temp_noise_c_per_rt_hz: spec.temp_noise_c_per_rt_hz,
            temp_sd_c: 0.0,
            noise: spec.noise,
            self_test_dps: spec.self_test_dps * (1.0 + spec.sensitivity_error),
            self_test: 0.0,
        }
    }

    /// Sets the sampling period. White temperature noise of density n has the standard deviation n/√(2·period).
    pub(crate) fn set_period_ps(&mut self, period_ps: u64) {
        let period_s = period_ps as f64 * 1e-12;
        self.temp_sd_c = self.temp_noise_c_per_rt_hz / libm::sqrt(2.0 * period_s);
    }

    pub(crate) fn set_self_test(&mut self, active: bool) {
        self.self_test = if active { self.self_test_dps } else { 0.0 };
    }

    /// The rate code at `t_ps`, before it is limited to 24 bits.
    #[inline]
    pub(crate) fn rate_code(&mut self, t_ps: u64) -> i64 {
        let mut dps = self.slow.rate_dps(t_ps) + self.self_test;
        if self.noise {
            dps += self.white.at(t_ps) + self.resonance.at(t_ps);
        }
        quantise(dps * facts::RATE_LSB_PER_DPS)
    }

    /// The temperature code at `t_ps`, before it is limited to 24 bits.
    #[inline]
    pub(crate) fn temp_code(&mut self, t_ps: u64) -> i64 {
        let mut c = self.slow.sensor_c(t_ps);
        if self.noise {
            c += self.temp_sd_c * self.temperature.sample();
        }
        quantise((c - facts::TEMP_AT_ZERO_CODE_C) * facts::TEMP_LSB_PER_C)
    }
}

/// Returns the code that is nearest to the zero code plus `lsb`.
#[inline]
fn quantise(lsb: f64) -> i64 {
    // `as i64` truncates, which rounds positive numbers down. BIAS makes the number positive.
    const BIAS: i64 = 1 << 40;
    (lsb + (BIAS as f64 + 0.5)) as i64 - BIAS + i64::from(facts::ZERO_CODE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantise_rounds_to_nearest() {
        for (lsb, code) in
            [(0.0, 0), (0.4, 0), (0.6, 1), (-0.4, 0), (-0.6, -1), (9.0e6, 9_000_000), (-9.0e6, -9_000_000)]
        {
            assert_eq!(quantise(lsb), code + (1 << 23), "{lsb}");
        }
    }
}
