//! Spectral density for a plot: Welch's estimate, averaged over equal steps of log frequency.

use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use realfft::{FftError, RealFftPlanner};

/// The mean density over a small range of frequencies, as one point of a plot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Density {
    /// Middle of the range, Hz.
    pub frequency_hz: f64,
    /// Two-sided density, unit²/Hz; N² for white noise. The one-sided density is twice as large.
    pub density: f64,
}

/// Least number of segments in a record, so that the density at each frequency is an average.
const SEGMENTS: usize = 4;
/// Shortest and longest segment, samples.
const LENGTHS: core::ops::RangeInclusive<usize> = 64..=1 << 20;
/// Largest number of points per decade. Low frequencies have fewer, since coefficients are farther apart.
const PER_DECADE: f64 = 60.0;
/// First Fourier coefficient in use. Subtracting the mean makes coefficient 0 too small, and the window also makes
/// coefficient 1 too small.
const FIRST: usize = 2;

/// Welch's estimate (1967) of the spectral density of a rate. NaN marks a missing sample. Hann-windowed segments
/// overlap by half, each without its mean. Missing samples count as the mean, and segments that lack more than half of
/// their samples are left out. The result is empty for fewer than 256 samples, and if all segments are left out.
///
/// # Errors
/// Returns an error if the Fourier transform fails. The buffers have matching lengths, so this is not expected.
pub fn welch(rate: &[f64], rate_hz: f64) -> Result<Vec<Density>, FftError> {
    let most = (rate.len() / SEGMENTS).min(*LENGTHS.end());
    let longest = (0..usize::BITS).rev().map(|k| 1usize << k).find(|length| *length <= most);
    let Some(length) = longest.filter(|length| LENGTHS.contains(length)) else { return Ok(Vec::new()) };
    let window: Vec<f64> =
        (0..length).map(|i| 0.5 - 0.5 * libm::cos(2.0 * PI * (i as f64 + 0.5) / length as f64)).collect();
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(length);
    let (mut lines, mut scratch) = (fft.make_output_vec(), fft.make_scratch_vec());
    let (mut power, mut segments) = (vec![0.0; length / 2 + 1], 0.0);
    for start in (0..=rate.len() - length).step_by(length / 2) {
        let Some((mut segment, norm)) = windowed(&rate[start..start + length], &window) else { continue };
        fft.process_with_scratch(&mut segment, &mut lines, &mut scratch)?;
        let weight = 1.0 / (norm * rate_hz);
        power.iter_mut().zip(&lines).for_each(|(power, line)| *power += weight * line.norm_sqr());
        segments += 1.0;
    }
    power.iter_mut().for_each(|power| *power /= segments);
    Ok(if segments > 0.0 { averaged(&power, rate_hz / length as f64) } else { Vec::new() })
}

/// The windowed segment, and the sum of squares of the window over samples present. `None` if most are missing.
fn windowed(segment: &[f64], window: &[f64]) -> Option<(Vec<f64>, f64)> {
    let there = || segment.iter().filter(|value| !value.is_nan());
    let count = there().count();
    if 2 * count < segment.len() {
        return None;
    }
    let mean = there().sum::<f64>() / count as f64;
    let weighted = |(value, window): (&f64, &f64)| if value.is_nan() { 0.0 } else { (value - mean) * window };
    let squares = |(value, window): (&f64, &f64)| if value.is_nan() { 0.0 } else { window * window };
    let norm = segment.iter().zip(window).map(squares).sum();
    Some((segment.iter().zip(window).map(weighted).collect(), norm))
}

/// Means over frequency steps of equal ratio.
fn averaged(power: &[f64], step_hz: f64) -> Vec<Density> {
    let factor = libm::pow(10.0, 1.0 / PER_DECADE);
    let mut all = Vec::new();
    let mut from = FIRST;
    while from < power.len() - 1 {
        let to = (libm::ceil(from as f64 * factor) as usize).max(from + 1).min(power.len() - 1);
        let count = (to - from) as f64;
        let density = power[from..to].iter().sum::<f64>() / count;
        all.push(Density { frequency_hz: step_hz * ((from + to - 1) as f64 / 2.0), density });
        from = to;
    }
    all
}

#[cfg(test)]
mod tests {
    use super::super::{FitOptions, Input, fit};
    use super::*;
    use crate::kernels::tests::white;

    /// White noise of variance 1 at 100 Hz, density 0.01, and a sine of the rms `sine` at 12.5 Hz.
    fn record(sine: f64) -> Vec<f64> {
        let noise = white(1, 40_000).into_iter();
        noise.enumerate().map(|(i, noise)| 5.0 + noise + sine * SINE * libm::sin(PI * i as f64 / 4.0)).collect()
    }

    const SINE: f64 = core::f64::consts::SQRT_2;

    #[test]
    fn white_noise_and_a_sine_have_their_power() {
        let density = welch(&record(0.0), 100.0).unwrap();
        let upper: Vec<f64> = density.iter().filter(|one| one.frequency_hz > 5.0).map(|one| one.density).collect();
        let mean = upper.iter().sum::<f64>() / upper.len() as f64;
        assert!((mean / 0.01 - 1.0).abs() < 0.02, "{mean}");
        assert!(density.len() < 250 && density[0].frequency_hz < 0.05, "{}", density.len());
        let density = welch(&record(2.0), 100.0).unwrap();
        let peak = density.iter().max_by(|a, b| a.density.total_cmp(&b.density)).unwrap();
        assert!((peak.frequency_hz / 12.5 - 1.0).abs() < 0.03, "{peak:?}");
        // two-sided: half of 4 at each of ±12.5 Hz
        let width = peak.frequency_hz * (libm::pow(10.0, 1.0 / PER_DECADE) - 1.0);
        assert!((peak.density * width / 2.0 - 1.0).abs() < 0.1, "{peak:?}");
    }

    #[test]
    fn missing_samples_do_not_change_the_density() {
        let mut rate = record(0.0);
        rate.iter_mut().step_by(3).for_each(|value| *value = f64::NAN);
        let density = welch(&rate, 100.0).unwrap();
        let upper: Vec<f64> = density.iter().filter(|one| one.frequency_hz > 5.0).map(|one| one.density).collect();
        let mean = upper.iter().sum::<f64>() / upper.len() as f64;
        assert!((mean / 0.01 - 1.0).abs() < 0.03, "{mean}");
        assert!(welch(&[f64::NAN; 1000], 100.0).unwrap().is_empty());
        assert!(welch(&[1.0; 255], 100.0).unwrap().is_empty());
    }

    /// Above 0.3 Hz, the estimate for the plot is within a factor of 2 of the fitted model.
    #[test]
    fn the_model_lies_on_the_estimate() {
        let rate = record(0.0);
        // a low-pass of the first order, and a random walk
        let (mut low, mut walk) = (0.0, 0.0);
        let rate: Vec<f64> = rate
            .iter()
            .map(|white| {
                low += 0.6 * (white - low);
                walk += 0.02 * (white - 5.0);
                low + walk
            })
            .collect();
        let fit = fit(&Input::Rate(&rate), 100.0, &FitOptions::default()).unwrap();
        for one in welch(&rate, 100.0).unwrap().iter().filter(|one| one.frequency_hz > 0.3) {
            let ratio = one.density / fit.density(one.frequency_hz, 100.0);
            assert!((0.5..2.0).contains(&ratio), "{one:?}: {ratio}");
        }
    }
}
