//! The commands that read a part: their output and their exit codes.

mod bridge;
mod calibrate;
mod chamber;
#[cfg(unix)]
mod chamber_faults;
mod faults;
mod help;
mod parts;
mod reading;
mod refused;
mod track;

use crate::harness::{Run, command};

/// Durations of a calibration that takes four minutes of simulated time. `--max-u-btc` accepts its uncertain BTC.
const SHORT: &[&str] =
    &["--average", "2s", "--warmup", "60s", "--settle", "120s", "--offset", "20s", "--max-u-btc", "0.2"];

fn zerorate(args: &[&str]) -> Run {
    Run::of(&mut command(args))
}

/// Runs `zerorate calibrate` with the short durations.
fn calibrate(args: &[&str]) -> Run {
    zerorate(&[&["calibrate"], SHORT, args].concat())
}
