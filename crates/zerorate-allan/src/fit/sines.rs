//! Sines that last as long as the record. Such a sine begins and ends with the record, so its transform has power
//! at all frequencies. Strong sines are therefore removed from the samples before the transform.

use crate::linear::Cholesky;
use alloc::vec::Vec;
use core::f64::consts::PI;
use realfft::num_complex::Complex64;
use realfft::{FftError, RealFftPlanner};

/// A sine, with its phase at the first sample.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sine {
    pub(super) hz: f64,
    cosine: f64,
    sine: f64,
}

/// Largest number of partial sums in which the frequency is searched.
const PARTS: usize = 4096;
/// Number of frequencies per bin of a Fourier transform in the first search.
const FINENESS: usize = 8;
/// Number of golden-section steps after the first search.
const SHRUNK: usize = 40;
/// Least pivot at which the samples can tell a sine from a level.
const LEAST_PIVOT: f64 = 1e-6;
/// Number of samples after which the phase is computed anew.
const EXACT_EVERY: usize = 4096;

impl Sine {
    /// The sine that explains most of a rate, at most `reach_hz` from `near_hz`; NaN is a missing sample. `None` if
    /// the samples cannot tell the sine from a level.
    pub(super) fn near(rate: &[f64], rate_hz: f64, near_hz: f64, reach_hz: f64) -> Result<Option<Self>, FftError> {
        let near = near_hz / rate_hz;
        let parts = Parts::of(rate, near);
        let turns = near + parts.strongest(reach_hz / rate_hz)?;
        let (mut squares, mut products) = ([[0.0; 3]; 3], [0.0; 3]);
        for (chunk, start) in rate.chunks(EXACT_EVERY).zip((0..).step_by(EXACT_EVERY)) {
            for (value, (cos, sin)) in chunk.iter().zip(phases(turns, start)).filter(|(value, _)| !value.is_nan()) {
                let row = [1.0, cos, sin];
                for (i, one) in row.iter().enumerate() {
                    (0..=i).for_each(|j| squares[i][j] += one * row[j]);
                    products[i] += one * value;
                }
            }
        }
        let rows = squares.iter().enumerate().map(|(i, row)| row[..=i].to_vec()).collect();
        let solved = Cholesky::new(rows, LEAST_PIVOT).map(|factors| factors.solve(products));
        Ok(solved.map(|solved| Self { hz: turns * rate_hz, cosine: solved[1], sine: solved[2] }))
    }

    pub(super) fn variance(&self) -> f64 {
        (self.cosine * self.cosine + self.sine * self.sine) / 2.0
    }

    pub(super) fn take_out(&self, rate: &mut [f64], rate_hz: f64) {
        let turns = self.hz / rate_hz;
        for (chunk, start) in rate.chunks_mut(EXACT_EVERY).zip((0..).step_by(EXACT_EVERY)) {
            let phases = phases(turns, start);
            chunk.iter_mut().zip(phases).for_each(|(x, (cos, sin))| *x -= self.cosine * cos + self.sine * sin);
        }
    }
}

/// Cosine and sine of the phase at each sample from `start` on, for a frequency in turns per sample.
fn phases(turns: f64, start: usize) -> impl Iterator<Item = (f64, f64)> {
    let phase = |turns: f64| Complex64::cis(2.0 * PI * (turns - libm::floor(turns)));
    let step = phase(turns);
    core::iter::successors(Some(phase(turns * start as f64)), move |now| Some(now * step)).map(|now| (now.re, now.im))
}

/// Partial sums of a rate after demodulation by a frequency.
struct Parts {
    sums: Vec<Complex64>,
    /// Number of samples in a part.
    length: usize,
}

impl Parts {
    fn of(rate: &[f64], turns: f64) -> Self {
        let there = || rate.iter().filter(|value| !value.is_nan());
        let mean = there().sum::<f64>() / there().count().max(1) as f64;
        let length = rate.len().div_ceil(PARTS).max(1);
        let sum = |(part, start): (&[f64], usize)| {
            let turned = part.iter().zip(phases(turns, start)).filter(|(value, _)| !value.is_nan());
            turned.map(|(value, (cos, sin))| Complex64::new(cos, -sin) * (value - mean)).sum()
        };
        let sums = rate.chunks(length).zip((0..).step_by(length)).map(sum).collect();
        Self { sums, length }
    }

    /// The power at a frequency `off` from the demodulation frequency, in turns per sample.
    fn power(&self, off: f64) -> f64 {
        let turn = |(sum, part): (&Complex64, usize)| {
            let middle = (part as f64 + 0.5) * self.length as f64;
            sum * Complex64::cis(-2.0 * PI * off * middle)
        };
        self.sums.iter().zip(0..).map(turn).sum::<Complex64>().norm_sqr()
    }

    /// The strongest frequency within `reach` of the demodulation frequency, as an offset in turns per sample.
    fn strongest(&self, reach: f64) -> Result<f64, FftError> {
        let len = (FINENESS * self.sums.len()).next_power_of_two();
        let step = 1.0 / (len * self.length) as f64;
        let fft = RealFftPlanner::<f64>::new().plan_fft_forward(len);
        let transformed = |of: fn(&Complex64) -> f64| {
            let mut values: Vec<f64> = self.sums.iter().map(of).collect();
            values.resize(len, 0.0);
            let mut transform = fft.make_output_vec();
            fft.process(&mut values, &mut transform).map(|()| transform)
        };
        let (real, imaginary) = (transformed(|sum| sum.re)?, transformed(|sum| sum.im)?);
        let of = |k: usize| [(real[k], imaginary[k], 1.0), (real[k].conj(), imaginary[k].conj(), -1.0)];
        let most = ((reach / step) as usize + 1).min(len / 2);
        let powers = (0..=most)
            .flat_map(|k| of(k).map(|(re, im, sign)| ((re + Complex64::i() * im).norm_sqr(), sign * k as f64)));
        let best = powers.max_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, k)| k * step);
        let golden = (libm::sqrt(5.0) - 1.0) / 2.0;
        let (mut low, mut high) = (best - step, best + step);
        for _ in 0..SHRUNK {
            let inner = golden * (high - low);
            if self.power(high - inner) > self.power(low + inner) {
                high = low + inner;
            } else {
                low = high - inner;
            }
        }
        Ok(f64::midpoint(low, high))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sine_beside_a_level_and_a_gap_is_found() {
        for (hz, samples) in [(0.5, 20_000), (3.21, 70_000), (41.9, 20_001)] {
            let value = |i: usize| 7.0 + 0.3 * (2.0 * PI * hz * i as f64 / 100.0 + 1.0).sin();
            let mut rate: Vec<f64> = (0..samples).map(value).collect();
            rate[5000..6000].fill(f64::NAN);
            let found = Sine::near(&rate, 100.0, hz + 60.0 / samples as f64, 150.0 / samples as f64);
            let found = found.unwrap().unwrap();
            assert!((found.hz / hz - 1.0).abs() < 1e-5 && (found.variance() / 0.045 - 1.0).abs() < 1e-4, "{found:?}");
            found.take_out(&mut rate, 100.0);
            let left = rate.iter().filter(|value| !value.is_nan()).map(|value| (value - 7.0).abs());
            assert!(left.fold(0.0, f64::max) < 1e-3, "{hz} Hz");
        }
    }
}
