//! Correcting a capture with the right calibration. `zerorate-jobs/tests/jobs/correct.rs` tests the numbers.

use super::{Bench, calibration, calibration_of, capture};

/// Readings of 10 °/s at 26 °C, 0 °/s without a temperature, and −10 °/s at 25 °C (F-42).
const ROWS: &str = "1000000,1,8623488,8,8402701,0\n2000000,2,8388608,8,,0\n3000000,5,8153728,,8388608,1\n";

#[test]
fn the_calibration_of_another_part_is_refused() {
    let bench = Bench::new();
    bench.write("a1.toml", calibration_of("A1", -0.25, -0.04, 24.0));
    bench.write("b2.toml", calibration_of("B2", -0.25, -0.04, 24.0));
    bench.write("rest.csv", capture("A1", ROWS));
    bench.zerorate("correct rest.csv --cal a1.toml -o a1.arrows").ok();
    bench.zerorate("correct rest.csv --cal b2.toml -o b2.arrows").fails(1, &["part A1", "part B2"]);
    assert!(!bench.path("b2.arrows").exists());
    bench.write("nameless.csv", capture("A1", ROWS).replace("# zerorate.serial = A1\n", ""));
    let doubtful = bench.zerorate("correct nameless.csv --cal a1.toml -o doubtful.arrows");
    doubtful.ended_with(0).saying(&["unknown-serial", "part A1"]);
    let known = bench.zerorate("correct nameless.csv --cal a1.toml -o known.arrows --serial A1").ended_with(0);
    assert!(!known.stderr.contains("unknown-serial"), "{}", known.stderr);
    bench.zerorate("correct nameless.csv --cal a1.toml -o b2.arrows --serial B2").fails(1, &[]);
    bench.zerorate("correct rest.csv --cal a1.toml -o b2.arrows --serial B2").fails(2, &[]);
    bench.write("nameless.toml", calibration(-0.25, -0.04, 24.0));
    let doubtful = bench.zerorate("correct rest.csv --cal nameless.toml -o doubtful.csv");
    doubtful.ended_with(0).saying(&["unknown-serial", "calibrate with one next time"]);
    let forced = bench.zerorate("correct rest.csv --cal b2.toml -o b2.arrows --force");
    forced.ended_with(0).saying(&["warning: rest.csv is part A1, b2.toml is for part B2"]);
}
