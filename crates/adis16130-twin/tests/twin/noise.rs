//! Tests the noise of the twin: densities, bandwidth, resonance, flicker, random walk.

use crate::bus::{Host, celsius, deviation, quiet};
use adis16130_twin::{Roa, Spec, Twin};
use std::f64::consts::PI;

const PAIR_HZ: f64 = 6.0e6 / 1054.0;
const SEGMENT: usize = 2048;

fn white() -> Spec {
    Spec { noise: true, resonance_dps_rms: 0.0, flicker_floor_dps: 0.0, rrw_dps_per_rt_s: 0.0, ..quiet() }
}

/// Mean one-sided density over [low, high] Hz, by averaged Hann periodograms.
fn density(values: &[f64], low: f64, high: f64) -> f64 {
    let window: Vec<f64> = (0..SEGMENT).map(|i| 1.0 - (2.0 * PI * i as f64 / SEGMENT as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let bins = (low * SEGMENT as f64 / PAIR_HZ).round() as usize..=(high * SEGMENT as f64 / PAIR_HZ).round() as usize;
    let bin_count = bins.clone().count();
    let segments = values.chunks_exact(SEGMENT);
    let segment_count = segments.len();
    let mut sum = 0.0;
    for segment in segments {
        let mean = segment.iter().sum::<f64>() / SEGMENT as f64;
        let windowed: Vec<f64> = segment.iter().zip(&window).map(|(x, w)| (x - mean) * w).collect();
        sum += bins.clone().map(|bin| line_power(&windowed, bin as f64 / SEGMENT as f64)).sum::<f64>();
    }
    2.0 * sum / (power * PAIR_HZ * (bin_count * segment_count) as f64)
}

/// Power of a spectral line, |Σ x·e^(−2πifn)|², f in cycles per sample.
fn line_power(values: &[f64], f: f64) -> f64 {
    let (mut re, mut im) = (0.0, 0.0);
    for (n, x) in values.iter().enumerate() {
        let (sin, cos) = (2.0 * PI * (f * n as f64).fract()).sin_cos();
        re += x * cos;
        im += x * sin;
    }
    re * re + im * im
}

#[test]
fn white_density_and_bandwidth_are_f02_and_f03() {
    let rates = Host::started(white()).rates(200 * SEGMENT);
    let low = density(&rates, 10.0, 50.0);
    assert!((low.sqrt() / 0.0125 - 1.0).abs() < 0.02, "{}", low.sqrt());
    // The density falls by 3 dB at 300 Hz. At two more frequencies it follows the two poles.
    let at = |f: f64| density(&rates, f - 15.0, f + 15.0) / low;
    assert!((at(300.0) - 0.5).abs() < 0.03, "{}", at(300.0));
    for f in [150.0, 1000.0] {
        let poles = 1.0 / ((1.0 + (f / 327.0f64).powi(2)) * (1.0 + (f / 1000.0f64).powi(2)));
        assert!((at(f) / poles - 1.0).abs() < 0.12, "{f} Hz: {} for {poles}", at(f));
    }
}

#[test]
fn capacitor_halves_the_noise_and_gives_50_hz() {
    let open = Host::started(white()).rates(50_000);
    let rates = Host::started(Spec { roa: Roa::TenNanofarad, ..white() }).rates(200 * SEGMENT);
    let ratio = deviation(&rates) / deviation(&open);
    assert!((0.4..0.55).contains(&ratio), "{ratio}");
    for f in [20.0, 50.0, 200.0] {
        let poles = 1.0 / ((1.0 + (f / 50.0f64).powi(2)) * (1.0 + (f / 1000.0f64).powi(2)));
        let found = density(&rates, f - 5.0, f + 5.0) / 0.0125f64.powi(2);
        assert!((found / poles - 1.0).abs() < 0.08, "{f} Hz: {found} for {poles}");
    }
}

#[test]
fn resonance_aliases_as_f07() {
    let spec = Spec { white_dps_per_rt_hz: 0.0, resonance_dps_rms: 0.02, ..white() };
    let rates = Host::started(spec).rates(20_000);
    assert!((deviation(&rates) - 0.02).abs() < 0.0005);
    // F-07: three sample rates less 14.3 kHz is 2.78 kHz.
    let alias = PAIR_HZ - (14_300.0 - 2.0 * PAIR_HZ);
    assert!((alias - 2778.0).abs() < 1.0);
    let amplitude = 2.0 * line_power(&rates, alias / PAIR_HZ).sqrt() / rates.len() as f64;
    assert!((amplitude / 2.0f64.sqrt() - 0.02).abs() < 0.0005, "{amplitude}");
}

#[test]
fn temperature_noise_is_m05() {
    let mut host = Host::started(Spec { warmup_c: 0.0, ambient_wander_c: 0.0, ..white() });
    let temps: Vec<f64> = (0..100_000).map(|_| celsius(host.pair().2)).collect();
    // A single reading carries about 0.05 °C (F-51).
    assert!((deviation(&temps) - 0.0534).abs() < 0.001, "{}", deviation(&temps));
    let low = density(&temps, 10.0, 500.0);
    assert!((low.sqrt() / 0.001 - 1.0).abs() < 0.02, "{}", low.sqrt());
}

/// Non-overlapping Allan variance. Each average covers `m` values.
fn allan_variance(values: &[f64], m: usize) -> f64 {
    let means: Vec<f64> = values.chunks_exact(m).map(|chunk| chunk.iter().sum::<f64>() / m as f64).collect();
    let sum: f64 = means.windows(2).map(|pair| (pair[1] - pair[0]).powi(2)).sum();
    sum / (2.0 * (means.len() - 1) as f64)
}

#[test]
fn flicker_floor_is_m04() {
    // the flicker alone, sampled at 50 Hz from the truth of an idle twin
    let mut variances = [0.0; 4];
    let averages = [50, 250, 1000, 2500];
    let seeds = 6;
    for seed in 1..=seeds {
        let twin = Twin::new(Spec { seed, ..Spec::typical() });
        let flicker: Vec<f64> = (0..100_000)
            .map(|_| {
                twin.advance_ns(20_000_000);
                twin.truth().flicker_dps
            })
            .collect();
        for (variance, m) in variances.iter_mut().zip(averages) {
            *variance += allan_variance(&flicker, m) / seeds as f64;
        }
    }
    for (variance, m) in variances.into_iter().zip(averages) {
        let floor = variance.sqrt();
        assert!((floor / 0.0016 - 1.0).abs() < 0.1, "{floor} °/s at {} s", m as f64 * 0.02);
    }
}

#[test]
fn flicker_is_stationary_and_its_variance_is_its_band() {
    // Σ (B²/π)·ln(cell ratio) = (B²/π)·ln(10/1e-4), at the start as later.
    let b = 0.0016 / 0.664;
    let expected = b * b / PI * (10.0f64 / 1e-4).ln();
    let units: Vec<Twin> = (0..1000).map(|seed| Twin::new(Spec { seed, ..Spec::typical() })).collect();
    for later_ns in [0, 4_000_000_000] {
        let sum: f64 = units
            .iter()
            .map(|twin| {
                twin.advance_ns(later_ns);
                twin.truth().flicker_dps.powi(2)
            })
            .sum();
        assert!((sum / 1000.0 / expected - 1.0).abs() < 0.18, "{later_ns}: {}", sum / 1000.0 / expected);
    }
}

#[test]
fn random_walk_grows_as_the_root_of_time() {
    let walks = |seconds: u64| {
        let squares = (0..300).map(|seed| {
            // 10 Hz leaves no flicker band, which makes the twin faster
            let twin = Twin::new(Spec { seed, flicker_hz: 10.0, ..Spec::typical() });
            assert_eq!(twin.truth().random_walk_dps, 0.0);
            twin.advance_ns(seconds * 500_000_000);
            twin.power_off(); // the random walk goes on without supply
            twin.advance_ns(seconds * 500_000_000);
            twin.truth().random_walk_dps.powi(2)
        });
        squares.sum::<f64>() / 300.0
    };
    for seconds in [4, 64] {
        let expected = 1e-8 * seconds as f64;
        assert!((walks(seconds) / expected - 1.0).abs() < 0.33, "{seconds} s");
    }
}

#[test]
fn ambient_wanders() {
    let squares = (0..400).map(|seed| {
        let twin = Twin::new(Spec { seed, flicker_hz: 10.0, warmup_c: 0.0, ..Spec::typical() });
        (twin.truth().sensor_c - 25.0).powi(2)
    });
    let rms = (squares.sum::<f64>() / 400.0).sqrt();
    assert!((rms / 0.05 - 1.0).abs() < 0.15, "{rms}");
}
