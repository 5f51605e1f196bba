//! Tests spectral lines with sines of known power, and the comparison of the measured curve with the model.

use super::*;
use crate::Cause;

/// White noise of standard deviation 1 with a sine, whose phase does not fit the ends.
fn with_sine(n: usize, rate_hz: f64, hz: f64, amplitude: f64) -> Vec<f64> {
    let mut draw = normal(90);
    (0..n).map(|i| draw() + amplitude * (2.0 * PI * hz * i as f64 / rate_hz + 0.3).sin()).collect()
}

fn lines(fit: &Fit) -> Vec<Line> {
    fit.lines().copied().collect()
}

/// Below a few hundred coefficients a strong sine leaks over whole bins. These bins were once masked and became a
/// second line of the same power, and the model's curve was √2 too high.
#[test]
fn the_power_of_a_sine_is_counted_once() {
    for (hz, rate_hz, n) in [
        (0.02, 20.0, 100_000),
        (0.0637, 200.0, 200_000),
        (0.100_03, 50.0, 100_000),
        (0.231, 100.0, 60_000),
        (0.5, 100.0, 60_000),
        (1.003, 100.0, 60_000),
        (5.0, 100.0, 60_000),
        (20.01, 100.0, 60_000),
    ] {
        for amplitude in [1.0, 3.0] {
            let rate = with_sine(n, rate_hz, hz, amplitude);
            let fit = fit(&Input::Rate(&rate), rate_hz, &FitOptions::default()).unwrap();
            let found = lines(&fit);
            let [line] = found[..] else { panic!("{hz} Hz, {amplitude}: {found:?}") };
            assert!(near(line.rms * line.rms, amplitude * amplitude / 2.0, 0.05), "{hz} Hz, {amplitude}: {line:?}");
            assert!(near(line.frequency_hz, hz, 0.01), "{hz} Hz, {amplitude}: {line:?}");
            assert!(codes(&fit).contains(&"lines"), "{hz} Hz, {amplitude}");
            let curve = analyse(&Input::Rate(&rate), rate_hz, &Options::default()).unwrap();
            let seen = |point: &&Point| (PI * hz * point.tau_s).sin().powi(2) > 0.1 && point.m < n as u64 / 64;
            for point in curve.points.iter().filter(seen) {
                let expected = fit.deviation(point.m);
                assert!(near(point.dev, expected, 0.05), "{hz} Hz, {amplitude}: {point:?} for {expected}");
            }
        }
    }
}

/// A sine of 200 times the noise would leak all over the spectrum, so it is removed. A sine that lasts for only half
/// of the record stays, makes N more than 1.5 times too large, and is reported.
#[test]
fn a_line_that_drowns_the_noise_is_removed_or_reported() {
    let said = |rate: &[f64]| {
        let fit = of(rate);
        let said = fit.warnings.iter().find(|warning| warning.code() == "leakage").map(ToString::to_string);
        (fit.n.value * 100f64.sqrt(), said)
    };
    for amplitude in [3.0, 200.0, 2e4] {
        let (n, leakage) = said(&with_sine(60_000, 100.0, 5.003, amplitude));
        assert!(near(n, 1.0, 0.02) && leakage.is_none(), "{amplitude}: {n} {leakage:?}");
    }
    let mut half = with_sine(60_000, 100.0, 5.003, 200.0);
    half[..30_000].copy_from_slice(&with_sine(30_000, 100.0, 5.003, 0.0));
    let (n, leakage) = said(&half);
    assert!(n > 1.5 && leakage.unwrap().contains("the line at 5.00"), "{n}");
}

