//! Benchmarks of noise models of a million samples. `cargo xtask bench-peers` times the deviations.

use divan::{Bencher, black_box};
use zerorate_allan::{FitOptions, Input, fit};

fn main() {
    divan::main();
}

fn rate(len: usize) -> Vec<f64> {
    let mut state = 1u64;
    let mut next = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        f64::from((state >> 33) as i32 % 20_000) / 23_425.0
    };
    (0..len).map(|_| next()).collect()
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
