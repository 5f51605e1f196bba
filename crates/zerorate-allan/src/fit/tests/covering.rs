//! How sure a Kalman filter is that is told N and K of another record of the same sensor.

use super::*;

/// Spans over which the filter goes on without a reference, s.
const SPANS_S: [usize; 3] = [10, 60, 300];
/// It learns the bias before, s.
const LEARNS_S: usize = 600;

/// Mean of the squared error of the angle over the variance that the filter claims, for each span; 1 is right.
fn squared_errors(rate: &[f64], n: f64, k: f64) -> [f64; 3] {
    let means: Vec<f64> = rate.chunks_exact(RATE_HZ as usize).map(|s| s.iter().sum::<f64>() / RATE_HZ).collect();
    let (mut bias, mut variance) = (0.0, 1.0);
    let mut sums = [(0.0, 0.0); 3];
    for (second, mean) in means.iter().enumerate() {
        if second >= LEARNS_S && second % 30 == 0 {
            for (span, (sum, count)) in SPANS_S.iter().zip(&mut sums) {
                let Some(ahead) = means.get(second..second + span) else { continue };
                let (error, t) = (ahead.iter().map(|mean| mean - bias).sum::<f64>(), *span as f64);
                *sum += error * error / (variance * t * t + n * n * t + k * k * t * t * t / 3.0);
                *count += 1.0;
            }
        }
        // standing still again: the rate is the bias
        variance += k * k;
        let gain = variance / (variance + n * n);
        bias += gain * (mean - bias);
        variance *= 1.0 - gain;
    }
    sums.map(|(sum, count)| sum / count)
}

/// docs/imu.md quotes what this prints (`--nocapture`).
#[test]
fn numbers_that_cover_the_curve_make_a_filter_that_knows_its_error() {
    let sensors = [
        ("N, B and K", HOUR),
        ("ten times the floor", Truth { b: 10.0 * HOUR.b, ..HOUR }),
        ("a memory of 50 s", Truth { sigma: 0.01, tau_s: 50.0, b: 0.0, k: 0.0, ..HOUR }),
        ("a memory of 5 s", Truth { sigma: 0.02, tau_s: 5.0, b: 0.0, k: 0.0, ..HOUR }),
    ];
    for (name, truth) in sensors {
        let mut found = [[0.0; 3]; 2];
        for seed in 0..4 {
            let fit = of(&truth.noise(360_000, 900 + 2 * seed));
            let covering = fit.covering(None).unwrap();
            let other = truth.noise(360_000, 901 + 2 * seed);
            let pairs = [(fit.n.value, fit.k.value), (covering.n, covering.k)];
            for (sums, (n, k)) in found.iter_mut().zip(pairs) {
                sums.iter_mut().zip(squared_errors(&other, n, k)).for_each(|(sum, error)| *sum += error / 4.0);
            }
        }
        let [fitted, covering] = found;
        std::println!("{name}: fitted {fitted:.2?}, covering {covering:.2?}");
        assert!(covering.iter().all(|error| *error < 1.3), "{name}: {covering:?}");
        assert!(covering[0] > 0.5, "{name}: {covering:?}");
    }
}

#[test]
fn the_numbers_cover_the_curve() {
    let fit = of(&Truth { b: 3.0 * HOUR.b, ..HOUR }.noise(360_000, 920));
    let found = fit.covering(Some(300.0)).unwrap();
    let claimed = |tau_s: f64| found.n * found.n / tau_s + found.k * found.k * tau_s / 3.0;
    for m in fit.curve.iter().map(|point| point.m) {
        let (tau_s, dev) = (m as f64 / RATE_HZ, fit.deviation(m));
        if (1.0..=300.0).contains(&tau_s) {
            assert!(claimed(tau_s) >= dev * dev * (1.0 - 1e-9), "{tau_s}");
        }
    }
    assert!(found.n >= fit.n.value && found.n <= 2.0 * fit.n.value && found.excess < 3.0, "{found:?}");
    assert!(fit.covering(Some(1e-3)).is_none());
}

/// A short record's curve scatters by a third at its long end.
#[test]
fn chance_is_not_covered() {
    for seed in 930..935 {
        let fit = of(&Truth { b: 0.0, k: 0.0, ..HOUR }.noise(20_000, seed));
        let found = fit.covering(None).unwrap();
        assert!(found.n < 1.1 * HOUR.n, "{seed}: {} of {}", found.n, HOUR.n);
    }
}

#[test]
fn what_the_model_does_not_know_is_covered() {
    let mut fit = of(&HOUR.noise(360_000, 940));
    let off = fit.curve.iter().position(|point| point.m == 4096).unwrap();
    fit.curve[off].dev *= 2.0;
    let (tau_s, dev) = (4096.0 / RATE_HZ, fit.curve[off].dev);
    let found = fit.covering(None).unwrap();
    assert!(found.n * found.n / tau_s + found.k * found.k * tau_s / 3.0 >= dev * dev * (1.0 - 1e-9));
}
