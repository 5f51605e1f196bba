//! Tests temperatures, the bias over temperature, and the truth about both.

use crate::bus::{Host, celsius, dps, mean, quiet};
use adis16130_twin::{Profile, Spec, Truth, Twin};

const SECOND: u64 = 1_000_000_000;

fn at(twin: &Twin, seconds: u64) -> Truth {
    twin.advance_ns(seconds * SECOND - twin.now_ns());
    twin.truth()
}

#[test]
fn self_heating_is_40_percent_fast_60_percent_slow() {
    let twin = Twin::new(Spec { noise: false, ..Spec::typical() });
    let curve = |t: f64| 25.0 + 8.0 * (0.4 * (1.0 - (-t / 90.0).exp()) + 0.6 * (1.0 - (-t / 600.0).exp()));
    for t in [0, 10, 90, 600, 3000] {
        assert!((at(&twin, t).sensor_c - curve(t as f64)).abs() < 1e-3, "{t} s");
    }
}

#[test]
fn cooling_follows_the_same_time_constants() {
    let twin = Twin::new(Spec { noise: false, ..Spec::typical() });
    let hot = at(&twin, 10_000).sensor_c - 25.0;
    assert!((hot - 8.0).abs() < 1e-3);
    twin.power_off();
    let rest = 8.0 * (0.4 * (-600.0f64 / 90.0).exp() + 0.6 * (-1.0f64).exp());
    assert!((at(&twin, 10_600).sensor_c - 25.0 - rest).abs() < 1e-3);
    twin.power_on();
    assert!((at(&twin, 20_600).sensor_c - 33.0).abs() < 1e-3);
}

#[test]
fn warmup_s_scales_both_shares() {
    let twin = Twin::new(Spec { noise: false, warmup_s: 60.0, ..Spec::typical() });
    let expected = 25.0 + 8.0 * (0.4 * (1.0 - (-1.0f64).exp()) + 0.6 * (1.0 - (-0.15f64).exp()));
    assert!((at(&twin, 9).sensor_c - expected).abs() < 2e-3);
}

#[test]
fn each_profile_sets_the_ambient_temperature() {
    let cold = Spec { noise: false, warmup_c: 0.0, ambient_c: 10.0, ..Spec::typical() };
    let ramp = Twin::new(Spec { profile: Profile::Ramp, ..cold.clone() });
    assert!((at(&ramp, 600).sensor_c - 20.0).abs() < 1e-6);
    assert!((at(&ramp, 6000).sensor_c - 85.0).abs() < 1e-6);
    let oven = Twin::new(Spec { profile: Profile::Oven, ..cold.clone() });
    for (minute, c) in [(5, 25.0), (6, 23.0), (60, -40.0), (70, -35.0), (144, 85.0), (160, 55.0), (200, 25.0)] {
        assert!((at(&oven, minute * 60).sensor_c - c).abs() < 1e-6, "{minute} min");
    }
    let constant = Twin::new(cold);
    assert_eq!(at(&constant, 1000).sensor_c, 10.0);
}

#[test]
fn element_lags_sensor() {
    let spec = Spec { noise: false, warmup_c: 0.0, profile: Profile::Ramp, lag_s: 30.0, ..Spec::typical() };
    let truth = at(&Twin::new(spec), 600);
    assert!((truth.sensor_c - truth.element_c - 0.5).abs() < 1e-3, "30 s at 1 °C/min");
}

#[test]
fn bias_is_linear_plus_curvature_and_the_truth_says_so() {
    let spec = Spec {
        bias_dps: 0.5,
        tempco_dps_per_c: 0.04,
        curvature_dps_per_c2: 0.001,
        sensitivity_error: 0.03,
        ambient_c: 45.0,
        warmup_c: 0.0,
        supply_mv: 5100.0,
        ..quiet()
    };
    let mut host = Host::started(spec);
    let bias = 1.03 * (0.5 + 0.02 + 0.04 * 20.0 + 0.001 * 400.0);
    assert!((dps(host.pair().1) - bias).abs() < 1e-4);
    let truth = host.twin.truth();
    assert!((truth.pbc_dps(45.0) + bias).abs() < 1e-12);
    assert!((truth.btc_dps_per_c(45.0) + 1.03 * (0.04 + 2.0 * 0.001 * 20.0)).abs() < 1e-12);
    assert!((truth.pbc_dps(44.0) + truth.bias_dps(44.0)).abs() < 1e-12);
    assert!((truth.bias_dps(25.0) - 1.03 * 0.52).abs() < 1e-12);
}

#[test]
fn rotation_is_not_part_of_the_true_bias() {
    let host = Host::started(Spec { rotation_dps: 3.0, bias_dps: 0.1, ..quiet() });
    assert!((host.twin.truth().pbc_dps(25.0) + 0.1).abs() < 1e-12);
}

#[test]
fn hysteresis_shifts_the_bias_by_twice_its_half_width() {
    for (tempco_dps_per_c, half_width) in [(0.04, 0.002), (-0.02, -0.002)] {
        let twin = Twin::new(Spec { noise: false, tempco_dps_per_c, ..Spec::typical() });
        let warm = at(&twin, 3000);
        assert!((warm.branch_dps + half_width).abs() < 1e-9, "warming: the bias is behind");
        twin.power_off();
        let cool = at(&twin, 6000);
        assert!((cool.branch_dps - half_width).abs() < 1e-9, "cooling: the bias is behind");
        assert!((cool.bias_dps(28.0) - warm.bias_dps(28.0) - 2.0 * half_width).abs() < 1e-9);
    }
}

#[test]
fn the_mean_of_many_codes_is_the_truth() {
    let spec = Spec { flicker_floor_dps: 0.0, warmup_c: 0.0, ambient_wander_c: 0.0, ..Spec::from_seed(11) };
    let mut host = Host::started(spec);
    let rates = host.rates(60_000);
    let truth = host.twin.truth();
    let sd = 0.0125 / (2.0 * rates.len() as f64 / 5692.6f64).sqrt();
    assert!((mean(&rates) + truth.pbc_dps(25.0)).abs() < 4.0 * sd + 1e-3);
}

#[test]
fn slow_processes_do_not_notice_the_bus() {
    let spec = Spec::from_seed(3);
    let idle = Twin::new(spec.clone());
    let mut busy = Host::started(spec);
    busy.rates(20_000);
    idle.advance_ns(busy.twin.now_ns());
    assert_eq!(idle.truth(), busy.twin.truth());
}

#[test]
fn noise_off_leaves_bias_and_quantisation() {
    let spec = Spec { noise: false, warmup_c: 0.0, ..Spec::from_seed(4) };
    let expected = (1.0 + spec.sensitivity_error) * spec.bias_dps;
    let mut host = Host::started(spec);
    let (_, rate, temp) = host.pair();
    assert!((dps(rate) - expected).abs() < 1.0 / 23_488.0);
    assert_eq!(celsius(temp), 25.0);
    assert_eq!((host.pair().1, host.pair().2), (rate, temp));
}
