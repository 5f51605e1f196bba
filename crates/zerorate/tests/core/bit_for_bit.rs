//! Checks that each method gives the same result from the same simulated hour as before, bit for bit.

use crate::golden::unchanged;
use crate::hours::measure;
use adis16130_twin::{Motion, Spec};
use zerorate::calibration::{Calibration, Origin};
use zerorate::{Method, Part};

/// Measures a unit. Returns the lines of its calibration file except header, checksums and warnings, and then the
/// warnings as values.
fn calibrated(spec: &Spec, method: Method) -> String {
    let (outcome, _) = measure(spec, method).expect("a unit at rest");
    let warnings: String = outcome.warnings.iter().map(|warning| format!("{warning:?}\n")).collect();
    let text = Calibration::new(&Part::ADIS16130, &[outcome], Origin::default()).to_toml();
    let words = ["#", "warnings", "checksum", "line_checks"];
    let numbers = text.lines().filter(|line| !words.iter().any(|word| line.starts_with(word)));
    numbers.map(|line| format!("{line}\n")).collect::<String>() + &warnings
}

fn all_unchanged(method: Method, specs: &[(&str, Spec)]) {
    for (what, spec) in specs {
        unchanged(&format!("{method:?}-{what}.toml").to_lowercase(), &calibrated(spec, method));
    }
}

#[test]
fn an1042_gives_unchanged_results() {
    let specs = [
        ("sway", Spec { motion: Motion::Sway, sway_dps: 0.05, sway_hz: 0.0008, ..Spec::from_seed(12) }),
        ("lag", Spec { lag_s: 60.0, ..Spec::from_seed(21) }),
        ("step", Spec { supply_step_mv: 200.0, fault_at_s: Some(3100.0), ..Spec::from_seed(22) }),
    ];
    all_unchanged(Method::An1042, &specs);
}

#[test]
fn a_warm_up_gives_unchanged_results() {
    let specs = [
        ("plain", Spec::from_seed(2)),
        ("sway", Spec { motion: Motion::Sway, sway_dps: 0.05, sway_hz: 0.0008, ..Spec::from_seed(12) }),
        ("lag", Spec { lag_s: 30.0, ..Spec::from_seed(3) }),
        ("step", Spec { supply_step_mv: 384.0, fault_at_s: Some(2492.0), ..Spec::from_seed(6) }),
        ("play", Spec { hysteresis_dps: 0.057, ..Spec::from_seed(7) }),
    ];
    all_unchanged(Method::Warmup, &specs);
}

#[test]
fn a_cycle_gives_an_unchanged_result() {
    all_unchanged(Method::Cycle, &[("plain", Spec::from_seed(4))]);
}
