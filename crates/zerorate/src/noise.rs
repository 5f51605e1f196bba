//! The effect of noise on means over windows: the covariance of any two weighted sums of window means.

use alloc::vec::Vec;
use core::f64::consts::{LN_2, PI};
use zerorate_allan::FLOOR_PER_B;

/// Lowest frequency of the flicker noise, Hz (M-04).
pub const FLICKER_CUTOFF_HZ: f64 = 1e-4;

/// Highest frequency of modelled flicker, Hz. Above 0.012 Hz, the flicker is below the white noise of F-02.
const FLICKER_TOP_HZ: f64 = 10.0;
/// Number of first-order processes that make up the 1/f spectrum: two per octave.
const CELLS: usize = 34;

/// White noise, flicker noise and rate random walk, as they appear at the output.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseModel {
    /// One-sided density of the white noise, °/s/√Hz: a mean over T has the variance d²/(2T).
    pub white_dps_per_rt_hz: f64,
    /// Flicker: bias instability B, °/s, one-sided density B²/(πf) above [`FLICKER_CUTOFF_HZ`] (IEEE Std 952-1997
    /// C.1.3, whose density is two-sided). Its Allan deviation alone is flat at 0.664 B.
    pub bias_instability_dps: f64,
    /// Rate random walk K, °/s/√s: the variance of a change over T is K²T.
    pub rate_random_walk_dps_per_rt_s: f64,
}

impl NoiseModel {
    /// Allan variance at τ, (°/s)²: N²/τ + (2 ln 2/π) B² + K²τ/3 with N² = d²/2 (IEEE Std 952-1997 C.1).
    #[must_use]
    pub fn allan_variance(&self, tau_s: f64) -> f64 {
        let k = self.rate_random_walk_dps_per_rt_s;
        square(self.white_dps_per_rt_hz) / (2.0 * tau_s)
            + square(FLOOR_PER_B * self.bias_instability_dps)
            + k * k * tau_s / 3.0
    }

    /// Averaging time with the least Allan variance, s: √1.5 d/K with the white density d. Infinite if only K is 0.
    #[must_use]
    pub fn best_averaging_s(&self) -> f64 {
        libm::sqrt(1.5) * self.white_dps_per_rt_hz / self.rate_random_walk_dps_per_rt_s
    }

    /// Covariance of two weighted sums of window means, (°/s)².
    ///
    /// The level of a random walk has no finite variance. So unless K is zero, the weights of each sum must add up
    /// to zero: the sum is then a change between levels, not a level.
    #[must_use]
    pub fn covariance(&self, a: &[WeightedMean], b: &[WeightedMean]) -> f64 {
        let kernel = Kernel::new(self);
        let pairs = a.iter().flat_map(|first| b.iter().map(move |second| (first, second)));
        pairs.map(|(first, second)| kernel.covariance_of_means(first, second)).sum()
    }

    /// Standard deviation of a weighted sum of window means, °/s.
    #[must_use]
    pub fn sd(&self, windows: &[WeightedMean]) -> f64 {
        libm::sqrt(self.covariance(windows, windows).max(0.0))
    }

    /// Lower triangle of the covariance matrix of means over windows of whole seconds, (°/s)². The windows follow
    /// each other without overlap. The random walk starts from zero at second 0.
    #[must_use]
    pub(crate) fn covariances(&self, windows: &[Window]) -> Vec<Vec<f64>> {
        let (first, last) = (windows.first().map_or(0, |s| s.start_s), windows.last().map_or(0, |s| s.end_s));
        let steady = Kernel::new(&self.without_random_walk());
        let kernel: Vec<f64> = (0..=last - first).map(|lag_s| steady.at(f64::from(lag_s))).collect();
        let walk = square(self.rate_random_walk_dps_per_rt_s);
        let covariance = |a: &Window, b: &Window| {
            let at = |x: u32, y: u32| kernel[x.abs_diff(y) as usize];
            let second_difference =
                at(a.end_s, b.start_s) - at(a.start_s, b.start_s) - at(a.end_s, b.end_s) + at(a.start_s, b.end_s);
            let shared_s = if a == b { f64::from(a.start_s) + a.length_s() / 3.0 } else { b.middle_s() };
            second_difference / (a.length_s() * b.length_s()) + walk * shared_s
        };
        windows.iter().enumerate().map(|(i, a)| windows[..=i].iter().map(|b| covariance(a, b)).collect()).collect()
    }

