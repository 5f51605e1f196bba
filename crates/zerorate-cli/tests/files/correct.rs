//! Correcting a capture: once, with the right calibration, and with its raw columns unchanged.

use super::{Bench, calibration, capture};
use std::fs;

/// 10 °/s at 26 °C, then a row without temperature, then −10 °/s at 25 °C (F-42).
const ROWS: &str = "1000000,1,8623488,8,8402701,0\n2000000,2,8388608,8,,0\n3000000,5,8153728,,8388608,1\n";

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
    assert!(doubtful.stderr.contains("unknown-serial") && doubtful.stderr.contains("calibrate with one next time"));
    doubtful.ok();
    let forced = bench.zerorate("correct rest.csv --cal b2.toml -o b2.arrows --force");
    assert!(forced.stderr.contains("warning: rest.csv is part A1, b2.toml is for part B2"));
    forced.ok();
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
