//! Tests noise behind filters, records with gaps, and long records.

use super::*;

/// N of the white noise. Filters with gain 1 at frequency 0 do not change it.
const N: f64 = 0.1;

fn white(n: usize, seed: u64) -> Vec<f64> {
    let mut draw = normal(seed);
    (0..n).map(|_| N * RATE_HZ.sqrt() * draw()).collect()
}

fn moving_average(x: &[f64], weights: &[f64]) -> Vec<f64> {
    let total: f64 = weights.iter().sum();
    x.windows(weights.len()).map(|x| x.iter().zip(weights).map(|(x, w)| x * w / total).sum()).collect()
}

/// A Butterworth low-pass of the second order.
fn low_pass(x: &[f64], hz: f64) -> Vec<f64> {
    resonant(x, hz, 0.5f64.sqrt())
}

/// A low-pass of the second order with the quality `q`, by the bilinear transform.
fn resonant(x: &[f64], hz: f64, q: f64) -> Vec<f64> {
    let k = (PI * hz / RATE_HZ).tan();
    let norm = 1.0 / (1.0 + k / q + k * k);
    let (gain, a1, a2) = (k * k * norm, 2.0 * (k * k - 1.0) * norm, (1.0 - k / q + k * k) * norm);
    let (mut x1, mut x2, mut y1, mut y2) = (0.0, 0.0, 0.0, 0.0);
    let mut next = |x: f64| {
        let y = gain * (x + 2.0 * x1 + x2) - a1 * y1 - a2 * y2;
        (x2, x1, y2, y1) = (x1, x, y1, y);
        y
    };
    x.iter().map(|x| next(*x)).collect()
}

/// A low-pass of the first order with a time constant in samples.
pub(super) fn slow_pass(x: &[f64], samples: f64) -> Vec<f64> {
    let keep = (-1.0 / samples).exp();
    x.iter()
        .scan(0.0, |y, x| {
            *y = keep * *y + (1.0 - keep) * x;
            Some(*y)
        })
        .collect()
}

fn is_inside(fit: &Fit) -> bool {
    fit.n.lo <= N && N <= fit.n.hi
}

#[test]
fn white_noise_behind_a_filter_is_not_rejected() {
    let (mut inside, mut all) = (0, 0);
    for seed in 600..602 {
        let x = white(300_000, seed);
        let filtered = [
            moving_average(&x, &[1.0; 2]),
            moving_average(&x, &[1.0; 8]),
            low_pass(&x, 2.5),
            low_pass(&x, 10.0),
            low_pass(&x, 25.0),
        ];
        for (filter, x) in filtered.iter().enumerate() {
            let fit = of(x);
            let told = (filter, seed, fit.n, fit.max_freq_hz, fit.model_error, codes(&fit));
            assert!(!fit.is_rejected && near(fit.n.value, N, 0.03) && fit.lines().next().is_none(), "{told:?}");
            assert!(!codes(&fit).contains(&"off-curve"), "{told:?}");
            (inside, all) = (inside + usize::from(is_inside(&fit)), all + 1);
        }
    }
    assert!(inside * 10 >= all * 9, "{inside} of {all}");
}

/// The noise is correlated over three samples. A quarter of the samples is lost, one by one or in bursts.
#[test]
fn gaps_of_any_length_leave_n_alone() {
    let mut inside = 0;
    for (case, burst) in [0, 5, 50, 500, 3000, 0, 5, 50, 500, 3000].into_iter().enumerate() {
        let mut x = moving_average(&white(270_003, 700 + case as u64), &[1.0, 1.6, 0.7, 0.1]);
        lose_a_quarter(&mut x, burst, case as u64);
        let fit = of(&x);
        let told = (burst, case, fit.n, fit.max_freq_hz, codes(&fit));
        assert!(!fit.is_rejected && near(fit.n.value, N, 0.02) && fit.lines().next().is_none(), "{told:?}");
        assert!(["off-curve", "step", "many-steps"].iter().all(|code| !codes(&fit).contains(code)), "{told:?}");
        inside += usize::from(is_inside(&fit));
    }
    assert!(inside >= 9, "{inside} of 10");
}