    /// Returns the model without its random walk. A single mean needs it: the level of a random walk has no finite
    /// variance, but a change between means has one.
    #[must_use]
    pub fn without_random_walk(self) -> Self {
        Self { rate_random_walk_dps_per_rt_s: 0.0, ..self }
    }
}

/// The mean over an interval of time, with its weight in a sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WeightedMean {
    /// Start, s.
    pub start_s: f64,
    /// End, s. It is after the start.
    pub end_s: f64,
    /// Factor of this mean in the sum.
    pub weight: f64,
}

/// A window of whole seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    pub(crate) start_s: u32,
    pub(crate) end_s: u32,
}

impl Window {
    pub(crate) fn length_s(&self) -> f64 {
        f64::from(self.end_s - self.start_s)
    }

    fn middle_s(&self) -> f64 {
        f64::from(self.start_s) + self.length_s() / 2.0
    }
}

/// The twice integrated autocovariance G (G'' = R, even). Second differences of G are covariances of window means.
struct Kernel {
    white: f64,
    walk: f64,
    flicker: [Process; CELLS],
}

/// A stationary first-order process of the 1/f sum.
struct Process {
    variance: f64,
    rate_per_s: f64,
}

impl Kernel {
    fn new(model: &NoiseModel) -> Self {
        Self {
            white: square(model.white_dps_per_rt_hz) / 4.0,
            walk: square(model.rate_random_walk_dps_per_rt_s) / 12.0,
            flicker: flicker_processes(model.bias_instability_dps),
        }
    }

    fn covariance_of_means(&self, a: &WeightedMean, b: &WeightedMean) -> f64 {
        let second_difference =
            self.at(a.end_s - b.start_s) - self.at(a.start_s - b.start_s) - self.at(a.end_s - b.end_s)
                + self.at(a.start_s - b.end_s);
        a.weight * b.weight * second_difference / ((a.end_s - a.start_s) * (b.end_s - b.start_s))
    }

    fn at(&self, lag_s: f64) -> f64 {
        let lag_s = lag_s.abs();
        let flicker: f64 = self.flicker.iter().map(|process| process.kernel(lag_s)).sum();
        self.white * lag_s - self.walk * lag_s * lag_s * lag_s + flicker
    }
}

impl Process {
    fn kernel(&self, lag_s: f64) -> f64 {
        let x = self.rate_per_s * lag_s;
        self.variance * (libm::expm1(-x) + x) / square(self.rate_per_s)
    }
}

/// Returns the processes of the flicker noise, one for each of the cells that divide the logarithm of the frequency
/// evenly. The corner is at the middle of its cell, and the variance is the integral of S(f) = B²/(πf) over the cell.
fn flicker_processes(bias_instability_dps: f64) -> [Process; CELLS] {
    let octaves_per_cell = libm::log2(FLICKER_TOP_HZ / FLICKER_CUTOFF_HZ) / CELLS as f64;
    let variance = square(bias_instability_dps) / PI * LN_2 * octaves_per_cell;
    core::array::from_fn(|k| {
        let corner_hz = FLICKER_CUTOFF_HZ * libm::exp2((k as f64 + 0.5) * octaves_per_cell);
        Process { variance, rate_per_s: 2.0 * PI * corner_hz }
    })
}

