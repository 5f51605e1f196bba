//! Decimates a record in levels. The first level holds the samples, and the next ones hold ever longer means.
//!
//! A mean contains noise of its band and aliases from higher bands. Shorter means have measured those bands, so their
//! aliases are computed and subtracted. Gaps give each mean its own frequency response. The average response is the
//! gain. The scatter about it turns noise of any frequency into white noise.

use super::super::bins::interpolated;
use super::super::lines::Narrow;
use super::averages::averages;
use alloc::borrow::Cow;
use alloc::vec;
use alloc::vec::Vec;
use core::f64::consts::PI;
use realfft::num_complex::Complex64;
use realfft::{FftError, RealFftPlanner};

/// The response of a mean of n samples is computed at multiples of the sample rate divided by n·`FINENESS`.
const FINENESS: usize = 4;
/// Largest number of samples that are searched for gaps.
const LOOKED_AT: usize = 1 << 20;

/// The density and the lines that the levels before have measured.
#[derive(Default)]
pub(super) struct MeasuredLevels {
    /// Frequency and density, ascending.
    density: Vec<(f64, f64)>,
    /// Frequency and variance of each narrow line.
    lines: Vec<(f64, f64)>,
}

impl MeasuredLevels {
    /// Adds the densities and lines of a level, which are below all known frequencies.
    pub(super) fn add_below(&mut self, density: impl Iterator<Item = (f64, f64)>, lines: &[Narrow]) {
        let above = core::mem::take(&mut self.density);
        self.density = density.chain(above).collect();
        self.lines.extend(lines.iter().map(|Narrow { line, .. }| (line.frequency_hz, line.rms * line.rms)));
    }

    fn at(&self, f_hz: f64) -> f64 {
        interpolated(&self.density, f_hz)
    }
}

/// The means of every `step` samples; a missing mean is NaN.
pub(super) struct Level<'a> {
    pub(super) step: usize,
    pub(super) values: Cow<'a, [f64]>,
    /// The share of means that are present.
    pub(super) present: f64,
    /// Rate of the samples, Hz.
    rate_hz: f64,
    gaps: Option<Gaps>,
}

/// The frequency responses of averages with gaps, at equal steps from 0 Hz to half the sample rate.
struct Gaps {
    /// The gain of the mean response.
    gain: Vec<f64>,
    /// The gain of the scatter about the mean response.
    scatter: Vec<f64>,
}

impl<'a> Level<'a> {
    /// The samples themselves.
    pub(super) fn first(rate: &'a [f64], rate_hz: f64) -> Self {
        let there = rate.iter().filter(|value| !value.is_nan()).count();
        let present = there as f64 / rate.len().max(1) as f64;
        Self { step: 1, values: Cow::Borrowed(rate), present, rate_hz, gaps: None }
    }

    pub(super) fn of(rate: &[f64], rate_hz: f64, step: usize) -> Result<Self, FftError> {
        let (values, counts) = averages(rate, step);
        let present = counts.iter().filter(|count| **count > 0).count() as f64 / counts.len().max(1) as f64;
        let is_complete = counts.iter().all(|&count| count == step);
        let gaps = if is_complete { None } else { Some(Gaps::of(rate, &counts, step)?) };
        Ok(Self { step, values: Cow::Owned(values), present, rate_hz, gaps })
    }

    /// Samples per second of this level.
    pub(super) fn rate_hz(&self) -> f64 {
        self.rate_hz / self.step as f64
    }

    /// The share of the density of the samples at a frequency that is left in their means.
    pub(super) fn gain(&self, f_hz: f64) -> f64 {
        if let Some(Gaps { gain, .. }) = &self.gaps {
            return at(gain, f_hz / self.rate_hz * 2.0 * (gain.len() - 1) as f64);
        }
        let half_angle = PI * f_hz / self.rate_hz;
        let own = libm::sin(half_angle * self.step as f64) / (self.step as f64 * libm::sin(half_angle));
        if own.is_finite() { own * own } else { 1.0 }
    }

    /// The density that aliases to a frequency of this level.
    pub(super) fn folded(&self, f_hz: f64, known: &MeasuredLevels) -> f64 {
        let folds = |(times, sign): (usize, f64)| {
            let from_hz = libm::fabs(f_hz + sign * times as f64 * self.rate_hz());
            if from_hz > self.rate_hz / 2.0 { 0.0 } else { self.gain(from_hz) * known.at(from_hz) }
        };
        (1..=self.step / 2).flat_map(|times| [(times, 1.0), (times, -1.0)]).map(folds).sum()
    }

    /// The white density that the scatter of the responses causes.
    pub(super) fn scattered(&self, known: &MeasuredLevels) -> f64 {
        let Some(Gaps { scatter, .. }) = &self.gaps else { return 0.0 };
        let hz = self.rate_hz / 2.0 / (scatter.len() - 1) as f64;
        let ends = |i: usize| if i == 0 || i + 1 == scatter.len() { 0.5 } else { 1.0 };
        let noise: f64 = scatter.iter().enumerate().map(|(i, share)| ends(i) * share * known.at(i as f64 * hz)).sum();
        let lines: f64 = known.lines.iter().map(|(f_hz, variance)| variance * at(scatter, f_hz / hz)).sum();
        (2.0 * hz * noise + lines) / self.rate_hz()
    }
}

/// Interpolates linearly in a list.
fn at(values: &[f64], place: f64) -> f64 {
    let before = (place as usize).min(values.len().saturating_sub(2));
    values[before] + (values[before + 1] - values[before]) * (place - before as f64).min(1.0)
}

impl Gaps {
    fn of(rate: &[f64], counts: &[usize], step: usize) -> Result<Self, FftError> {
        let len = FINENESS * step;
        let fft = RealFftPlanner::<f64>::new().plan_fft_forward(len);
        let (mut mask, mut lines) = (fft.make_input_vec(), fft.make_output_vec());
        let mut mean = vec![Complex64::new(0.0, 0.0); lines.len()];
        let mut square = vec![0.0; lines.len()];
        let used: Vec<usize> = (0..counts.len()).filter(|&slot| counts[slot] > 0).collect();
        let every = (used.len() * step).div_ceil(LOOKED_AT).max(1);
        let looked_at = used.len().div_ceil(every) as f64;
        for &slot in used.iter().step_by(every) {
            mask.fill(0.0);
            let weight = 1.0 / counts[slot] as f64;
            let samples = rate[slot * step..][..step].iter().zip(&mut mask);
            samples.filter(|(value, _)| !value.is_nan()).for_each(|(_, cell)| *cell = weight);
            fft.process(&mut mask, &mut lines)?;
            mean.iter_mut().zip(&lines).for_each(|(mean, line)| *mean += line / looked_at);
            square.iter_mut().zip(&lines).for_each(|(square, line)| *square += line.norm_sqr() / looked_at);
        }
        let gain: Vec<f64> = mean.iter().map(Complex64::norm_sqr).collect();
        let scatter = square.iter().zip(&gain).map(|(square, gain)| (square - gain).max(0.0)).collect();
        Ok(Self { gain, scatter })
    }
}
