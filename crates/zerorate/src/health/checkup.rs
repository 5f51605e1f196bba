//! Checks whether a part at rest looks healthy, as the command `probe` does.

use super::judge::Judged;
use super::tally::Tally;
use crate::notice::Warning;
use crate::part::{Axis, CodeSum};
use alloc::vec::Vec;
use zerorate_allan::{self as allan, Gap, Input, Stat};

/// Collects the readings of some seconds at rest, and judges them.
///
/// ```
/// use zerorate::health::Health;
/// use zerorate::{Axis, Checkup, Reading, Tally};
/// let axis = Axis::ADIS16130;
/// let (mut checkup, mut health, mut tally) = (Checkup::default(), Health::new(&axis), Tally::default());
/// for i in 0..6000 {
///     let rate = [4_000, -4_000, 2_500, -2_500, 1_000][i as usize % 5]; // periodic, so not white noise
///     let t_ns = u64::from(i) * 175_667;
///     let reading = Reading { t_ns, seq: i, rate, temp: None, out_of_range: false, lost: 0 };
///     tally.count(&reading);
///     health.push(&reading).map(|judged| checkup.push(&judged));
/// }
/// let white = checkup.white_dps_per_rt_hz(&axis, tally.rate_hz()).unwrap();
/// let noise = Checkup::noise_warning(&axis, white).map(|warning| warning.code());
/// assert_eq!(noise, Some("quiet")); // the mean over 50 ms hardly changes
/// let warnings = checkup.warnings(&tally, Some(5692.6));
/// assert_eq!(warnings.iter().map(|warning| warning.code()).collect::<Vec<_>>(), ["no-temperature"]);
/// ```
#[derive(Clone, Debug, Default)]
pub struct Checkup {
    /// Rate codes less the zero code.
    rate_codes: Vec<i32>,
    /// Places and numbers of lost readings and invalid rates.
    gaps: Vec<Gap>,
    rates: CodeSum,
    temps: CodeSum,
}

impl Checkup {
    /// Adds a reading. Readings lost before it count as missing, and so does an invalid rate or temperature.
    pub fn push(&mut self, judged: &Judged) {
        self.skip(u64::from(judged.reading.lost));
        match judged.rate() {
            Some(rate) => {
                self.rate_codes.push(rate);
                self.rates.push(rate);
            }
            None => self.skip(1),
        }
        if let Some(temp) = judged.temp() {
            self.temps.push(temp);
        }
    }

    fn skip(&mut self, missing: u64) {
        match self.gaps.last_mut().filter(|gap| gap.at == self.rate_codes.len()) {
            _ if missing == 0 => {}
            Some(gap) => gap.missing += missing,
            None => self.gaps.push(Gap { at: self.rate_codes.len(), missing }),
        }
    }

    /// Mean of the valid rates, °/s. `None` if there are none.
    #[must_use]
    pub fn rate_dps(&self, axis: &Axis) -> Option<f64> {
        self.rates.mean(&axis.rate)
    }

    /// Mean of the valid temperatures, °C. `None` if there are none.
    #[must_use]
    pub fn temp_c(&self, axis: &Axis) -> Option<f64> {
        self.temps.mean(&axis.temp)
    }

    /// One-sided density d of the white noise, °/s/√Hz, from samples at `rate_hz`. The Allan deviation is d/√(2τ)
    /// at a τ well above the time constant of the part's filter. `None` if there are too few samples.
    #[must_use]
    pub fn white_dps_per_rt_hz(&self, axis: &Axis, rate_hz: f64) -> Option<f64> {
        let m = libm::round(WHITE_TAU_S * rate_hz) as u64;
        let scale = 1.0 / axis.rate.lsb_per_unit;
        // samples missing before the first one or after the last one do not make a gap
        let inner = self.gaps.iter().filter(|gap| gap.at > 0 && gap.at < self.rate_codes.len());
        let gaps: Vec<Gap> = inner.copied().collect();
        let codes = Input::Codes { codes: &self.rate_codes, gaps: &gaps };
        let point = allan::deviations(&codes, rate_hz, Stat::Oadev, &[m])[0].ok()?;
        Some(point.dev * scale * libm::sqrt(2.0 * m as f64 / rate_hz))
    }

