//! A cosine transform, a cosine and sine series, and the autocovariance of a density, by real Fourier transforms.

use alloc::vec::Vec;
use core::f64::consts::PI;
use realfft::num_complex::Complex64;
use realfft::{FftError, RealFftPlanner};

/// The largest even length up to `samples` without a prime factor above 7, at most 1 % shorter from 10⁴ samples on.
pub(super) fn smooth_length(samples: usize) -> usize {
    (2..=samples).rev().find(|n| n.is_multiple_of(2) && is_smooth(*n)).unwrap_or(0)
}

fn is_smooth(mut n: usize) -> bool {
    for prime in [2, 3, 5, 7] {
        while n.is_multiple_of(prime) {
            n /= prime;
        }
    }
    n == 1
}

/// Coefficients 1 … n − 1 of the orthonormal DCT-II of an even number of samples, c_k = √(2/n) Σ x_i cos(πk(2i +
/// 1)/2n). One real transform of the samples in the order 0, 2, 4 … 5, 3, 1 gives them (Makhoul 1980).
pub(super) fn cosine_transform(x: &[f64]) -> Result<Vec<f64>, FftError> {
    let n = x.len();
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let mut folded: Vec<f64> = x.iter().step_by(2).chain(x.iter().skip(1).step_by(2).rev()).copied().collect();
    let mut lines = fft.make_output_vec();
    fft.process(&mut folded, &mut lines)?;
    let (norm, step) = (libm::sqrt(2.0 / n as f64), PI / (2 * n) as f64);
    let mut coefficients = folded;
    for (k, line) in lines.iter().enumerate().skip(1) {
        let (sin, cos) = libm::sincos(step * k as f64);
        coefficients[k] = norm * (line.re * cos + line.im * sin);
        coefficients[n - k] = norm * (line.re * sin - line.im * cos);
    }
    coefficients.remove(0);
    Ok(coefficients)
}

/// Σ a_k cos(πkt/n) + b_k sin(πkt/n) over k = 1 … n − 1, at t = 0 … 2n − 1, from the pairs (a_k, b_k).
pub(super) fn series(pairs: &[(f64, f64)]) -> Result<Vec<f64>, FftError> {
    let n = pairs.len() + 1;
    let fft = RealFftPlanner::<f64>::new().plan_fft_inverse(2 * n);
    let mut lines = fft.make_input_vec();
    for (line, (a, b)) in lines.iter_mut().skip(1).zip(pairs) {
        *line = Complex64::new(a / 2.0, -b / 2.0);
    }
    let mut sums = fft.make_output_vec();
    fft.process(&mut lines, &mut sums)?;
    Ok(sums)
}

/// Autocovariance at lags 0 … N/2 of a process sampled at `rate_hz`, from its density at 0, rate/N … rate/2.
pub(super) fn autocovariance(density: &[f64], rate_hz: f64) -> Result<Vec<f64>, FftError> {
    let len = 2 * (density.len() - 1);
    let fft = RealFftPlanner::<f64>::new().plan_fft_inverse(len);
    let mut lines: Vec<Complex64> = density.iter().map(|&value| Complex64::new(value, 0.0)).collect();
    let mut covariance = fft.make_output_vec();
    fft.process(&mut lines, &mut covariance)?;
    covariance.truncate(len / 2 + 1);
    covariance.iter_mut().for_each(|value| *value *= rate_hz / len as f64);
    Ok(covariance)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(n: usize) -> Vec<f64> {
        (0..n as u64).map(|i| (i * i * 7919 % 1009) as f64 / 500.0 - 1.0).collect()
    }

    #[test]
    fn the_cosine_transform_is_its_definition() {
        for n in [2, 4, 10, 60, 96] {
            let x = samples(n);
            let found = cosine_transform(&x).unwrap();
            assert_eq!(found.len(), n - 1);
            for (k, found) in (1..n).zip(found) {
                let angle = |i: usize| PI * (k * (2 * i + 1)) as f64 / (2 * n) as f64;
                let sum: f64 = x.iter().enumerate().map(|(i, x)| x * libm::cos(angle(i))).sum();
                assert!((found - libm::sqrt(2.0 / n as f64) * sum).abs() < 1e-12, "{n} {k}");
            }
        }
    }

    #[test]
    fn a_series_is_its_definition() {
        let n = 12;
        let pairs: Vec<(f64, f64)> = samples(n - 1).into_iter().zip(samples(2 * n).into_iter().skip(n)).collect();
        for (t, found) in series(&pairs).unwrap().into_iter().enumerate() {
            let term = |(k, (a, b)): (usize, &(f64, f64))| {
                let (sin, cos) = libm::sincos(PI * ((k + 1) * t) as f64 / n as f64);
                a * cos + b * sin
            };
            assert!((found - pairs.iter().enumerate().map(term).sum::<f64>()).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn lengths_are_even_and_smooth() {
        assert_eq!([0, 1, 2, 7, 360_000, 1_000_003].map(smooth_length), [0, 0, 2, 6, 360_000, 1_000_000]);
        for n in (10_000..2_000_000).step_by(77_777) {
            assert!(smooth_length(n) * 100 >= n * 99, "{n}");
        }
    }

    /// White noise of density 2 at 10 Hz has the variance 20. The cosine adds a covariance of −5 at lag 1.
    #[test]
    fn autocovariance_of_densities_that_are_known() {
        let density: Vec<f64> = (0..=256).map(|i| 2.0 - libm::cos(PI * f64::from(i) / 256.0)).collect();
        let found = autocovariance(&density, 10.0).unwrap();
        assert!((found[0] - 20.0).abs() < 1e-12 && (found[1] + 5.0).abs() < 1e-12 && found[2].abs() < 1e-12);
    }
}
