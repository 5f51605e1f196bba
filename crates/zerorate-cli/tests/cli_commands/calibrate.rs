//! `calibrate` and `recalibrate`.

use super::{SHORT, calibrate, zerorate};
use serde_json::Value;
use std::path::{Path, PathBuf};

fn file(folder: &tempfile::TempDir, name: &str) -> PathBuf {
    folder.path().join(name)
}

fn path(path: &Path) -> &str {
    path.to_str().expect("a plain path")
}

#[test]
fn the_json_object_has_the_keys_of_the_contract() {
    let result = calibrate(&["--device", "twin:seed=7", "--json"]).ended_with(0).json();
    let numbers = "b1_dps t1_c b2_dps t2_c btc_dps_per_c pbc_dps t3_c u_pbc_dps u_btc_dps_per_c rdy_hz rate_hz \
        samples lost_samples duration_s";
    for key in numbers.split_whitespace() {
        assert!(result[key].is_number(), "{key} in {result}");
    }
    assert_eq!(result["method"], "an1042");
    assert!(result["warnings"].as_array().is_some_and(|warnings| !warnings.is_empty()));
    assert!(result["truth"]["pbc_dps"].is_number() && result["truth"]["btc_dps_per_c"].is_number());
    assert_eq!(result["lost_samples"], 0);
    let duration_s = number(&result, "duration_s");
    assert!((duration_s - 205.0).abs() < 0.01, "2 + 60 + 2 + 120 + 20 + 1 s: {duration_s}");
    assert!((number(&result, "rate_hz") / 5_693.0 - 1.0).abs() < 0.011, "F-31, M-06");
}

fn number(result: &Value, key: &str) -> f64 {
    result[key].as_f64().unwrap_or_else(|| panic!("{key} in {result}"))
}

/// Without noise there is only the curvature of the bias, which is off, and the drift of an unsettled part.
#[test]
fn the_twins_truth_is_found() {
    let unit = "twin:noise=0,curvature=0,hysteresis=0,bias_dps=0.8,tempco_dps_per_c=0.05,warmup_s=20";
    let result = calibrate(&["--device", unit, "--json", "--assume-linear"]).ended_with(0).json();
    let off = |key: &str| number(&result, key) - number(&result["truth"], key);
    assert!(off("btc_dps_per_c").abs() < 1e-5, "{result}");
    assert!(off("pbc_dps").abs() < 1e-4, "{result}");
}

#[test]
fn a_recording_gives_the_same_file_byte_for_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    let [live, log, again] = ["live.toml", "log.arrows", "again.toml"].map(|name| file(&folder, name));
    let given = ["--serial", "SN-42", "--supply-note", "bench 3"];
    let args = [&["--device", "twin:seed=5", "--log", path(&log), "-o", path(&live)], &given[..]].concat();
    calibrate(&args).ended_with(0);
    zerorate(&[&["recalibrate", path(&log), "-o", path(&again)], SHORT].concat()).ended_with(0);
    let [live, again] = [live, again].map(|file| std::fs::read_to_string(file).expect("a calibration"));
    assert_eq!(live, again);
    assert!(live.contains("serial = \"SN-42\"") && live.contains("supply_note = \"bench 3\""), "{live}");
}

/// The recording of one part became the calibration of another, without a word.
#[test]
fn a_recording_of_another_part_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let [log, other, copy] = ["log.arrows", "other.toml", "copy.arrows"].map(|name| file(&folder, name));
    zerorate(&["capture", "--samples", "100", "--serial", "SN9", "-o", path(&log)]).ended_with(0);
    let device = format!("replay:{}", path(&log));
    for line in [
        &["recalibrate", path(&log), "--serial", "SN7", "-o", path(&other)][..],
        &["calibrate", "--device", &device, "--serial", "SN7", "-o", path(&other)],
        &["capture", "--device", &device, "--serial", "SN7", "-o", path(&copy)],
    ] {
        zerorate(line).ended_with(1).saying(&["the recording is of part SN9, not of part SN7"]);
        assert!(!other.exists() && !copy.exists());
    }
}