/// A sine of 0.02 Hz is too slow to become a line. The curve shows it, and the fitted part of the spectrum hardly
/// does.
#[test]
fn a_curve_off_the_model_is_reported() {
    let rate = with_sine(100_000, 100.0, 0.02, 0.5);
    let fit = of(&rate);
    // the curve is off at averages up to 1/128 of the record, where a model has to hold
    assert!(lines(&fit).is_empty() && fit.is_rejected, "{} {:?}", fit.model_error, fit.misfit);
    let misfit = fit.misfit.unwrap();
    assert!(misfit.from_hz < 0.05 && misfit.cause == Cause::Resonance, "{} {misfit:?}", fit.model_error);
    let off = fit.warnings.iter().find(|warning| warning.code() == "off-curve").unwrap();
    let AllanWarning::OffCurve { ratio, octaves, .. } = *off else { panic!("{off:?}") };
    assert!(!(0.67..1.5).contains(&ratio) && octaves > 3, "{off:?}");
    assert!(off.to_string().contains("octaves off); do not use it there"), "{off}");
    let longer = with_sine(100_000, 100.0, 0.005, 0.3);
    let longer = of(&longer);
    assert!(!longer.is_rejected && codes(&longer).contains(&"off-curve"), "{:?} {:?}", longer.warnings, longer.misfit);
    for seed in 91..95 {
        assert!(!codes(&of(&HOUR.noise(60_000, seed))).contains(&"off-curve"));
    }
}

/// A slow line leaks only into the slow noise beside it. Such a line once gave B = 0 where the true B is 9 °/h.
#[test]
fn a_slow_line_that_hides_the_flicker_is_removed_or_reported() {
    let noise = HOUR.noise(360_000, 26);
    let with = |hz: f64, amplitude: f64, from: usize| {
        let sine =
            |i: usize| if i < from { 0.0 } else { amplitude * (2.0 * PI * hz * i as f64 / RATE_HZ + 0.3).sin() };
        of(&noise.iter().enumerate().map(|(i, rate)| rate + sine(i)).collect::<Vec<f64>>())
    };
    let alone = of(&noise);
    for (hz, amplitude) in [(0.01, 0.05), (0.5, 0.02), (0.01, 0.002), (0.0123, 2.0)] {
        let fit = with(hz, amplitude, 0);
        assert!(!codes(&fit).contains(&"leakage") && near(fit.b.value, alone.b.value, 0.05), "{hz} Hz, {amplitude}");
    }
    assert!(codes(&with(0.01, 0.05, 180_000)).contains(&"leakage"));
}

/// A record with gaps has no transform of the whole, and the segments of its levels are too short for a slow line.
#[test]
fn a_slow_line_beside_gaps_is_taken_out() {
    let sine = |i: usize| 0.05 * (2.0 * PI * 0.01 * i as f64 / RATE_HZ + 0.3).sin();
    let mut rate = HOUR.noise(360_000, 26);
    rate[150_000..160_000].fill(f64::NAN);
    let alone = of(&rate);
    rate.iter_mut().enumerate().for_each(|(i, rate)| *rate += sine(i));
    let fit = of(&rate);
    assert!(near(fit.b.value, alone.b.value, 0.05) && near(fit.n.value, alone.n.value, 0.01), "{:?}", fit.b);
    assert!(!codes(&fit).contains(&"leakage") && lines(&fit).len() == 1);
}

#[test]
fn an_impractical_length_is_not_advised() {
    let said = |needed_s| AllanWarning::NotIdentified { noise: Noise::RateRandomWalk, record_s: 60.0, needed_s };
    assert!(said(900.0).to_string().ends_with("a value of this order takes about 15 min"));
    assert!(said(7200.0).to_string().ends_with("a value of this order takes about 2.0 h"));
    let endless = said(602_803_200.0).to_string();
    assert!(endless.contains("in any practical record") && !endless.contains("602803200"), "{endless}");
}

/// 300 samples do not show the filter of a sensor, so N may be off by more than its interval.
#[test]
fn a_short_record_has_a_warning() {
    let white = Truth { n: 0.01, ..Truth::default() };
    let [short, long] = [300, 2000].map(|n| of(&white.noise(n, 96)));
    let said = short.warnings.iter().find(|warning| warning.code() == "short-record").unwrap().to_string();
    assert!(said.starts_with("300 samples") && said.contains("record 2000 or more"), "{said}");
    assert!(!codes(&long).contains(&"short-record"));
}