/// Loses a quarter of the samples in bursts of up to twice the length `burst`, or one by one if `burst` is 0.
fn lose_a_quarter(x: &mut [f64], burst: usize, seed: u64) {
    let mut draw = uniform(seed);
    let mut lost = 0;
    while lost < x.len() / 4 {
        let first = (draw() * x.len() as f64) as usize;
        let end = (first + 1 + (draw() * 2.0 * burst as f64) as usize).min(x.len());
        lost += x[first..end].iter().filter(|value| !value.is_nan()).count();
        x[first..end].fill(f64::NAN);
    }
}

/// The record is longer than one transform. In each octave the mean power is the density times the response, so the
/// random walk does not leak into the segments.
#[test]
fn a_long_record_has_the_same_spectrum() {
    let truth = Truth { n: 0.01, k: 2e-3, ..Truth::default() };
    let rate = truth.noise(1_200_000, 800);
    let spectrum = Spectrum::of(&rate, RATE_HZ).unwrap();
    assert!(spectrum.has_levels);
    let hz = RATE_HZ / (2 * spectrum.samples) as f64;
    for octave in 4..19 {
        let inside = |bin: &&bins::Bin| bin.first >= 1 << octave && bin.first < 2 << octave;
        let (mut ratios, mut freedom) = (0.0, 0.0);
        for bin in spectrum.bins.iter().filter(inside) {
            let expected = bin.response.offset + bin.response.gain * truth.density(bin.middle() * hz);
            ratios += bin.freedom * bin.power / expected;
            freedom += bin.freedom;
        }
        let ratio = ratios / freedom;
        assert!((ratio - 1.0).abs() < 4.0 * (2.0 / freedom).sqrt() + 2e-3, "octave {octave}: {ratio} of {freedom}");
    }
    let (long, part) = (of(&rate), of(&rate[..1_000_000]));
    assert!(near(long.n.value, part.n.value, 2e-3) && near(long.n.value, 0.01, 4e-3), "{:?} {:?}", long.n, part.n);
    assert!(near(long.k.value, part.k.value, 0.05) && near(long.k.value, 2e-3, 0.1), "{:?} {:?}", long.k, part.k);
}

#[test]
fn the_upper_end_can_be_given() {
    let x = low_pass(&white(200_000, 840), 10.0);
    let upto = |max_freq_hz| fit(&Input::Rate(&x), RATE_HZ, &FitOptions { max_freq_hz, ..FitOptions::default() });
    let low = upto(Some(2.0)).unwrap();
    assert!(low.max_freq_hz == 2.0 && is_inside(&low), "{:?}", low.n);
    let above = upto(Some(1e3)).unwrap();
    assert_eq!(above.max_freq_hz, RATE_HZ / 2.0);
    let refused = upto(Some(0.01)).unwrap_err();
    assert_eq!(refused, FitError::MaxFreq { max_freq_hz: 0.01, least_hz: 256.0 / 4000.0 });
    assert!(refused.to_string().contains("give 6.40e-2 Hz or more"), "{refused}");
}

#[test]
fn a_shape_of_too_few_cosines_gives_no_gauss_markov_term() {
    for seed in 56..59 {
        let fit = of(&moving_average(&HOUR.noise(360_000, seed), &[1.0; 8]));
        let has_memory = fit.terms.iter().any(|term| matches!(term, Term::GaussMarkov { .. }));
        assert!(!has_memory && fit.b.lo <= HOUR.b && HOUR.b <= fit.b.hi, "{seed}: up to {} Hz", fit.max_freq_hz);
    }
}

#[test]
fn a_slow_low_pass_is_not_taken_for_a_gauss_markov_term() {
    for seed in 1..3 {
        let fit = of(&slow_pass(&white(360_000, seed), 50.0));
        let has_memory = fit.terms.iter().any(|term| matches!(term, Term::GaussMarkov { .. }));
        let told = (seed, fit.n, fit.max_freq_hz, codes(&fit));
        assert!(!has_memory && !fit.is_rejected && near(fit.n.value, N, 0.06) && fit.n.hi < 1.1 * N, "{told:?}");
    }
}

#[test]
fn a_term_that_may_be_a_low_pass_is_reported() {
    let mut told = 0;
    for seed in 1..3 {
        let fit = of(&slow_pass(&white(360_000, seed), 1000.0));
        let is_right = near(fit.n.value, N, 0.2) && is_inside(&fit);
        let is_said = other(&fit).is_some_and(|(tau_s, n)| near(tau_s, 10.0, 0.2) && near(n, N, 0.1));
        assert!(is_right || is_said, "{seed}: {:?} {:?} {:?}", fit.n, other(&fit), codes(&fit));
        told += usize::from(is_said);
    }
    assert!(told > 0);
}