/// Three twins on one clock: each axis is found within its uncertainty, and the recording gives the same.
#[test]
fn a_part_with_three_axes_is_calibrated_in_one_go() {
    let folder = tempfile::tempdir().expect("a folder");
    let [live, log, again] = ["live.toml", "log.arrows", "again.toml"].map(|name| file(&folder, name));
    let device = "twin:seed=11,axes=3,warmup_s=20,curvature=0,hysteresis=0";
    let args = ["--device", device, "--assume-linear", "--log", path(&log), "-o", path(&live), "--json"];
    let result = calibrate(&args).ended_with(0).json();
    let axes = result["axes"].as_array().expect("axes");
    assert_eq!(axes.iter().map(|axis| axis["name"].as_str().unwrap_or_default()).collect::<String>(), "xyz");
    for axis in axes {
        let off = |key: &str, u: &str| (number(axis, key) - number(&axis["truth"], key)) / number(axis, u);
        let (pbc, btc) = (off("pbc_dps", "u_pbc_dps"), off("btc_dps_per_c", "u_btc_dps_per_c"));
        assert!(pbc.abs() < 4.0 && btc.abs() < 4.0, "{pbc} u, {btc} u: {axis}");
    }
    assert!((number(&axes[0], "pbc_dps") - number(&axes[2], "pbc_dps")).abs() > 0.01, "{result}");
    zerorate(&[&["recalibrate", path(&log), "--assume-linear", "-o", path(&again)], SHORT].concat()).ended_with(0);
    let [live_text, again] = [&live, &again].map(|file| std::fs::read_to_string(file).expect("a calibration"));
    // what is known of a twin is in no capture
    let numbers = |text: &str| {
        let of = |line: &&str| {
            ["b1_dps", "t1_c", "b2_dps", "t2_c", "pbc_dps", "t3_c"].iter().any(|key| line.starts_with(key))
        };
        text.lines().filter(of).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(numbers(&live_text).len(), 18, "{live_text}");
    assert_eq!(numbers(&live_text), numbers(&again));
    let stream = ["stream", "--device", device, "--cal", path(&live), "--duration", "2s", "--rate", "2"];
    assert!(zerorate(&stream).ended_with(0).stdout.starts_with("t_s,x_dps,y_dps,z_dps"));
}

#[test]
fn recalibrating_for_other_durations_says_what_to_give() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = file(&folder, "log.arrows");
    zerorate(&["capture", "--duration", "3s", "-o", path(&log)]).ended_with(0);
    zerorate(&["recalibrate", path(&log)]).ended_with(1).saying(&["the recording ends after 3s", "--average"]);
    zerorate(&["recalibrate", path(&log), "--average", "2s", "--warmup", "0", "--settle", "0", "--offset", "1s"])
        .ended_with(1)
        .saying(&["the recording ends"]);
}

#[test]
fn the_text_report_shows_values_with_units_and_what_next() {
    let folder = tempfile::tempdir().expect("a folder");
    let unit = file(&folder, "unit.toml");
    let text = calibrate(&["-o", path(&unit)]).ended_with(0).saying(&["warning: ", "Earth"]).stdout;
    for part in ["PBC", "BTC", "°/s/°C", "±", "T3 =", "95 %", "zerorate stream --cal"] {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let text = calibrate(&["--earth-dps", "-0.003", "--assume-linear"]).ended_with(0).stdout;
    assert!(text.contains("-o unit.toml"), "{text}");
}

#[test]
fn a_recording_is_not_overwritten_by_accident() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = file(&folder, "log.arrows");
    std::fs::write(&log, "precious").expect("written");
    calibrate(&["--log", path(&log)]).ended_with(2).saying(&["--force"]);
    assert_eq!(std::fs::read_to_string(&log).expect("still there"), "precious");
}

