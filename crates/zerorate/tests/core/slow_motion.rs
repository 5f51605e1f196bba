//! The stated uncertainty covers slow motion of the platform or a step of the supply, or the recording is refused.

use crate::hours::measure;
use adis16130_twin::{Motion, Spec, Truth};
use std::collections::BTreeMap;
use zerorate::{Finding, Method, Outcome, Warning};

/// Error in standard uncertainties above which a result counts as wrong. 1 of 16 000 correct results exceeds it.
const WRONG_U: f64 = 4.0;

/// Largest error of PBC, BTC and the correction over the temperatures seen, in standard uncertainties.
fn worst_u(outcome: &Outcome, truth: &Truth) -> f64 {
    let (correction, u) = (&outcome.correction, &outcome.uncertainty);
    let pbc = (correction.pbc_dps - truth.pbc_dps(correction.t3_c)) / u.u_pbc_dps;
    let btc = (correction.btc_dps_per_c - truth.btc_dps_per_c(correction.t3_c)) / u.u_btc_dps_per_c;
    let at = |temp_c: f64| {
        let error_dps = correction.at(temp_c) + truth.bias_dps(temp_c);
        outcome.curve.map_or(0.0, |curve| error_dps / curve.u_dps(temp_c))
    };
    let span = outcome.curve.map_or((0.0, 0.0), |curve| curve.span_c);
    let over = (0..9).map(|k| at(span.0 + (span.1 - span.0) * f64::from(k) / 8.0));
    over.chain([pbc, btc]).map(f64::abs).fold(0.0, f64::max)
}

fn sway(seed: u64, sway_dps: f64, sway_hz: f64) -> Spec {
    Spec { motion: Motion::Sway, sway_dps, sway_hz, ..Spec::from_seed(seed) }
}

fn step(seed: u64, supply_step_mv: f64, at_s: f64) -> Spec {
    Spec { supply_step_mv, fault_at_s: Some(at_s), ..Spec::from_seed(seed) }
}

/// A sway by seed, amplitude, °/s, and frequency, Hz. A warm-up lasts a third of the period of the sway, in which the
/// rate rises as the temperature does. A warm-up cannot tell this sway from a change of the bias, but a cycle can.
const LIKE_A_WARMUP: (u64, f64, f64) = (4, 0.036, 0.000_103);

#[test]
fn a_slow_sway_is_inside_the_uncertainty_or_refused() {
    let sways = [
        (853, 0.0885, 0.000_245),
        (1, 0.1087, 0.000_144),
        (1042, 0.0255, 0.000_122),
        LIKE_A_WARMUP,
        (4, 0.06, 0.000_2),
        (7, 0.0567, 0.000_262),
    ];
    for (seed, dps, hz) in sways {
        for method in [Method::Warmup, Method::Cycle] {
            if (seed, dps, hz) == LIKE_A_WARMUP && method == Method::Warmup {
                continue;
            }
            let Ok((outcome, truth)) = measure(&sway(seed, dps, hz), method) else { continue };
            let worst = worst_u(&outcome, &truth);
            assert!(worst < WRONG_U, "{seed} {method:?}: {worst} u, {:?}", outcome.warnings);
        }
    }
}

/// For these units at rest, the standard uncertainty of PBC is 0.0018 to 0.0037 °/s. If models with a base motion were
/// always separate peaks, it would be 0.0075 to 0.0123 °/s for the first four units.
#[test]
fn a_platform_at_rest_has_one_uncertainty() {
    let (mut mean_square, seeds) = (0.0, [91040, 91044, 91076, 91100, 91041, 91043]);
    for seed in seeds {
        let (outcome, truth) = measure(&Spec::from_seed(seed), Method::Warmup).unwrap();
        let (u_dps, sources) = (outcome.uncertainty.u_pbc_dps, outcome.curve.unwrap().sources);
        assert!((0.0018..0.0037).contains(&u_dps), "{seed}: {u_dps}");
        assert!(sources.base_motion_probability < 0.05, "{seed}: {sources:?}");
        let error_dps = outcome.correction.pbc_dps - truth.pbc_dps(outcome.correction.t3_c);
        mean_square += (error_dps / u_dps).powi(2) / seeds.len() as f64;
    }
    assert!((0.3..2.0).contains(&mean_square), "{mean_square}");
}

