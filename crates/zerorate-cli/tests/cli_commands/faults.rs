//! A run without a result prints the reason to stderr and nothing to stdout, leaves no file, and exits with 1 or 3.
//! The tests of the individual faults are in `zerorate-jobs/tests/jobs/`.

use crate::harness::{Bench, SHORT};

#[track_caller]
fn ends_without_a_result(device: &str, code: i32, reasons: &[&str]) {
    let bench = Bench::new();
    let line = format!("calibrate {SHORT} --device {device} -o unit.toml --json");
    let run = bench.zerorate(&line).ended_with(code).saying(reasons);
    assert_eq!(run.stdout, "", "{device}: nothing for scripts to take for a result");
    assert!(bench.names().is_empty(), "{device}: {:?}", bench.names());
}

#[test]
fn a_refused_measurement_exits_with_3() {
    let code = "\ncode: moving (`zerorate explain moving` says more)";
    ends_without_a_result("twin:motion=sway", 3, &["refused: ", code]);
}

#[test]
fn a_part_that_does_not_answer_exits_with_1() {
    ends_without_a_result("twin:fault=sdo_low", 1, &["error: "]);
}
