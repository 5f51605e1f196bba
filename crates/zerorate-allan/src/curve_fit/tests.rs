use super::*;
use crate::{Input, Stat, deviations};
use std::string::ToString;

/// The formula of IEEE Std 952-1997 C.1, written out independently of the code under test.
fn curve(q: f64, n: f64, b: f64, k: f64, r: f64, samples: u64) -> Vec<Deviation> {
    crate::octaves(samples as usize)
        .into_iter()
        .map(|m| {
            let tau = m as f64 / 100.0;
            let flicker = 2.0 * core::f64::consts::LN_2 / core::f64::consts::PI * b * b;
            let slow = k * k * tau / 3.0 + (r * tau).powi(2) / 2.0;
            let variance = 3.0 * (q / tau).powi(2) + n * n / tau + flicker + slow;
            Deviation { m, dev: variance.sqrt(), n: samples - 2 * m + 1 }
        })
        .collect()
}

fn near(value: f64, truth: f64, relative: f64) -> bool {
    (value - truth).abs() <= relative * truth.abs()
}

#[test]
fn curves_without_noise_give_their_coefficients() {
    for scale in [1e-9, 1.0, 1e9] {
        let (n, b, k) = (0.01 * scale, 0.003 * scale, 3e-4 * scale);
        let fit = fit_curve(&curve(0.0, n, b, k, 0.0, 3_600_000), 100.0, 3_600_000).unwrap();
        assert!(near(fit.n.value, n, 1e-6) && near(fit.b.value, b, 1e-5), "{fit:?}");
        assert!(near(fit.k.value, k, 0.05), "{fit:?}");
        assert!(fit.n.identified && fit.b.identified && fit.k.identified && fit.warnings.is_empty(), "{fit:?}");
        assert!(fit.q.is_none() && fit.r.is_none() && fit.chi2 < 1e-6);
        assert!(fit.n.lo < n && n < fit.n.hi && fit.k.lo < k && k < fit.k.hi);
    }
}

#[test]
fn quantisation_and_ramp_appear_only_where_they_are() {
    let fit = fit_curve(&curve(1e-4, 0.01, 0.003, 3e-4, 3e-5, 3_600_000), 100.0, 3_600_000).unwrap();
    let (q, r) = (fit.q.unwrap(), fit.r.unwrap());
    assert!(near(q.value, 1e-4, 1e-5) && near(r.value, 3e-5, 1e-4), "{fit:?}");
    let codes: Vec<&str> = fit.warnings.iter().map(AllanWarning::code).collect();
    assert!(codes.contains(&"quantisation-limited") && codes.contains(&"drift"), "{codes:?}");
}

/// For white noise the relative standard deviation of N from all L samples is 1/√(2L), since Σy²/L has 2/L of relative
/// variance.
#[test]
fn interval_of_white_noise_is_that_of_a_variance() {
    let samples = 360_000;
    let fit = fit_curve(&curve(0.0, 0.01, 0.0, 0.0, 0.0, samples), 100.0, samples).unwrap();
    let half_width = (fit.n.hi - fit.n.lo) / 2.0 / 0.01;
    assert!(near(half_width, 1.96 / (2.0 * samples as f64).sqrt(), 0.1), "{half_width}");
    assert!(fit.b.needed_s.unwrap() > 3600.0 && fit.b.needed_s.unwrap().is_finite());
    assert!(fit.k.needed_s.unwrap() > 3600.0 && fit.k.needed_s.unwrap().is_finite());
}

/// A first-order low-pass of time constant T on white noise: σ² = N²/τ · (1 − (T/2τ)(3 − 4e^(−τ/T) + e^(−2τ/T))).
#[test]
fn points_below_the_corner_of_a_low_pass_leave() {
    let (n, t) = (0.01, 0.05);
    let mut points = curve(0.0, n, 0.0, 0.0, 0.0, 360_000);
    for point in &mut points {
        let tau = point.m as f64 / 100.0;
        let gap = 3.0 - 4.0 * (-tau / t).exp() + (-2.0 * tau / t).exp();
        point.dev *= (1.0 - t / (2.0 * tau) * gap).sqrt();
    }
    let fit = fit_curve(&points, 100.0, 360_000).unwrap();
    assert!(near(fit.n.value, n, 0.003), "{fit:?}");
    assert!(fit.n.lo < n && n < fit.n.hi);
    assert!(matches!(fit.warnings[0], AllanWarning::ShortEndExcluded { points: 1.., .. }), "{:?}", fit.warnings);
}

