//! Correcting a capture: once, with the right calibration, and with its raw columns unchanged.

use super::{Bench, FORMS, calibration, capture};
use std::fs;

/// 10 °/s at 26 °C, then a row without temperature, then −10 °/s at 25 °C (F-42).
const ROWS: &str = "1000000,1,8623488,8,8402701,0\n2000000,2,8388608,8,,0\n3000000,5,8153728,,8388608,1\n";

#[test]
fn the_formula_of_the_note_row_by_row() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", ROWS));
    bench.zerorate("correct rest.csv --cal unit.toml -o done.csv").ok();
    let done = fs::read_to_string(bench.path("done.csv")).unwrap();
    let rows: Vec<Vec<&str>> =
        done.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect()).collect();
    assert_eq!(
        rows[0].join(","),
        "t_ns,edge_seq,rate_code,status,temp_code,lost,rate_dps,temp_c,rate_corrected_dps,flags"
    );
    let raw: String = rows[1..].iter().map(|row| row[..6].join(",") + "\n").collect();
    assert_eq!(raw, ROWS, "raw columns are kept");
    let expected = [[10.0, 26.0, 10.0 - 0.25 - 0.08], [0.0, 26.0, -0.25 - 0.08], [-10.0, 25.0, -10.0 - 0.25 - 0.04]];
    for (row, expected) in rows[1..].iter().zip(expected) {
        assert_eq!(row[9], "0", "{row:?}");
        let found: Vec<f64> = row[6..9].iter().map(|cell| cell.parse().unwrap()).collect();
        assert!(found.iter().zip(expected).all(|(found, expected)| (found - expected).abs() < 1e-12), "{row:?}");
    }
    for entry in [
        "# zerorate.calibration_id = ",
        "# zerorate.serial = A1",
        "# zerorate.pbc_dps = -0.25",
        "# zerorate.t3_c = 24",
    ] {
        assert!(done.contains(entry), "{entry} is missing");
    }
}

/// The same rows with a curve, by hand: d is 2 and 1 °C.
#[test]
fn a_curve_row_by_row() {
    let bench = Bench::new();
    let curve = "schema = 3\npart = \"ADIS16130\"\n[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 24\n\
                 btc2_dps_per_c2 = 0.01\nbtc3_dps_per_c3 = -0.001\n";
    bench.write("unit.toml", curve);
    bench.write("rest.csv", capture("A1", ROWS));
    bench.zerorate("correct rest.csv --cal unit.toml -o done.csv").ok();
    let done = fs::read_to_string(bench.path("done.csv")).unwrap();
    for entry in ["# zerorate.btc2_dps_per_c2 = 0.01", "# zerorate.btc3_dps_per_c3 = -0.001"] {
        assert!(done.contains(entry), "{entry} is missing");
    }
    let rows = done.lines().filter(|line| !line.starts_with('#')).skip(1);
    let corrected: Vec<f64> = rows.map(|row| row.split(',').nth(8).unwrap().parse().unwrap()).collect();
    let (at_26, at_25) = (-0.25 - 0.08 + 0.04 - 0.008, -0.25 - 0.04 + 0.01 - 0.001);
    for (found, expected) in corrected.iter().zip([10.0 + at_26, at_26, -10.0 + at_25]) {
        assert!((found - expected).abs() < 1e-12, "{corrected:?}");
    }
    assert_eq!(corrected.len(), 3);
}

#[test]
fn a_bias_is_never_removed_twice() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", ROWS));
    for form in FORMS {
        bench.zerorate(&format!("correct rest.csv --cal unit.toml -o once.{form}")).ok();
        let refusal = bench.zerorate(&format!("correct once.{form} --cal unit.toml -o twice.{form} --force")).fails(1);
        assert!(refusal.contains("corrected already") && refusal.contains(&format!("once.{form}")), "{refusal}");
        assert!(!bench.path(&format!("twice.{form}")).exists());
    }
    let once = fs::read_to_string(bench.path("once.csv")).unwrap();
    let without = |keys: &[&str]| -> String {
        once.lines()
            .filter(|line| !keys.iter().any(|key| line.contains(key)))
            .map(|line| format!("{line}\n"))
            .collect()
    };
    bench.write("unmarked.csv", without(&["calibration_id"]));
    assert!(
        bench
            .zerorate("correct unmarked.csv --cal unit.toml -o twice.csv")
            .fails(1)
            .contains("not those that were recorded")
    );
    // even if a converter dropped the mark, and all checks
    let old = without(&["calibration_id", "zerorate.check", "zerorate.ax", "zerorate.temp."]);
    bench.write("unmarked.csv", old.replace("capture_schema = 2", "capture_schema = 1"));
    assert!(
        bench.zerorate("correct unmarked.csv --cal unit.toml -o twice.csv").fails(1).contains("corrected already")
    );
}

