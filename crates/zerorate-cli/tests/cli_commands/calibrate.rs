//! `calibrate` and `recalibrate`.

use super::{calibrate, zerorate};
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

/// The whole recording again, without its length being told: the same file.
#[test]
fn a_recorded_warm_up_gives_the_same_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let [live, log, again] = ["live.toml", "log.arrows", "again.toml"].map(|name| file(&folder, name));
    let args = ["--device", "twin:seed=4,warmup_s=20", "--method", "warmup", "--target-dph", "60", "--json"];
    let early = calibrate(&[&args[..], &["--log", path(&log), "-o", path(&live)]].concat()).ended_with(0).json();
    assert!(number(&early, "duration_s") < 200.0, "60 °/h are reached before the end: {early}");
    let args = ["recalibrate", path(&log), "--method", "warmup", "--max-u-btc", "0.2", "-o", path(&again)];
    zerorate(&args).ended_with(0);
    let [live, again] = [live, again].map(|file| std::fs::read_to_string(file).expect("a calibration"));
    let curve = |text: &str| text.split("[curve]").nth(1).expect("a curve").to_owned();
    assert_eq!(curve(&live), curve(&again));
}
