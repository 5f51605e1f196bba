//! Calibrations of the twin, the simulated sensor: its true bias is found within the stated uncertainty, or the
//! measurement is refused.

use super::bench::{Folder, calibrate, has, keep, only, refusal, short};
use zerorate::{Method, Plan};
use zerorate_jobs::calibrate::{AxisNumbers, Files, OutputOptions};
use zerorate_jobs::output::{OutputError, Outputs};

fn by(method: Method) -> Plan {
    Plan { method, ..short() }
}

/// The largest error of the correction at nine temperatures, in standard uncertainties.
fn worst_of_curve(numbers: &AxisNumbers) -> f64 {
    let truth = &numbers.truth.as_ref().unwrap().curve;
    assert_eq!((numbers.curve.len(), truth.len()), (9, 9));
    let off = numbers.curve.iter().zip(truth).map(|(found, truth)| {
        assert_eq!(found.temp_c, truth.temp_c);
        (found.correction_dps - truth.correction_dps).abs() / found.u_dps.unwrap()
    });
    off.fold(0.0, f64::max)
}

#[test]
fn every_method_states_a_curve_that_holds() {
    for method in [Method::An1042, Method::Warmup] {
        let done = calibrate("twin:seed=21,curvature=0,hysteresis=0,warmup_s=40", by(method)).unwrap();
        assert_eq!(only(&done).b1_dps.is_some(), method == Method::An1042);
        let worst = worst_of_curve(only(&done));
        assert!(worst < 4.0, "{method:?}: {worst} u");
    }
}

#[test]
fn the_uncertainty_budget_adds_up() {
    for (unit, plan) in [("twin:seed=7", short()), ("twin:seed=7,warmup_s=20", by(Method::Warmup))] {
        let done = calibrate(unit, plan).unwrap();
        let numbers = only(&done);
        for (name, u) in [("PBC", numbers.u_pbc_dps), ("BTC", numbers.u_btc_dps_per_c)] {
            let parts: Vec<_> = numbers.budget.iter().filter(|part| part.of == name).collect();
            let shares: f64 = parts.iter().map(|part| part.share).sum();
            let sum: f64 = parts.iter().map(|part| part.u * part.u).sum();
            assert!(parts.len() > 1 && (shares - 1.0).abs() < 1e-9, "{unit} {name}: {parts:?}");
            assert!((sum.sqrt() / u - 1.0).abs() < 1e-9, "{unit} {name}: {parts:?}");
        }
    }
}

/// A step of the supply by 300 mV moves the bias by 0.06 °/s (F-01). The step is removed and reported.
#[test]
fn a_step_of_the_supply_is_taken_out_of_a_warm_up() {
    let unit = "twin:seed=9,curvature=0,hysteresis=0,warmup_s=20,supply_step_mv=300,fault_at_s=120";
    let done = calibrate(unit, by(Method::Warmup)).unwrap();
    let step = only(&done).higher.as_ref().unwrap().steps[0].size_dps;
    assert!((step - 0.06).abs() < 0.02, "{step}");
    assert!(worst_of_curve(only(&done)) < 4.0, "{:?}", only(&done));
}

#[test]
fn a_target_ends_the_recording_or_is_missed() {
    let to = |dph: f64| {
        let plan = Plan { target_dps: Some(dph / 3600.0), ..by(Method::Warmup) };
        calibrate("twin:seed=4,warmup_s=20", plan).unwrap()
    };
    let early = to(60.0);
    assert!(early.report.duration_s < 200.0 && worst_of_curve(only(&early)) < 5.0, "{:?}", early.report);
    let missed = to(1.0);
    assert!((missed.report.duration_s - 205.0).abs() < 0.01, "{}", missed.report.duration_s);
    assert!(has(&missed.report.warnings, "target-missed"), "{:?}", missed.report.warnings);
}

/// At 220 samples a second, the resonance of 14.3 kHz (F-07) aliases to zero. A clock of 231.88 kHz gives this rate:
/// a sample takes 2 · 527 cycles.
#[test]
fn a_rate_that_folds_the_resonance_to_zero_is_warned_of() {
    let warnings = calibrate("twin:mclk_hz=231880", short()).unwrap().report.warnings;
    assert!(warnings.iter().any(|warning| warning.to_string().contains("at 220.0/s")), "{warnings:?}");
    assert!(has(&warnings, "resonance"), "{warnings:?}");
}

