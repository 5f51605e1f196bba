//! The commands `calibrate` and `recalibrate`.

use super::calibrate;
use crate::harness::{Bench, Run, SHORT, calibration};
use serde_json::Value;

fn calibrated(bench: &Bench, more: &str) -> Run {
    bench.zerorate(&format!("calibrate {SHORT} {more}")).ended_with(0)
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
    let text = calibrated(&Bench::new(), "-o unit.toml").saying(&["warning: short-average"]).stdout;
    for part in
        ["PBC", "BTC", "°/s/°C", "±", "T3 =", "95 %", "uncertainty (earth-included): ", "zerorate stream --cal"]
    {
        assert!(text.contains(part), "{part} in\n{text}");
    }
    let text = calibrate(&["--earth-dps", "-0.003", "--assume-linear"]).ended_with(0).stdout;
    assert!(text.contains("-o unit.toml"), "{text}");
}

/// A calibration of the twin is saved only on request. Its file, JSON and text say that it is simulated.
#[test]
fn a_simulated_calibration_says_so() {
    let bench = Bench::new();
    let run = calibrated(&bench, "--device twin:seed=7");
    assert!(run.stderr.contains("the result will only be printed; -o FILE saves it"), "{}", run.stderr);
    assert!(run.stdout.starts_with("SIMULATED: Calibration "), "{}", run.stdout);
    let given = "--device twin:seed=7 --operator Ada --ambient-note 23°C -o unit.toml --json";
    let result = calibrated(&bench, given).json();
    assert_eq!((&result["simulated"], &result["file"]), (&true.into(), &"unit.toml".into()));
    let text = bench.text("unit.toml");
    for line in ["schema = 4", "created = \"SIMULATED\"", "operator = \"Ada\"", "ambient_note = \"23°C\""] {
        assert!(text.contains(line), "{line} in {text}");
    }
    assert!(!text.contains("\nhost"), "its files depend on the seed alone: {text}");
    let report = bench.zerorate("report unit.toml").ended_with(0).stdout;
    assert!(report.contains("<title>SIMULATED: Calibration of ADIS16130"), "{report}");
    let header = bench.zerorate("export unit.toml --format c").ended_with(0).stdout;
    assert!(header.contains("measured     SIMULATED"), "{header}");
}

/// `--latitude` subtracts the Earth's rotation, 0.00418 °/s times the sine of the latitude (F-16).
#[test]
fn the_latitude_gives_the_earths_rotation() {
    let earth = |given: &[&str]| {
        let device = ["--device", "twin:seed=7", "--json"];
        number(&calibrate(&[&device, given].concat()).ended_with(0).json(), "pbc_dps")
    };
    let (without, north, south) = (earth(&[]), earth(&["--latitude", "30"]), earth(&["--latitude", "-30"]));
    assert!((north - without - 0.00209).abs() < 1e-9 && (south - without + 0.00209).abs() < 1e-9, "{north} {south}");
    // the twin does not rotate with the Earth unless `rotation_dps` says so
    let at_rest = calibrate(&["--device", "twin:seed=7", "--latitude", "30"]).ended_with(0);
    at_rest.saying(&["twin-at-rest", "PBC is +0.00209 °/s off", "rotation_dps=0.00209"]);
    let turning = calibrate(&["--device", "twin:seed=7,rotation_dps=0.00209", "--latitude", "30"]).ended_with(0);
    assert!(!turning.stderr.contains("twin-at-rest"), "{}", turning.stderr);
    calibrate(&["--latitude", "91"]).ended_with(2).saying(&["from -90 to 90"]);
    calibrate(&["--latitude", "1", "--earth-dps", "0"]).ended_with(2);
}

#[test]
fn the_page_of_a_calibration_shows_its_own_capture() {
    let bench = Bench::new();
    let plan = "--device twin:seed=4,warmup_s=20 --method warmup --target-dph 60 --json";
    let early = calibrated(&bench, &format!("{plan} --log log.arrows -o live.toml")).json();
    assert!(number(&early, "duration_s") < 200.0, "60 °/h are reached before the end: {early}");
    bench.zerorate("report live.toml --capture log.arrows -o live.html").ended_with(0);
    let page = bench.text("live.html");
    let shown = ["The measurement</h", "rate with the correction, °/s", "not in the uncertainty (earth-included)"];
    assert!(shown.iter().all(|part| page.contains(part)), "{page}");
    bench.zerorate("capture --device twin:seed=4 --samples 900 -o other.arrows").ended_with(0);
    bench.zerorate("report live.toml --capture other.arrows -o b.html").ended_with(1).saying(&["is not the capture"]);
    // this calibration uses only the beginning of the capture
    let short = "--average 2s --warmup 30s --settle 5s --offset 5s --max-u-btc 1";
    bench.zerorate(&format!("recalibrate log.arrows {short} -o part.toml")).ok();
    bench.zerorate("report part.toml --capture log.arrows -o part.html").ended_with(0);
    bench.write("hand.toml", calibration(0.0, 0.0, 30.0));
    bench
        .zerorate("report hand.toml --capture log.arrows -o b.html")
        .ended_with(1)
        .saying(&["does not state its capture"]);
    bench.zerorate("report live.toml hand.toml --capture log.arrows -o b.html").ended_with(2).saying(&["alone"]);
}
