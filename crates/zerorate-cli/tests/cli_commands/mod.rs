//! The commands that read a part, the help, the catalogue of parts, and refused requests: output and exit codes.

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

use crate::harness::{Run, SHORT, command};

fn zerorate(args: &[&str]) -> Run {
    Run::of(&mut command(args))
}

fn calibrate(args: &[&str]) -> Run {
    zerorate(&[&["calibrate"], &*SHORT.split(' ').collect::<Vec<_>>(), args].concat())
}