#[test]
fn the_calibration_of_another_part_is_refused() {
    let bench = Bench::new();
    let of = |serial: &str| {
        calibration(-0.25, -0.04, 24.0).replace("[correction]", &format!("serial = \"{serial}\"\n[correction]"))
    };
    bench.write("a1.toml", of("A1"));
    bench.write("b2.toml", of("B2"));
    bench.write("rest.csv", capture("A1", ROWS));
    bench.zerorate("correct rest.csv --cal a1.toml -o a1.arrows").ok();
    let refusal = bench.zerorate("correct rest.csv --cal b2.toml -o b2.arrows").fails(1);
    assert!(refusal.contains("part A1") && refusal.contains("part B2"), "{refusal}");
    assert!(!bench.path("b2.arrows").exists());
    bench.write("nameless.csv", capture("A1", ROWS).replace("# zerorate.serial = A1\n", ""));
    let doubtful = bench.zerorate("correct nameless.csv --cal a1.toml -o doubtful.arrows");
    assert!(doubtful.stderr.contains("unknown-serial") && doubtful.stderr.contains("part A1"));
    doubtful.ok();
    bench.write("nameless.toml", calibration(-0.25, -0.04, 24.0));
    let doubtful = bench.zerorate("correct rest.csv --cal nameless.toml -o doubtful.csv");
    assert!(doubtful.stderr.contains("unknown-serial") && doubtful.stderr.contains("zerorate calibrate"));
    doubtful.ok();
    let forced = bench.zerorate("correct rest.csv --cal b2.toml -o b2.arrows --force");
    assert!(forced.stderr.contains("warning: rest.csv is part A1, b2.toml is for part B2"));
    forced.ok();
}

#[test]
fn no_file_is_overwritten_by_accident() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", ROWS));
    bench.write("there.csv", "mine");
    assert!(bench.zerorate("correct rest.csv --cal unit.toml -o there.csv").fails(2).contains("--force"));
    assert_eq!(fs::read_to_string(bench.path("there.csv")).unwrap(), "mine");
    bench.zerorate("correct rest.csv --cal unit.toml -o there.csv --force").ok();
    bench.zerorate("correct rest.csv --cal unit.toml -o ./rest.csv --force").fails(2);
    assert_eq!(fs::read_to_string(bench.path("rest.csv")).unwrap(), capture("A1", ROWS));
}

#[test]
fn a_capture_that_is_wrong_leaves_nothing_behind() {
    let bench = Bench::new();
    bench.write("unit.toml", calibration(-0.25, -0.04, 24.0));
    bench.write("bad.csv", capture("A1", &format!("{ROWS}4000,6,x,,,0\n")));
    assert!(
        bench
            .zerorate("correct bad.csv --cal unit.toml -o done.csv")
            .fails(1)
            .contains("line 10, column rate_code: `x`")
    );
    bench.write("cold.csv", capture("A1", "1000,1,8623488,8,,0\n"));
    assert!(bench.zerorate("correct cold.csv --cal unit.toml -o done.csv").fails(1).contains("no temperature"));
    assert_eq!(fs::read_dir(bench.dir.path()).unwrap().count(), 3, "only what the test itself wrote");
}

#[test]
fn what_the_user_should_know_is_said() {
    let bench = Bench::new();
    let cal = calibration(-0.25, -0.04, 24.0);
    bench.write("unit.toml", format!("{cal}[validity]\ntemp_min_c = 26.0\ntemp_max_c = 30.0\n"));
    bench.write("rest.csv", capture("A1", "500,0,8388608,9,,0\n1000,1,8388608,9,8388608,0\n"));
    let run = bench.zerorate("correct rest.csv --cal unit.toml -o done.csv");
    let said = run.ended_with(0).stderr;
    assert!(said.contains("25.0 … 25.0 °C leaves the 26.0 … 30.0 °C"), "{said}");
    assert!(
        said.contains("warning: before-temperature: ")
            && said.contains("the first 1 rows come before the first temperature"),
        "{said}"
    );
    assert!(said.contains("out-of-range: rest.csv: 2 readings are beyond the range"), "{said}");
    let done = fs::read_to_string(bench.path("done.csv")).unwrap();
    assert!(done.contains("500,0,8388608,9,,0,0.0,,,2\n"), "uncorrected rows are empty, not zero: {done}");
}