fn square(x: f64) -> f64 {
    x * x
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::part::Axis;

    /// Standard normal numbers: sums of twelve uniform ones.
    pub(crate) struct Normal(pub(crate) u64);

    impl Normal {
        pub(crate) fn next(&mut self) -> f64 {
            let mut uniform = || {
                self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.0 >> 11) as f64 / (1u64 << 53) as f64
            };
            (0..12).map(|_| uniform()).sum::<f64>() - 6.0
        }
    }

    fn only(white: f64, b: f64, k: f64) -> NoiseModel {
        NoiseModel { white_dps_per_rt_hz: white, bias_instability_dps: b, rate_random_walk_dps_per_rt_s: k }
    }

    fn window(start_s: f64, end_s: f64, weight: f64) -> WeightedMean {
        WeightedMean { start_s, end_s, weight }
    }

    /// Two adjacent means of τ: half the variance of their difference is the Allan variance.
    fn allan_by_windows(model: &NoiseModel, tau_s: f64) -> f64 {
        let difference = [window(0.0, tau_s, -1.0), window(tau_s, 2.0 * tau_s, 1.0)];
        model.covariance(&difference, &difference) / 2.0
    }

    #[test]
    fn constants_are_the_facts() {
        let typical = Axis::ADIS16130.typical_noise();
        let n_deg_per_rt_h = typical.white_dps_per_rt_hz / 2f64.sqrt() * 60.0;
        assert!((n_deg_per_rt_h - 0.53).abs() < 0.001, "F-02");
        assert!((FLOOR_PER_B - (2.0 * LN_2 / PI).sqrt()).abs() < 1e-15);
        assert!((FLOOR_PER_B * typical.bias_instability_dps - 0.0016).abs() < 1e-12, "M-04");
        assert_eq!((FLICKER_TOP_HZ / FLICKER_CUTOFF_HZ).log2().mul_add(2.0, 0.0).ceil(), CELLS as f64);
        assert_eq!((FLICKER_CUTOFF_HZ, typical.rate_random_walk_dps_per_rt_s), (1e-4, 1e-4), "M-04");
    }

    #[test]
    fn white_noise_of_a_mean() {
        let model = only(0.0125, 0.0, 0.0);
        let sd = model.sd(&[window(7.0, 17.0, 1.0)]);
        assert!((sd - 0.0125 / 20f64.sqrt()).abs() < 1e-12, "F-02: {sd}");
        assert!(model.covariance(&[window(0.0, 1.0, 1.0)], &[window(2.0, 3.0, 1.0)]).abs() < 1e-18);
    }

    #[test]
    fn random_walk_from_a_mean_to_its_end() {
        let model = only(0.0, 0.0, 1e-4);
        let sum = [window(0.0, 150.0, 1.0), window(149.999, 150.001, -1.0)];
        assert!((model.covariance(&sum, &sum) / (1e-8 * 50.0) - 1.0).abs() < 1e-4);
    }

    /// Compares the covariance of windows with the formulas of IEEE Std 952. The flicker is 1/f between two corners
    /// only, so its Allan deviation is flat only between them.
    #[test]
    fn windows_agree_with_the_allan_variance() {
        for model in [only(0.0125, 0.0, 0.0), only(0.0, 0.0, 1e-4), only(0.0, 0.0024, 0.0)] {
            for tau_s in [3.0, 30.0] {
                let ratio = allan_by_windows(&model, tau_s) / model.allan_variance(tau_s);
                assert!((ratio - 1.0).abs() < 0.03, "{model:?} at {tau_s} s: {ratio}");
            }
        }
    }

    /// Compares the variance of a mean over T with the numerical integral of S(f) sinc²(πfT) from the cutoff up.
    #[test]
    fn flicker_of_a_mean_against_the_spectrum() {
        let (b, t) = (0.0024, 150.0);
        let steps = 200_000;
        let span = (100.0 / t / FLICKER_CUTOFF_HZ).ln();
        let integral: f64 = (0..steps)
            .map(|i| FLICKER_CUTOFF_HZ * ((f64::from(i) + 0.5) / f64::from(steps) * span).exp())
            .map(|f| b * b / PI * ((PI * f * t).sin() / (PI * f * t)).powi(2) * span / f64::from(steps))
            .sum();
        let variance = only(0.0, b, 0.0).covariance(&[window(0.0, t, 1.0)], &[window(0.0, t, 1.0)]);
        assert!((variance / integral - 1.0).abs() < 0.02, "{variance} against {integral}");
    }

    #[test]
    fn best_averaging_time_is_the_minimum() {
        let model = Axis::ADIS16130.typical_noise();
        let best = model.best_averaging_s();
        assert!((best - 153.1).abs() < 0.1);
        assert!(model.allan_variance(best) < model.allan_variance(best * 1.1));
        assert!(model.allan_variance(best) < model.allan_variance(best * 0.9));
    }
}
