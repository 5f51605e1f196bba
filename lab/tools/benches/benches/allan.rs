//! Benchmarks of Allan deviations of an hour at 5.7 kSPS and of 150 s, and of noise models of a million samples.

use divan::{Bencher, black_box};
use zerorate_allan::{FitOptions, Input, Stat, deviations, fit, octaves};

const HOUR: usize = 20_520_000;
const STEP_8: usize = 855_000;

fn main() {
    divan::main();
}

fn codes(len: usize) -> Vec<i32> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as i32 % 20_000
    };
    (0..len).map(|_| next()).collect()
}

fn rate(len: usize) -> Vec<f64> {
    codes(len).into_iter().map(|code| f64::from(code) / 23_425.0).collect()
}

/// Averaging factors 1, 2, 3, then four per octave, as in `Taus::Fine`.
fn fine(len: usize) -> Vec<u64> {
    let octaves = (0..).flat_map(|k| [4, 5, 6, 7].map(|m| m << k));
    [1, 2, 3].into_iter().chain(octaves.take_while(|m| 2 * m <= len as u64)).collect()
}

#[divan::bench(args = [Stat::Oadev, Stat::Mdev, Stat::Ohdev, Stat::Totdev], sample_count = 3, sample_size = 1)]
fn hour_f64_fine(bencher: Bencher<'_, '_>, stat: Stat) {
    let (rate, m) = (rate(HOUR), fine(HOUR));
    bencher.bench_local(|| deviations(&Input::Rate(black_box(&rate)), 5700.0, stat, &m));
}

#[divan::bench(args = Stat::ALL, sample_count = 3, sample_size = 1)]
fn hour_f64_octaves(bencher: Bencher<'_, '_>, stat: Stat) {
    let (rate, m) = (rate(HOUR), octaves(HOUR));
    bencher.bench_local(|| deviations(&Input::Rate(black_box(&rate)), 5700.0, stat, &m));
}

#[divan::bench(args = Stat::ALL, sample_count = 3, sample_size = 1)]
fn hour_codes_octaves(bencher: Bencher<'_, '_>, stat: Stat) {
    let (codes, m) = (codes(HOUR), octaves(HOUR));
    bencher.bench_local(|| deviations(&Input::Codes { codes: black_box(&codes), gaps: &[] }, 5700.0, stat, &m));
}

#[divan::bench(sample_count = 3, sample_size = 1)]
fn hour_f64_100_times(bencher: Bencher<'_, '_>) {
    let rate = rate(HOUR);
    let m: Vec<u64> = (0..100).map(|k| (HOUR as f64 / 2.0).powf(f64::from(k) / 99.0) as u64).collect();
    bencher.bench_local(|| deviations(&Input::Rate(black_box(&rate)), 5700.0, Stat::Oadev, &m));
}

#[divan::bench(sample_count = 20, sample_size = 1)]
fn step_8_f64_octaves(bencher: Bencher<'_, '_>) {
    let (rate, m) = (rate(STEP_8), octaves(STEP_8));
    bencher.bench_local(|| deviations(&Input::Rate(black_box(&rate)), 5700.0, Stat::Oadev, &m));
}

/// A million samples, like 2.8 h at 100 Hz: white noise with a random walk.
fn record() -> Vec<f64> {
    let uniform = rate(12_000_000);
    let mut walk = 0.0;
    let sample = |twelve: &[f64]| {
        let white = twelve.iter().sum::<f64>() - 12.0 * 10_000.0 / 23_425.0;
        walk += 1e-3 * white;
        white + walk
    };
    uniform.chunks_exact(12).map(sample).collect()
}

/// Fits the noise model, including the search for outliers and steps.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn noise_model(bencher: Bencher<'_, '_>) {
    let record = record();
    bencher.bench_local(|| fit(&Input::Rate(black_box(&record)), 100.0, &FitOptions::default()));
}

/// Fits the spectrum only: one transform, the choice of the terms and their intervals.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn noise_model_of_the_spectrum(bencher: Bencher<'_, '_>) {
    let record = record();
    let options = FitOptions { cut_glitches: false, remove_steps: false, ..FitOptions::default() };
    bencher.bench_local(|| fit(&Input::Rate(black_box(&record)), 100.0, &options));
}