#[test]
fn files_that_are_no_captures_are_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let text = file(&folder, "text.arrows");
    std::fs::write(&text, "hello\n").expect("written");
    zerorate(&["recalibrate", path(&text)]).ended_with(1).saying(&["text.arrows"]);
    zerorate(&["recalibrate", path(&file(&folder, "none.arrows"))]).ended_with(1).saying(&["none.arrows"]);
}

/// The curve of every method against the twin's truth, at the nine temperatures of the contract.
fn worst_of_curve(result: &Value) -> f64 {
    let points = |list: &Value| list.as_array().cloned().unwrap_or_default();
    let (curve, truth) = (points(&result["curve"]), points(&result["truth"]["curve"]));
    assert_eq!((curve.len(), truth.len()), (9, 9), "{result}");
    let off = curve.iter().zip(&truth).map(|(found, truth)| {
        assert_eq!(found["temp_c"], truth["temp_c"]);
        (number(found, "correction_dps") - number(truth, "correction_dps")).abs() / number(found, "u_dps")
    });
    off.fold(0.0, f64::max)
}

#[test]
fn every_method_states_a_curve_that_holds() {
    for method in ["an1042", "warmup"] {
        let unit = "twin:seed=21,curvature=0,hysteresis=0,warmup_s=40";
        let result = calibrate(&["--device", unit, "--json", "--method", method]).ended_with(0).json();
        assert_eq!(result["method"], method);
        assert_eq!(result["b1_dps"].is_number(), method == "an1042", "{result}");
        assert!(worst_of_curve(&result) < 4.0, "{method}: {result}");
    }
}

/// The whole recording again, without its length being told: the same file, and a curve in it.
#[test]
fn a_recorded_warm_up_gives_the_same_curve_byte_for_byte() {
    let folder = tempfile::tempdir().expect("a folder");
    let [live, log, again] = ["live.toml", "log.arrows", "again.toml"].map(|name| file(&folder, name));
    let args = ["--device", "twin:seed=5,curvature=0.004,warmup_s=40", "--method", "warmup"];
    calibrate(&[&args[..], &["--log", path(&log), "-o", path(&live)]].concat()).ended_with(0);
    let again_args = ["recalibrate", path(&log), "--method", "warmup", "--max-u-btc", "0.2", "-o", path(&again)];
    zerorate(&again_args).ended_with(0);
    let [live, again] = [live, again].map(|file| std::fs::read_to_string(file).expect("a calibration"));
    assert_eq!(live, again);
    for part in ["schema = 3", "method = \"warmup\"", "btc2_dps_per_c2", "[curve]", "covariance"] {
        assert!(live.contains(part), "{part} in {live}");
    }
}

/// A part that only warms does not make a cycle. One that cools again does, and its loop is found.
#[test]
fn a_cycle_must_rise_and_fall() {
    let refused = calibrate(&["--method", "cycle"]).ended_with(3);
    assert!(
        refused.stderr.contains("while it rose") && refused.stderr.contains("heat and cool"),
        "{}",
        refused.stderr
    );
}

/// 300 mV in the middle, where the temperature has settled: taken out, and said.
#[test]
fn a_step_of_the_supply_is_taken_out_of_a_warm_up() {
    let unit = "twin:seed=9,curvature=0,hysteresis=0,warmup_s=20,supply_step_mv=300,fault_at_s=120";
    let result = calibrate(&["--device", unit, "--json", "--method", "warmup"]).ended_with(0).json();
    let size_dps = number(&result["steps"][0], "size_dps");
    assert!((size_dps - 0.06).abs() < 0.02, "{result}");
    assert!(worst_of_curve(&result) < 4.0, "{result}");
}