/// A first-order low-pass in samples: noise with the autocovariance aᵏ. A sum of m samples has the variance below, and
/// the difference of two adjacent sums 4 var(m) − var(2m).
#[test]
fn a_low_pass_of_a_few_samples_does_not_spoil_the_coefficients() {
    let a = (-1.0f64 / 3.0).exp();
    let of_sum = |m: f64| m * (1.0 + a) / (1.0 - a) - 2.0 * a * (1.0 - a.powf(m)) / (1.0 - a).powi(2);
    let (n, b, k) = (0.01, 0.003, 3e-4);
    let white = curve(0.0, n, 0.0, 0.0, 0.0, 3_600_000);
    let mut points = curve(0.0, n, b, k, 0.0, 3_600_000);
    for (point, white) in points.iter_mut().zip(&white) {
        let m = point.m as f64;
        let kept = (4.0 * of_sum(m) - of_sum(2.0 * m)) / (2.0 * m) * (1.0 - a) / (1.0 + a);
        point.dev = (point.dev.powi(2) - white.dev.powi(2) * (1.0 - kept)).sqrt();
    }
    let fit = fit_curve(&points, 100.0, 3_600_000).unwrap();
    assert!(near(fit.n.value, n, 0.002) && near(fit.b.value, b, 0.02) && near(fit.k.value, k, 0.06), "{fit:?}");
    assert!(fit.n.lo < n && n < fit.n.hi, "{fit:?}");
    let codes: Vec<&str> = fit.warnings.iter().map(AllanWarning::code).collect();
    assert_eq!(codes, ["short-end-excluded"]);
}

#[test]
fn a_sine_is_reported() {
    let mut points = curve(0.0, 0.01, 0.003, 3e-4, 0.0, 3_600_000);
    let (amplitude, frequency) = (0.01, 0.2);
    for point in &mut points {
        let x = core::f64::consts::PI * frequency * point.m as f64 / 100.0;
        point.dev = (point.dev.powi(2) + amplitude * amplitude * x.sin().powi(4) / (x * x)).sqrt();
    }
    let fit = fit_curve(&points, 100.0, 3_600_000).unwrap();
    let seen = fit.warnings.iter().find_map(|warning| match warning {
        AllanWarning::Periodic { frequency_hz, .. } => Some(*frequency_hz),
        _ => None,
    });
    assert!(seen.is_some_and(|seen| seen / frequency < 2.0 && seen / frequency > 0.5), "{:?}", fit.warnings);
    assert!(fit.warnings[0].to_string().contains("something lifts the curve"));
    assert!(fit.q.is_none() && fit.r.is_none());
}

#[test]
fn unusable_input_is_an_error() {
    assert_eq!(fit_curve(&[], 100.0, 0), Err(CurveError::TooFew { points: 0, needed: 4 }));
    let zeros: Vec<Deviation> = (0..10).map(|k| Deviation { m: 1 << k, dev: 0.0, n: 100 }).collect();
    assert_eq!(fit_curve(&zeros, 100.0, 4096), Err(CurveError::TooFew { points: 0, needed: 4 }));
    for value in [f64::NAN, f64::INFINITY, f64::MAX, f64::MIN_POSITIVE] {
        let odd: Vec<Deviation> = (0..10).map(|k| Deviation { m: 1 << k, dev: value, n: 1 }).collect();
        if let Ok(fit) = fit_curve(&odd, 100.0, 4096) {
            assert!(fit.n.value.is_finite() && fit.b.value.is_finite() && fit.k.value.is_finite(), "{value}: {fit:?}");
        }
    }
}

#[test]
fn dense_averaging_times_are_thinned() {
    let octaves = curve(0.0, 0.01, 0.003, 3e-4, 0.0, 360_000);
    let dense: Vec<Deviation> = octaves.iter().flat_map(|p| [*p, Deviation { m: p.m + 1, ..*p }]).collect();
    let (from_octaves, from_dense) =
        (fit_curve(&octaves, 100.0, 360_000).unwrap(), fit_curve(&dense, 100.0, 360_000).unwrap());
    assert!(near(from_dense.n.value, from_octaves.n.value, 1e-3));
}

/// Walks of a small generator of our own: N and K lie within ten times their stated interval.
#[test]
fn a_simulated_record() {
    let mut state = 1u64;
    let mut normal = || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    let (n, k, rate_hz) = (0.01, 1e-3, 10.0f64);
    let mut walk = 0.0;
    let rate: Vec<f64> = (0..36_000)
        .map(|_| {
            walk += k / rate_hz.sqrt() * normal();
            n * rate_hz.sqrt() * normal() + walk
        })
        .collect();
    let octaves = crate::octaves(rate.len());
    let points = deviations(&Input::Rate(&rate), rate_hz, Stat::Oadev, &octaves);
    let points: Vec<Deviation> = points.into_iter().map(Result::unwrap).collect();
    let fit = fit_curve(&points, rate_hz, 36_000).unwrap();
    assert!(near(fit.n.value, n, 0.02) && near(fit.k.value, k, 0.5), "{fit:?}");
    assert!(fit.n.identified && fit.k.identified && fit.k.lo < k && k < fit.k.hi, "{fit:?}");
}