/// Each device and method, the code of the refusal (`None` for any other error), and words that name the cause.
const NO_RESULT: [(&str, Method, Option<&str>, &[&str]); 15] = [
    ("motion=sway", Method::An1042, Some("moving"), &["moves", "first average"]),
    ("ambient_c=-40,warmup_c=0", Method::An1042, Some("small-span"), &["temperature hardly changed"]),
    ("fault=frozen,fault_at_s=30", Method::An1042, Some("frozen"), &["frozen"]),
    ("fault=rdy_stutter", Method::An1042, Some("data-ready-stutters"), &["lost", "data ready stutters"]),
    ("rotation_dps=360", Method::An1042, Some("out-of-range"), &["out of range"]),
    ("rdy=pulse", Method::Warmup, Some("no-temperature"), &["use the other edge", "rdy_edge"]),
    ("", Method::Cycle, Some("one-way"), &["while it rose", "heat and cool"]),
    ("fault=sdo_low", Method::An1042, None, &["stuck at zeros", "pin 12", "alive"]),
    ("fault=sdo_high", Method::An1042, None, &["stuck at ones", "pin 12", "alive"]),
    ("fault=unplug", Method::An1042, None, &["unplugged", "pin 10", "pins 11, 13, 15"]),
    ("fault=sdo_low,fault_at_s=30", Method::An1042, None, &["30.0 s after power-on", "stuck at zeros", "pin 12"]),
    ("fault=sdo_high,fault_at_s=30", Method::An1042, None, &["stuck at ones", "pin 12"]),
    ("fault=brownout,fault_at_s=30", Method::An1042, None, &["lost its configuration", "5 V supply"]),
    ("fault=unplug,fault_at_s=30", Method::An1042, None, &["unplugged", "pin 10"]),
    ("fault=rdy_lost,fault_at_s=30", Method::An1042, None, &["no data ready", "RDY (pin 10)"]),
];

#[test]
fn a_failed_calibration_names_its_cause_and_writes_nothing() {
    for (keys, method, code, words) in NO_RESULT {
        let folder = Folder::new();
        folder.write("older.toml", "older");
        for name in ["older.toml", "new.toml"] {
            let kept = OutputOptions { output: Some(folder.path(name)), ..OutputOptions::default() };
            let error = keep(&format!("twin:{keys}"), by(method), kept).err().unwrap();
            assert_eq!(refusal(&error), code, "{keys}: {error:#}");
            let text = format!("{error:#}");
            assert!(words.iter().all(|word| text.contains(word)), "{keys}: {text}");
            if code.is_none() {
                break;
            }
        }
        assert_eq!((folder.names(), folder.text("older.toml")), (vec!["older.toml".to_owned()], "older".to_owned()));
    }
}

#[test]
fn a_recording_too_short_for_a_curve_is_refused() {
    let plan = Plan { average_s: 10.0, warmup_s: 10.0, settle_s: 10.0, offset_s: 5.0, ..by(Method::Warmup) };
    let error = calibrate("twin:", plan).err().unwrap();
    assert_eq!(refusal(&error), Some("no-curve"));
    let text = format!("{error:#}");
    assert!(text.contains("only 23 means over time") && text.contains("settle longer (settle_s)"), "{text}");
}

#[test]
fn an_output_that_cannot_be_written_is_refused_first() {
    let folder = Folder::new();
    let claim = |name: &str| {
        let kept = OutputOptions { output: Some(folder.path(name)), ..OutputOptions::default() };
        Files::claim(Outputs::new(false), kept).unwrap_err()
    };
    for name in [".", "missing/unit.toml"] {
        assert!(claim(name).to_string().contains("cannot write"), "{:#}", claim(name));
    }
    folder.write("there.toml", "mine");
    assert!(matches!(claim("there.toml").downcast_ref(), Some(OutputError::Exists { has_force: true, .. })));
    assert!(claim("unit.csv").to_string().contains("a calibration is TOML"));
    assert_eq!(folder.names(), ["there.toml"]);
}
