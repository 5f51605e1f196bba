//! The program `zerorate`: an ADIS16130 gyroscope, from its pins to a bias-free angular rate.

mod acquire;
mod capture;
mod cli;
mod column;
mod commands;
mod device;
mod duration;
mod exit;
mod interrupt;
mod progress;

use clap::Parser;
use std::process::ExitCode;

/// What stands in the files that this program writes.
const SOFTWARE: &str = concat!("zerorate ", env!("CARGO_PKG_VERSION"));

fn main() -> ExitCode {
    match commands::run(&cli::Cli::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => exit::report(&error),
    }
}
