//! The commands on a part: what they print where, and how they end.

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

/// A calibration in four minutes of part time. Its BTC is poor, which `--max-u-btc` accepts.
const SHORT: &[&str] =
    &["--average", "2s", "--warmup", "60s", "--settle", "120s", "--offset", "20s", "--max-u-btc", "0.2"];

fn zerorate(args: &[&str]) -> Run {
    Run::of(&mut command(args))
}

/// `zerorate calibrate` with the short durations.
fn calibrate(args: &[&str]) -> Run {
    zerorate(&[&["calibrate"], SHORT, args].concat())
}
