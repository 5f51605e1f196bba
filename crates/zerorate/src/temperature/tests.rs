use super::filter::Filter;
use super::*;
use crate::part::TypicalNoise;
use adis16130_twin::{Means, Spec, Truth};
use alloc::vec;

const AXIS: Axis = Axis::ADIS16130;

fn assumed(steps_s: &[f64], t3_c: f64) -> Assumed<'_> {
    Assumed {
        axis: &AXIS,
        white_dps_per_rt_hz: 0.0125,
        gauss_markov: &[],
        steps_s,
        motions_hz: &[],
        max_order: 3,
        t3_c,
    }
}

/// The first 3170 s of a twin in blocks of 2 s, and the truth at their end.
fn hour(spec: &Spec) -> (Vec<Block>, Truth) {
    beginning(spec, 1585)
}

fn beginning(spec: &Spec, count: usize) -> (Vec<Block>, Truth) {
    let mut means = Means::new(spec, 20);
    let mut block = || {
        let mean = means.next_mean();
        Block { start_s: mean.start_s, length_s: mean.length_s, rate_dps: mean.rate_dps, temp_c: mean.temp_c }
    };
    let blocks = (0..count).map(|_| block()).collect();
    (blocks, means.truth())
}

fn curve_of(spec: &Spec, steps_s: &[f64]) -> (BiasCurve, Truth) {
    let (blocks, truth) = hour(spec);
    let t3_c = blocks.last().unwrap().temp_c;
    (fit(&blocks, &assumed(steps_s, t3_c)).unwrap(), truth)
}

/// Errors of a curve in its own standard uncertainties, at nine temperatures of its span.
fn errors(curve: &BiasCurve, truth: &Truth) -> [f64; 9] {
    let (low_c, high_c) = curve.span_c;
    core::array::from_fn(|k| {
        let temp_c = low_c + (high_c - low_c) * k as f64 / 8.0;
        (curve.correction.at(temp_c) + truth.bias_dps(temp_c)) / curve.u_dps(temp_c)
    })
}

/// The covariance of three blocks is written down from the definitions: a walk that begins with the first block, one
/// Gauss–Markov process, and white noise. Products of whitened series equal products with the inverse of this matrix.
#[test]
fn the_filter_is_the_inverse_of_the_covariance() {
    let noise = Noise {
        white_dps_per_rt_hz: 0.02,
        bias_instability_dps: 0.0,
        rate_random_walk_dps_per_rt_s: 0.003,
        gauss_markov: vec![(0.01, 1e7)],
    };
    let block = |start_s| Block { start_s, length_s: 2.0, rate_dps: 0.0, temp_c: 25.0 };
    let blocks = [block(0.0), block(2.0), block(10.0)];
    // a walk from the middle of the first block, a nearly constant process, white noise of means over 2 s
    let (walk, constant, white) = (0.003 * 0.003, 0.01 * 0.01, 0.02 * 0.02 / 4.0);
    let middles: [f64; 3] = [0.0, 2.0, 10.0];
    let covariance =
        |i: usize, j: usize| constant + walk * middles[i].min(middles[j]) + if i == j { white } else { 0.0 };
    let rows = (0..3).map(|i| (0..=i).map(|j| covariance(i, j)).collect()).collect();
    let dense = crate::temperature::gls::whitener(rows).unwrap();
    let series = [vec![0.3, -0.1, 0.5], vec![1.0, 1.0, 1.0], vec![0.0, 0.2, 0.9]];
    let filter = Filter::new(&noise, &blocks);
    let filtered = filter.filtered(&filter.whites(&series[..2]), &filter.whiten(&series[2..])).unwrap();
    for (i, a) in series.iter().enumerate() {
        for (j, b) in series[..=i].iter().enumerate() {
            let solved = dense.solve(b.iter().copied());
            let product: f64 = a.iter().zip(&solved).map(|(a, b)| a * b).sum();
            assert!((filtered.gram[i][j] / product - 1.0).abs() < 1e-5, "{i} {j}: {} {product}", filtered.gram[i][j]);
        }
    }
    assert!((filtered.log_determinant - dense.ln_determinant()).abs() < 1e-5);
}

