//! Simulates records with known truth.

use super::scenario::{Disturbance, Filter, Scenario};
use rand::rngs::SmallRng;
use rand::{Rng, RngExt};
use rand_distr::StandardNormal;
use rustfft::{Fft, num_complex::Complex64};
use std::f64::consts::PI;
use std::sync::Arc;
use zerorate::noise::FLICKER_CUTOFF_HZ;

/// Sampling rate of every record, Hz.
pub const RATE_HZ: f64 = 100.0;
/// Sampling rate at which slow flicker is synthesised before it is interpolated, Hz. Fast flicker has the record's
/// rate.
const SLOW_RATE_HZ: f64 = 10.0;
/// Frequency that separates slow and fast flicker, Hz.
const SPLIT_HZ: f64 = 0.5;
/// Number of points of each synthesis. The slow flicker repeats after 52 429 s.
pub const SYNTHESIS: usize = 1 << 19;
/// Number of samples that are simulated before the record, so that a filter has settled.
const LEAD: usize = 3000;
/// Error of an outlier, °/s.
const OUTLIER: f64 = 50.0;

pub fn record(scenario: &Scenario, fft: &Arc<dyn Fft<f64>>, rng: &mut SmallRng) -> Vec<f64> {
    let len = (scenario.length_s * RATE_HZ) as usize;
    let lead = if let Filter::None = scenario.filter { 0 } else { LEAD };
    let mut rate: Vec<f64> = (0..lead + len).map(|_| normal(rng) * scenario.n * RATE_HZ.sqrt()).collect();
    if scenario.k > 0.0 {
        let mut walk = 0.0;
        for rate in &mut rate {
            walk += normal(rng) * scenario.k / RATE_HZ.sqrt();
            *rate += walk;
        }
    }
    if let Some((sigma, tau_s)) = scenario.gauss_markov {
        let keep = (-1.0 / (RATE_HZ * tau_s)).exp();
        let mut level = sigma * normal(rng);
        for rate in &mut rate {
            level = keep * level + sigma * (1.0 - keep * keep).sqrt() * normal(rng);
            *rate += level;
        }
    }
    if scenario.b > 0.0 {
        add_flicker(&mut rate, scenario.b, fft, rng);
    }
    filtered(&mut rate, scenario.filter);
    rate.drain(..rate.len() - len);
    if scenario.q > 0.0 {
        let mut before = normal(rng) * scenario.q;
        for rate in &mut rate {
            let angle = normal(rng) * scenario.q;
            *rate += (angle - before) * RATE_HZ;
            before = angle;
        }
    }
    disturb(&mut rate, scenario, rng);
    rate
}

fn normal(rng: &mut SmallRng) -> f64 {
    rng.sample(StandardNormal)
}

fn filtered(rate: &mut Vec<f64>, filter: Filter) {
    match filter {
        Filter::None => {}
        Filter::LowPass(tau_s) => low_pass(rate, (-1.0 / (RATE_HZ * tau_s)).exp()),
        Filter::Butterworth(hz) => butterworth(rate, (PI * hz / RATE_HZ).tan()),
        Filter::Mean(samples) => {
            let mean = |rates: &[f64]| rates.iter().sum::<f64>() / samples as f64;
            *rate = rate.windows(samples).map(mean).collect();
        }
    }
}