/// A low-pass of the sensor shapes all of its noise. A model that shaped only the white noise gave a B 50 to 100 % too
/// small behind a low-pass of 0.1 s, without a warning.
#[test]
fn a_low_pass_of_all_noise_leaves_the_coefficients() {
    let is_in = |coefficient: Coefficient, truth: f64| coefficient.lo <= truth && truth <= coefficient.hi;
    for samples in [3.0, 50.0, 500.0] {
        let mut inside = [0; 3];
        for seed in 3000..3006 {
            let fit = of(&slow_pass(&HOUR.noise(360_000, seed), samples)[6000..]);
            let is_quiet = ["off-curve", "step", "model-rejected"].iter().all(|code| !codes(&fit).contains(code));
            assert!(is_quiet, "{samples} {seed}: {:?} {:?}", codes(&fit), fit.misfit);
            let all = [(fit.n, HOUR.n), (fit.b, HOUR.b), (fit.k, HOUR.k)];
            all.iter().zip(&mut inside).for_each(|((c, truth), inside)| *inside += usize::from(is_in(*c, *truth)));
        }
        assert!(inside.iter().all(|&inside| inside >= 4), "{samples}: {inside:?} of 6");
    }
}

/// With cosines alone, without a corner, N was 14 % off, and 15 of 16 intervals excluded the true N.
#[test]
fn a_slow_low_pass_of_the_second_order_leaves_n() {
    let mut inside = 0;
    for seed in 3100..3106 {
        let fit = of(&low_pass(&HOUR.noise(360_000, seed), 0.3)[6000..]);
        let corner = fit.terms.iter().find_map(|term| match term {
            Term::BandShape { corner, .. } => *corner,
            _ => None,
        });
        let told = (seed, fit.n, corner, fit.max_freq_hz);
        assert!(near(fit.n.value, HOUR.n, 0.12) && fit.max_freq_hz > 3.0, "{told:?}");
        assert!(corner.is_some_and(|corner| near(corner.frequency_hz, 0.3, 0.05) && corner.damping.abs() < 0.2));
        assert!(near(fit.density(0.3, RATE_HZ), HOUR.density(0.3) / 2.0, 0.1), "{told:?}");
        inside += usize::from(fit.n.lo <= HOUR.n && HOUR.n <= fit.n.hi);
    }
    assert!(inside >= 4, "{inside} of 6");
}

/// Adjacent samples behind a filter, or of correlated noise, differ little. Even so, the advice for the bias must not
/// be an average of one sample.
#[test]
fn a_filter_does_not_shorten_the_average_for_the_bias() {
    let averaging_s = |rate: &[f64]| match advice(&of(rate)).unwrap().averaging {
        Averaging::Minimum { tau_s, .. } | Averaging::Flat { tau_s, .. } | Averaging::Falling { tau_s, .. } => tau_s,
    };
    for hz in [0.3, 2.5] {
        let rate = HOUR.noise(360_000, 3300);
        let [bare_s, filtered_s] = [averaging_s(&rate), averaging_s(&low_pass(&rate, hz)[6000..])];
        assert!(bare_s > 10.0 && filtered_s > bare_s / 3.0, "{hz} Hz: {filtered_s} s instead of {bare_s} s");
    }
    for n in [1e-6, 1e-4, 1e-3] {
        let memory = Truth { n, sigma: 0.01, tau_s: 10.0, ..Truth::default() };
        let memory_s = averaging_s(&memory.noise(360_000, 3300));
        assert!(memory_s > 100.0, "a memory of 10 s beside N = {n}: {memory_s} s");
    }
}

/// The time constant, s, and N in the other explanation of the spectrum.
fn other(fit: &Fit) -> Option<(f64, f64)> {
    fit.warnings.iter().find_map(|warning| match warning {
        AllanWarning::MemoryOrFilter { tau_s, n } => Some((*tau_s, *n)),
        _ => None,
    })
}