/// With next to no noise, the curve agrees with that of the unit to 2·10⁻⁴ °/s.
#[test]
fn a_quiet_unit_is_found_exactly() {
    let quiet = Spec { noise: false, hysteresis_dps: 0.0, ..Spec::from_seed(5) };
    let (blocks, truth) = hour(&quiet);
    let typical = AXIS.noise.map(|noise| TypicalNoise {
        white_dps_per_rt_hz: noise.white_dps_per_rt_hz / 100.0,
        flicker_floor_dps: noise.flicker_floor_dps / 100.0,
        rate_random_walk_dps_per_rt_s: noise.rate_random_walk_dps_per_rt_s / 100.0,
    });
    let axis = Axis { noise: typical, ..AXIS };
    let t3_c = blocks[blocks.len() - 1].temp_c;
    let assumed = Assumed { axis: &axis, white_dps_per_rt_hz: 0.000_125, ..assumed(&[], t3_c) };
    let curve = fit(&blocks, &assumed).unwrap();
    for temp_c in [26.0, 29.0, 32.0] {
        let error_dps = curve.correction.at(temp_c) + truth.bias_dps(temp_c);
        assert!(error_dps.abs() < 2e-4, "{error_dps}");
    }
}

/// All properties of the units are drawn at random. The mean square of the errors, in units of u, is near 1, as for a
/// normal distribution.
#[test]
fn intervals_are_honest() {
    let squares = (200..216).map(|seed| {
        let (curve, truth) = curve_of(&Spec::from_seed(seed), &[]);
        errors(&curve, &truth).iter().map(|error| error * error).sum::<f64>() / 9.0
    });
    let mean = squares.sum::<f64>() / 16.0;
    assert!((0.4..1.7).contains(&mean), "{mean}");
}

/// In these simulated units, quadratic and cubic models explain the bend about equally well and share its probability,
/// so the line is more probable than each of them. If the line were the estimate, with the interval of the line, BTC
/// would be off by 4.7, 3.3 and 3.6 u.
#[test]
fn a_bend_that_orders_share_is_in_the_interval_of_btc() {
    for (seed, curvature_dps_per_c2, most) in [(226, -0.001, 4.0), (22, 0.0005, 3.0), (246, 0.0005, 3.0)] {
        let (curve, truth) = curve_of(&Spec { curvature_dps_per_c2, ..Spec::from_seed(seed) }, &[]);
        let error = curve.correction.btc_dps_per_c - truth.btc_dps_per_c(curve.correction.t3_c);
        let u = curve.u_btc_dps_per_c();
        assert!((error / u).abs() < most, "{seed}: {error:.5} {u:.5} {:?}", curve.order_weights);
        assert!(u < 0.003, "{seed}: an interval that says something: {u}");
    }
}

/// A lag of 30 s is told from a curve: the self-heating has two time constants, so no polynomial imitates the lag.
#[test]
fn a_lag_is_found() {
    let (curve, truth) = curve_of(&Spec { lag_s: 30.0, ..Spec::from_seed(3) }, &[]);
    assert!((curve.following.lag_s - 30.0).abs() < 6.0, "{:?}", curve.following);
    assert!(errors(&curve, &truth).iter().all(|error| error.abs() < 3.0), "{:?}", errors(&curve, &truth));
}

/// Five minutes after power-on, the bias still lags by more than the interval. The curve states the bias at a steady
/// temperature.
#[test]
fn a_lag_is_not_taken_for_a_bias() {
    for seed in 3..6 {
        let (blocks, truth) = beginning(&Spec { lag_s: 30.0, ..Spec::from_seed(seed) }, 150);
        let curve = fit(&blocks, &assumed(&[], blocks[149].temp_c)).unwrap();
        assert!(errors(&curve, &truth).iter().all(|error| error.abs() < 2.5), "{seed}: {:?}", errors(&curve, &truth));
    }
}

/// A supply step of 200 mV after half an hour is found with its size (F-01). The curve holds for the level after it.
#[test]
fn a_step_is_taken_out() {
    let stepped = Spec { supply_step_mv: 200.0, fault_at_s: Some(1800.0), ..Spec::from_seed(8) };
    let (curve, truth) = curve_of(&stepped, &[1800.0]);
    let [Some(step), None, ..] = curve.steps else { panic!("{:?}", curve.steps) };
    assert!((step.size_dps - 0.04).abs() < 3.0 * step.u_dps + 0.002, "{step:?}");
    assert!(errors(&curve, &truth).iter().all(|error| error.abs() < 3.0), "{:?}", errors(&curve, &truth));
}

#[test]
fn a_suspected_step_that_is_not_there_is_left_out() {
    assert_eq!(curve_of(&Spec::from_seed(8), &[1800.0]).0.steps, [None; MOST_STEPS]);
}

#[test]
fn a_series_without_numbers_or_too_short_is_an_error() {
    let block = |k: u32| Block { start_s: f64::from(k), length_s: 1.0, rate_dps: f64::NAN, temp_c: 25.0 };
    let blocks: Vec<Block> = (0..100).map(block).collect();
    assert_eq!(fit(&blocks, &assumed(&[], 25.0)), Err(ThermalError::Degenerate));
    assert_eq!(fit(&blocks[..3], &assumed(&[], 25.0)), Err(ThermalError::TooFew { blocks: 3, needed: 40 }));
}