/// A second-order Butterworth low-pass. `k` is tan(π·f/rate) for the cut-off frequency f.
fn butterworth(rate: &mut [f64], k: f64) {
    let norm = 1.0 / (1.0 + 2f64.sqrt() * k + k * k);
    let (gain, a1, a2) = (k * k * norm, 2.0 * (k * k - 1.0) * norm, (1.0 - 2f64.sqrt() * k + k * k) * norm);
    let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
    for rate in rate {
        let y = gain * (*rate + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
        (x2, x1, y2, y1) = (x1, *rate, y1, y);
        *rate = y;
    }
}

fn low_pass(rate: &mut [f64], keep: f64) {
    let mut before = 0.0;
    for rate in rate {
        before = keep * before + (1.0 - keep) * *rate;
        *rate = before;
    }
}

fn disturb(rate: &mut [f64], scenario: &Scenario, rng: &mut SmallRng) {
    let len = rate.len();
    let some = |rng: &mut SmallRng, part: f64| rng.random::<f64>() < part;
    match scenario.disturbance {
        Disturbance::Nothing => {}
        Disturbance::Sine(amplitude, frequency_hz) => {
            let at = |i: usize| amplitude * (2.0 * PI * frequency_hz * i as f64 / RATE_HZ).sin();
            rate.iter_mut().enumerate().for_each(|(i, rate)| *rate += at(i));
        }
        Disturbance::Resonance(frequency_hz, half_width_hz, part) => {
            let ring = resonance(len, frequency_hz, half_width_hz, rng);
            let power = ring.iter().map(|value| value * value).sum::<f64>() / len as f64;
            let strength = (part * scenario.n.powi(2) * RATE_HZ / power).sqrt();
            rate.iter_mut().zip(ring).for_each(|(rate, ring)| *rate += strength * ring);
        }
        Disturbance::Outliers(part) => {
            // at least one outlier, because a record without any is another scenario
            let count = (part * len as f64).round().max(1.0) as usize;
            for _ in 0..count {
                rate[rng.next_u64() as usize % len] += if some(rng, 0.5) { OUTLIER } else { -OUTLIER };
            }
        }
        Disturbance::Step(size) => {
            let at = (0.1 * len as f64 + 0.8 * len as f64 * rng.random::<f64>()) as usize;
            rate[at..].iter_mut().for_each(|rate| *rate += size);
        }
        Disturbance::Loss(part) => rate.iter_mut().for_each(|rate| {
            if some(rng, part) {
                *rate = f64::NAN;
            }
        }),
        Disturbance::Bursts(longest_s, count) => {
            for _ in 0..count {
                let from = rng.next_u64() as usize % len;
                let length = (longest_s * RATE_HZ * rng.random::<f64>()) as usize;
                rate[from..(from + length).min(len)].fill(f64::NAN);
            }
        }
        Disturbance::Gap(length_s) => {
            let length = (length_s * RATE_HZ) as usize;
            let from = rng.next_u64() as usize % (len - length);
            rate[from..from + length].fill(f64::NAN);
        }
        Disturbance::Coarse(steps) => {
            let step = steps * scenario.n * RATE_HZ.sqrt();
            rate.iter_mut().for_each(|rate| *rate = (*rate / step).round() * step);
        }
        Disturbance::WarmUp(size, tau_s) => {
            let at = |i: usize| size * (-(i as f64) / RATE_HZ / tau_s).exp();
            rate.iter_mut().enumerate().for_each(|(i, rate)| *rate += at(i));
        }
    }
}

/// White noise through a resonant second-order filter.
fn resonance(len: usize, frequency_hz: f64, half_width_hz: f64, rng: &mut SmallRng) -> Vec<f64> {
    let radius = (-2.0 * PI * half_width_hz / RATE_HZ).exp();
    let turn = 2.0 * radius * (2.0 * PI * frequency_hz / RATE_HZ).cos();
    let (mut before, mut two_before) = (0.0, 0.0);
    let next = || {
        let value = turn * before - radius * radius * two_before + normal(rng);
        (two_before, before) = (before, value);
        value
    };
    std::iter::repeat_with(next).take(len).collect()
}

fn add_flicker(rate: &mut [f64], b: f64, fft: &Arc<dyn Fft<f64>>, rng: &mut SmallRng) {
    let slow = flicker(b, SLOW_RATE_HZ, FLICKER_CUTOFF_HZ..SPLIT_HZ, fft, rng);
    let fast = flicker(b, RATE_HZ, SPLIT_HZ..RATE_HZ, fft, rng);
    for (i, rate) in rate.iter_mut().enumerate() {
        let at = i as f64 * SLOW_RATE_HZ / RATE_HZ;
        let (whole, part) = (at as usize, at.fract());
        // Fast flicker repeats in a long record, which is harmless: its correlations are far shorter than the period
        // of repetition.
        *rate += slow[whole] * (1.0 - part) + slow[whole + 1] * part + fast[i % SYNTHESIS];
    }
}

/// Flicker by spectral synthesis: with the one-sided density B²/(πf), a component at f has the variance B²/(πf)·df.
fn flicker(
    b: f64,
    rate_hz: f64,
    band_hz: std::ops::Range<f64>,
    fft: &Arc<dyn Fft<f64>>,
    rng: &mut SmallRng,
) -> Vec<f64> {
    let df = rate_hz / SYNTHESIS as f64;
    let mut lines = vec![Complex64::default(); SYNTHESIS];
    for (k, line) in lines.iter_mut().enumerate().take(SYNTHESIS / 2) {
        let f = k as f64 * df;
        if band_hz.contains(&f) {
            let sd = (b * b / (PI * f) * df).sqrt();
            *line = Complex64::new(rng.sample(StandardNormal), rng.sample(StandardNormal)) * sd;
        }
    }
    fft.process(&mut lines);
    lines.into_iter().map(|line| line.re).collect()
}