/// White noise behind a low-pass, and slow noise added after it. A filter of all noise does not explain the records.
#[test]
fn slow_noise_that_joins_behind_a_low_pass_leaves_n() {
    let slow = Truth { n: 0.0, ..HOUR };
    let filtered = |filter: usize, x: &[f64]| match filter {
        0 => slow_pass(x, 10.0),
        1 => low_pass(x, 1.6),
        2 => low_pass(x, 0.3),
        3 => slow_pass(x, 50.0),
        _ => slow_pass(x, 500.0),
    };
    for filter in 0..5 {
        let is_memory = filter > 2;
        let mut inside = 0;
        for seed in 3200..3204 {
            let white: Vec<f64> = white(366_000, seed).iter().map(|x| x * HOUR.n / N).collect();
            let noise = slow.noise(360_000, seed + 100);
            let fast = filtered(filter, &white);
            let sum = fast[6000..].iter().zip(&noise).map(|(fast, slow)| fast + slow);
            let fit = of(&sum.collect::<Vec<f64>>());
            let told = (filter, seed, fit.n, codes(&fit));
            assert_eq!((fit.n.identified, other(&fit).is_some()), (!is_memory, is_memory), "{told:?}");
            assert!(fit.terms.iter().any(|term| matches!(term, Term::BandShape { of_white: true, .. })), "{told:?}");
            inside += usize::from(fit.n.lo <= HOUR.n && HOUR.n <= fit.n.hi);
        }
        assert!(inside >= 3, "{filter}: {inside} of 4");
    }
}

/// White noise is below a tenth of the density everywhere. N once was 0.3 to 2 % of the truth, and identified in one
/// of four records.
#[test]
fn white_noise_that_is_nowhere_seen_is_not_identified() {
    let slow = Truth { n: 0.0, ..HOUR };
    for seed in 3210..3214 {
        let white: Vec<f64> = white(420_000, seed).iter().map(|x| x * HOUR.n / N).collect();
        let noise = slow.noise(360_000, seed + 100);
        let fast = low_pass(&white, 0.03);
        let sum = fast[60_000..].iter().zip(&noise).map(|(fast, slow)| fast + slow);
        let fit = of(&sum.collect::<Vec<f64>>());
        let is_inside = fit.n.lo <= HOUR.n && HOUR.n <= fit.n.hi;
        assert!(is_inside || !fit.n.identified, "{seed}: {:?} {:?}", fit.n, codes(&fit));
    }
}

/// Noise correlated over five samples looks like filtered white noise. That explanation alone gave twice the true N,
/// with a narrow interval.
#[test]
fn noise_correlated_over_few_samples_gives_both_n() {
    let tau_s = 5.0 / RATE_HZ;
    let truth = Truth { n: 0.05, sigma: 0.3, tau_s, b: 0.005, k: 1e-3, q: 0.0 };
    let plateau = (truth.n.powi(2) + 2.0 * truth.sigma.powi(2) * tau_s).sqrt();
    for seed in 3220..3224 {
        let fit = of(&truth.noise(86_400, seed));
        let told = (seed, fit.n, other(&fit), codes(&fit));
        assert!(near(fit.n.value, truth.n, 0.02) && !fit.n.identified, "{told:?}");
        assert!(other(&fit).is_some_and(|(_, n)| near(n, plateau, 0.1)), "{told:?}");
    }
}

/// Above the upper end of the model, the measured density may be lower than that of flicker which the fit finds by
/// chance. The model must hold all the same.
#[test]
fn a_steep_filter_above_slow_noise_is_not_rejected() {
    let slow = Truth { k: 1e-3, ..Truth::default() };
    for seed in 1..3 {
        let fast = slow_pass(&slow_pass(&white(360_000, seed), 20.0), 20.0);
        let sum: Vec<f64> = fast.iter().zip(slow.noise(360_000, seed + 100)).map(|(fast, slow)| fast + slow).collect();
        let fit = of(&sum);
        assert!(!fit.is_rejected && !codes(&fit).contains(&"off-curve"), "{seed}: {:?}", fit.misfit);
    }
}

/// The resonance is masked as a line. No bin constrains a shape that ends inside the mask, and one of four records was
/// rejected for this reason.
#[test]
fn a_resonant_low_pass_is_not_rejected() {
    for (q, seed) in [2.0, 5.0].into_iter().flat_map(|q| (860..863).map(move |seed| (q, seed))) {
        let fit = of(&resonant(&white(360_000, seed), 10.0, q));
        let told = (q, seed, fit.n, fit.max_freq_hz, codes(&fit));
        assert!(!fit.is_rejected && near(fit.n.value, N, 0.03) && !codes(&fit).contains(&"off-curve"), "{told:?}");
    }
}