    /// Warns if the measured white noise of this axis is below a quarter of the typical one, or above three times it.
    #[must_use]
    pub fn noise_warning(axis: &Axis, white_dps_per_rt_hz: f64) -> Option<Warning> {
        let ratio = white_dps_per_rt_hz / axis.noise?.white_dps_per_rt_hz;
        match ratio {
            ratio if ratio > MOST_NOISE => Some(Warning::Noisy { ratio }),
            ratio if ratio < LEAST_NOISE => Some(Warning::Quiet { ratio }),
            _ => None,
        }
    }

    /// The warnings about losses, a sample rate that is more than 5 % off, and temperature. `nominal_hz` is the
    /// expected rate, if it is known.
    #[must_use]
    pub fn warnings(&self, tally: &Tally, nominal_hz: Option<f64>) -> Vec<Warning> {
        let rate_hz = tally.rate_hz();
        let is_off = |nominal_hz: &f64| (rate_hz / nominal_hz - 1.0).abs() > RATE_ERROR;
        let found = [
            (tally.lost > 0 && !tally.data_ready_stutters()).then_some(Warning::Losing { lost: tally.lost }),
            nominal_hz.filter(is_off).map(|nominal_hz| Warning::RateOff { rate_hz, nominal_hz }),
            (self.temps.count() == 0).then_some(Warning::NoTemperature { wrong_edge: tally.hears_wrong_edge() }),
        ];
        found.into_iter().flatten().collect()
    }
}

/// Averaging time for the white noise, s: long compared with the filter (F-03, F-04), short for flicker and drift.
const WHITE_TAU_S: f64 = 0.05;
/// Least white noise of a healthy part, as a ratio to the typical one. A quieter part probably does not measure.
const LEAST_NOISE: f64 = 0.25;
/// Largest white noise of a healthy part, as a ratio to the typical one.
const MOST_NOISE: f64 = 3.0;
/// Largest relative error of the sample rate. It covers an ADIS16130 with a clock of 6.000 or 6.144 MHz (F-31).
const RATE_ERROR: f64 = 0.05;

#[cfg(test)]
mod tests {
    use super::super::judge::Flags;
    use super::*;
    use crate::part::Reading;

    /// Independent codes of ±1000: their density is √(2 / rate) times their size.
    #[test]
    fn the_density_of_white_noise() {
        let axis = Axis::ADIS16130;
        let mut state = 7u32;
        let mut code = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            if state >> 31 == 0 { 1000 } else { -1000 }
        };
        let checkup = Checkup { rate_codes: (0..100_000).map(|_| code()).collect(), ..Checkup::default() };
        let expected = 1000.0 / axis.rate.lsb_per_unit * (2.0f64 / 1000.0).sqrt();
        let found = checkup.white_dps_per_rt_hz(&axis, 1000.0).unwrap();
        assert!((found / expected - 1.0).abs() < 0.1, "{found} instead of {expected}");
    }

    #[test]
    fn lost_readings_make_a_gap() {
        let mut checkup = Checkup::default();
        for (seq, lost) in [(0, 0), (4, 3), (5, 0)] {
            let reading = Reading { t_ns: 0, seq, rate: 0, temp: None, out_of_range: false, lost };
            checkup.push(&Judged { reading, flags: Flags::default() });
        }
        assert_eq!(checkup.rate_codes.len(), 3);
        assert_eq!(checkup.gaps, [Gap { at: 1, missing: 3 }]);
    }

    #[test]
    fn a_sample_rate_is_off_beyond_the_limit() {
        let mut tally = Tally::default();
        for seq in 0..1_001 {
            let t_ns = u64::from(seq) * 1_000_000;
            tally.count(&Reading { t_ns, seq, rate: 0, temp: None, out_of_range: false, lost: 0 });
        }
        let is_off = |nominal_hz: f64| {
            let warnings = Checkup::default().warnings(&tally, Some(nominal_hz));
            warnings.iter().any(|warning| matches!(warning, Warning::RateOff { .. }))
        };
        assert_eq!([940.0, 960.0, 1_000.0, 1_040.0, 1_070.0].map(is_off), [true, false, false, false, true]);
    }
}