/// What can be reached ends early, and what cannot is told before and after.
#[test]
fn a_target_ends_the_recording_or_is_said_to_be_missed() {
    let args = ["--device", "twin:seed=4,warmup_s=20", "--method", "warmup", "--json", "--target-dph"];
    let early = calibrate(&[&args[..], &["60"]].concat()).ended_with(0).json();
    assert!(number(&early, "duration_s") < 200.0, "{early}");
    assert!(worst_of_curve(&early) < 5.0, "{early}");
    let missed = calibrate(&[&args[..], &["1"]].concat()).ended_with(0).json();
    assert!((number(&missed, "duration_s") - 205.0).abs() < 0.01, "{missed}");
    assert!(missed["warnings"].to_string().contains("target-missed"), "{missed}");
}

/// A calibration of the twin is saved only when asked, and says what it is wherever it goes.
#[test]
fn a_simulated_calibration_says_so() {
    let folder = tempfile::tempdir().expect("a folder");
    let unit = file(&folder, "unit.toml");
    let run = calibrate(&["--device", "twin:seed=7"]).ended_with(0);
    assert!(run.stderr.contains("the result will only be printed; -o FILE saves it"), "{}", run.stderr);
    assert!(run.stdout.starts_with("SIMULATED: Calibration "), "{}", run.stdout);
    let given = ["--operator", "Ada", "--ambient-note", "23 °C", "-o", path(&unit), "--json"];
    let result = calibrate(&[&["--device", "twin:seed=7"], &given[..]].concat()).ended_with(0).json();
    assert_eq!((&result["simulated"], &result["file"]), (&true.into(), &path(&unit).into()));
    let text = std::fs::read_to_string(&unit).expect("a calibration");
    for line in ["schema = 4", "created = \"SIMULATED\"", "operator = \"Ada\"", "ambient_note = \"23 °C\""] {
        assert!(text.contains(line), "{line} in {text}");
    }
    assert!(!text.contains("\nhost"), "its files depend on the seed alone: {text}");
    let report = zerorate(&["report", path(&unit)]).ended_with(0).stdout;
    assert!(report.contains("<title>SIMULATED: Calibration of ADIS16130"), "{report}");
    let header = zerorate(&["export", path(&unit), "--format", "c"]).ended_with(0).stdout;
    assert!(header.contains("measured     SIMULATED"), "{header}");
}

/// The shares of the variance add up, and each part is no more than the whole.
#[test]
fn the_uncertainty_budget_adds_up() {
    let result = calibrate(&["--device", "twin:seed=7", "--json"]).ended_with(0).json();
    let budget = result["budget"].as_array().expect("a budget");
    for (name, u) in [("PBC", number(&result, "u_pbc_dps")), ("BTC", number(&result, "u_btc_dps_per_c"))] {
        let parts: Vec<&Value> = budget.iter().filter(|part| part["of"] == name).collect();
        let sum = |key: &str, power: i32| parts.iter().map(|part| number(part, key).powi(power)).sum::<f64>();
        assert!(parts.len() > 1 && (sum("share", 1) - 1.0).abs() < 1e-9, "{name}: {parts:?}");
        assert!((sum("u", 2).sqrt() / u - 1.0).abs() < 1e-9, "{name}: {parts:?}");
    }
}

/// F-16, by the latitude.
#[test]
fn the_latitude_gives_the_earths_rotation() {
    let earth = |given: &[&str]| {
        let device = ["--device", "twin:seed=7", "--json"];
        number(&calibrate(&[&device, given].concat()).ended_with(0).json(), "pbc_dps")
    };
    let (without, north, south) = (earth(&[]), earth(&["--latitude", "30"]), earth(&["--latitude", "-30"]));
    assert!((north - without - 0.00209).abs() < 1e-9 && (south - without + 0.00209).abs() < 1e-9, "{north} {south}");
    calibrate(&["--latitude", "91"]).ended_with(2).saying(&["from -90 to 90"]);
    calibrate(&["--latitude", "1", "--earth-dps", "0"]).ended_with(2);
}
