//! Tests N and K that cover the noise.

use super::*;

#[test]
fn n_and_k_cover_the_curve() {
    let fit = of(&Truth { b: 3.0 * HOUR.b, ..HOUR }.noise(360_000, 920));
    let found = fit.covering(Usage::Filter, Some(300.0)).unwrap();
    let claimed = |tau_s: f64| found.n * found.n / tau_s + found.k * found.k * tau_s / 3.0;
    for m in fit.curve.iter().map(|point| point.m) {
        let (tau_s, dev) = (m as f64 / RATE_HZ, fit.deviation(m));
        if (1.0..=300.0).contains(&tau_s) {
            assert!(claimed(tau_s) >= dev * dev * (1.0 - 1e-9), "{tau_s}");
        }
    }
    let at_horizon = fit.model.noise_variance((300.0 * RATE_HZ) as u64);
    assert!(claimed(300.0) >= at_horizon * (1.0 - 1e-9), "{found:?}");
    assert!(found.n >= fit.n.value && found.n <= 2.0 * fit.n.value && found.excess < 3.0, "{found:?}");
    assert!(fit.covering(Usage::Filter, Some(1e-3)).is_none());
}

#[test]
fn a_batch_has_the_fitted_n_and_a_lifted_k() {
    let fit = of(&Truth { b: 3.0 * HOUR.b, ..HOUR }.noise(360_000, 920));
    let found = fit.covering(Usage::Batch, None).unwrap();
    assert_eq!((found.n, found.horizon_s), (fit.n.value, 100.0));
    for (tau_s, dev) in [1.28, 10.24, 81.92].map(|tau_s| (tau_s, fit.deviation((tau_s * RATE_HZ) as u64))) {
        let claimed = found.n * found.n / tau_s + found.k * found.k * tau_s / 3.0;
        assert!(claimed >= 0.9 * dev * dev * (1.0 - 1e-9), "{tau_s}");
    }
    let walk = of(&Truth { b: 0.0, k: 1e-3, ..HOUR }.noise(360_000, 921));
    let found = walk.covering(Usage::Batch, None).unwrap();
    assert!(found.k >= walk.k.value && found.k < 1.5e-3, "{found:?} {:?}", walk.k);
}

/// A short record's curve scatters by a third at its long end.
#[test]
fn the_scatter_of_a_short_record_is_not_covered() {
    for seed in 930..935 {
        let fit = of(&Truth { b: 0.0, k: 0.0, ..HOUR }.noise(20_000, seed));
        let found = fit.covering(Usage::Filter, None).unwrap();
        assert!(found.n < 1.1 * HOUR.n, "{seed}: {} of {}", found.n, HOUR.n);
    }
}

#[test]
fn the_bound_covers_deviations_above_the_model() {
    let mut fit = of(&HOUR.noise(360_000, 940));
    let off = fit.curve.iter().position(|point| point.m == 4096).unwrap();
    fit.curve[off].dev *= 2.0;
    let (tau_s, dev) = (4096.0 / RATE_HZ, fit.curve[off].dev);
    let found = fit.covering(Usage::Filter, None).unwrap();
    assert!(found.n * found.n / tau_s + found.k * found.k * tau_s / 3.0 >= dev * dev * (1.0 - 1e-9));
}

/// N and K stay nearly the same if an oscillation, a drift or a warm-up many times as large as the noise is added.
#[test]
fn the_bound_leaves_motion_and_drift_out() {
    let noise = HOUR.noise(360_000, 950);
    let with = |of: &dyn Fn(f64) -> f64| {
        let added = noise.iter().enumerate().map(|(i, rate)| rate + of(i as f64 / RATE_HZ));
        super::of(&added.collect::<Vec<f64>>())
    };
    let sway = |hz: f64| move |t_s: f64| 0.2 * (2.0 * PI * hz * t_s).sin();
    let still = with(&|_| 0.0);
    for (name, fit) in [
        ("0.5 Hz", with(&sway(0.5))),
        ("0.03 Hz", with(&sway(0.03))),
        ("drift", with(&|t_s| 3e-4 * t_s)),
        // between two of the time constants that are tried first
        ("warm-up", with(&|t_s| 0.3 * (-t_s / 1200.0).exp())),
        ("drift and sway", with(&|t_s| 3e-4 * t_s + sway(0.31)(t_s))),
    ] {
        for usage in [Usage::Filter, Usage::Batch] {
            let [alone, found] = [&still, &fit].map(|fit| fit.covering(usage, None).unwrap());
            assert!(near(found.n, alone.n, 0.2) && near(found.k, alone.k, 0.3), "{name}: {found:?} for {alone:?}");
        }
    }
}