/// Steps of 384 mV in the last third of the hour and of −352 mV while the part warms are smaller than the largest step
/// of a supply. So they are not taken for motion.
#[test]
fn a_supply_step_is_not_motion() {
    for (seed, mv, at_s) in [(6, 384.0, 2492.0), (10, -352.0, 225.0)] {
        let (outcome, truth) =
            measure(&step(seed, mv, at_s), Method::Warmup).unwrap_or_else(|refusal| panic!("{refusal}"));
        assert!(outcome.warnings.iter().any(|warning| warning.code() == "step"), "{seed}: {:?}", outcome.warnings);
        assert!(worst_u(&outcome, &truth) < WRONG_U, "{seed}: {}", worst_u(&outcome, &truth));
    }
}

/// A wide hysteresis that lies between two values of the search is not taken for a lag, and the true bias stays inside
/// the interval.
#[test]
fn a_wide_play_is_not_a_lag() {
    for (seed, hysteresis_dps) in [(1, 0.109), (6, 0.122), (7, 0.057), (10, 0.096)] {
        let (outcome, truth) = measure(&Spec { hysteresis_dps, ..Spec::from_seed(seed) }, Method::Warmup).unwrap();
        let codes: Vec<&str> = outcome.warnings.iter().map(Warning::code).collect();
        assert!(!codes.contains(&"lagging") && !codes.contains(&"swaying"), "{seed}: {codes:?}");
        assert!(worst_u(&outcome, &truth) < WRONG_U, "{seed}: {} u", worst_u(&outcome, &truth));
    }
}

/// The code of a warning, the method that gives it, and the spec of a unit with its cause for a seed.
type Claim = (&'static str, Method, fn(u64) -> Spec);

/// Checks each text that says that the uncertainty includes an effect, on units with this effect. The truth is inside
/// the interval, and the stated error adds to the uncertainty of the same unit without the effect.
#[test]
fn a_stated_uncertainty_holds_the_named_effect() {
    let claims: [Claim; 5] = [
        ("swaying", Method::Warmup, |seed| sway(seed, 0.05, 0.000_35)),
        ("swaying", Method::An1042, |seed| sway(seed, 0.05, 0.0008)),
        ("step", Method::Warmup, |seed| step(seed, 200.0, 900.0)),
        ("step", Method::An1042, |seed| step(seed, 200.0, 3100.0)),
        ("lagging", Method::An1042, |seed| Spec { lag_s: 60.0, ..Spec::from_seed(seed) }),
    ];
    // the uncertainty of the same units without the effect
    let mut still = BTreeMap::new();
    for (code, method, spec) in claims {
        let mut told = 0;
        for seed in 21..25 {
            let Ok((outcome, truth)) = measure(&spec(seed), method) else { continue };
            assert!(worst_u(&outcome, &truth) < WRONG_U, "{code} {method:?} {seed}: {}", worst_u(&outcome, &truth));
            told += u32::from(outcome.warnings.iter().any(|warning| warning.code() == code));
            for warning in outcome.warnings.iter().filter(|warning| warning.code() == code) {
                // an effect that was removed has no error
                let Warning::Found(Finding { pbc_dps, btc_dps_per_c, .. }) = *warning else { continue };
                let undisturbed = || measure(&Spec::from_seed(seed), method).unwrap().0.uncertainty;
                let before = *still.entry((method.name(), seed)).or_insert_with(undisturbed);
                let u = outcome.uncertainty;
                assert!(u.u_pbc_dps > 0.98 * before.u_pbc_dps.hypot(pbc_dps), "{code} {method:?} {seed}");
                assert!(
                    u.u_btc_dps_per_c > 0.98 * before.u_btc_dps_per_c.hypot(btc_dps_per_c),
                    "{code} {method:?} {seed}"
                );
            }
        }
        assert!(told > 0, "{code} {method:?} was never told");
    }
}
