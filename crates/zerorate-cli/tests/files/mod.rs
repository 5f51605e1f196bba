//! The commands that work on files.

mod allan;
mod analysis;
mod autopilot;
mod axes;
mod correct;
mod durable;
mod export;
mod failing;
mod front_ends;
mod golden;
mod hostile;
mod imu;
#[cfg(feature = "parquet")]
mod interop;
#[cfg(feature = "full")]
mod logs;
mod logs_of_parts;
mod misread;
#[cfg(not(feature = "full"))]
mod missing;
mod noise_models;
mod outputs;
mod report;
mod tempcal;
mod temperature;
mod verify;
#[path = "../../../zerorate-jobs/tests/jobs/white.rs"]
mod white;

use crate::harness::{Bench, PROGRAM, Run, SHORT, calibration, calibration_of};
use std::io::Write;
use std::path::Path;
use std::process::Command;
use white::white;

/// The forms of captures that are built in.
const FORMS: &[&str] = if cfg!(feature = "parquet") { &["csv", "arrows", "parquet"] } else { &["csv", "arrows"] };

/// The form with the smallest files.
const SMALLEST: &str = if cfg!(feature = "parquet") { "parquet" } else { "arrows" };

/// A calibration of three axes, written by hand.
const AXES: &str = r#"schema = 2
part = "ADIS16405"
[temperature]
lsb_per_c = 7.14
zero_code = 0
zero_c = 25
width_bits = 12
[[axis]]
name = "x"
rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 16 }
correction = { pbc_dps = -0.25, btc_dps_per_c = -0.04, t3_c = 31.5 }
[[axis]]
name = "y"
warnings = ["y < alone"]
rate = { lsb_per_dps = 20, zero_code = 0, width_bits = 14 }
correction = { pbc_dps = 0.75, btc_dps_per_c = 0.02, t3_c = 31.25 }
[[axis]]
name = "z"
rate = { lsb_per_dps = 23488, zero_code = 8388608, width_bits = 24 }
correction = { pbc_dps = 0.1, btc_dps_per_c = -0.01, t3_c = 31.5 }
[validity]
temp_min_c = 25.0
temp_max_c = 32.5
"#;

/// A CSV capture with this serial number and these rows: t_ns, edge_seq, rate_code, status, temp_code, lost.
fn capture(serial: &str, rows: &str) -> String {
    format!(
        "# zerorate.capture_schema = 1\n# zerorate.width_bits = 24\n# zerorate.rate_conversion = 5\n# \
         zerorate.temp_conversion = 5\n\
         # zerorate.serial = {serial}\nt_ns,edge_seq,rate_code,status,temp_code,lost\n{rows}"
    )
}

/// Samples as bytes for `--raw f64`.
fn raw(rate: &[f64]) -> Vec<u8> {
    rate.iter().flat_map(|rate| rate.to_le_bytes()).collect()
}

/// The number behind a key of a noise file.
fn number_of(yaml: &str, key: &str) -> f64 {
    let line = yaml.lines().find_map(|line| line.strip_prefix(key)).unwrap();
    line.trim_start_matches(':').split_whitespace().next().unwrap().parse().unwrap()
}

/// True if a program is installed. Otherwise prints that the test is skipped.
fn installed(program: &str) -> bool {
    let found = Command::new(program).arg("--version").output().is_ok_and(|output| output.status.success());
    if !found {
        skip(&format!("it needs `{program}`, which is not installed"));
    }
    found
}

/// Prints that a test is skipped. The test harness captures `eprintln!`, but not what is written to stderr directly.
fn skip(why: &str) {
    let line = format!("SKIPPED {}: {why}\n", std::thread::current().name().unwrap_or_default());
    std::io::stderr().write_all(line.as_bytes()).unwrap();
}

/// Runs a program that must succeed, and returns its stdout.
fn run(program: impl AsRef<Path>, args: &[&str], dir: &Path) -> String {
    let program = program.as_ref();
    let output = Command::new(program).args(args).current_dir(dir).output().unwrap();
    assert!(output.status.success(), "{}: {}", program.display(), String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}
