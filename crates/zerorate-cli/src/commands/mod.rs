//! One file for each command, and what they share.

pub mod allan;
pub mod calibrate;
pub mod capture;
pub mod chamber;
pub mod correct;
pub mod explain;
pub mod export;
pub mod imu;
pub mod man;
pub mod probe;
pub mod repair;
pub mod report;
mod serial;
pub mod serve;
pub mod stream;
pub mod twin;
pub mod verify;

use crate::cli::{Cli, Command};
use crate::output::{Stdout, say};
use anyhow::{Context, Result};
use serde::Serialize;
use std::fmt::Display;
use std::io::Write;
use zerorate::{Say, Warning};
use zerorate_data::plain;

pub use calibrate::flag;

/// Carries out what the command line asks for.
pub fn run(cli: &Cli) -> Result<()> {
    match &cli.command {
        Command::Probe(args) => probe::run(args),
        Command::Capture(args) => capture::run(args),
        Command::Calibrate(args) => calibrate::run(args),
        Command::Recalibrate(args) => calibrate::run_again(args),
        Command::Chamber(args) => chamber::run(args),
        Command::Stream(args) => stream::run(args),
        Command::Correct(args) => correct::run(args),
        Command::Verify(args) => verify::run(args),
        Command::Repair(args) => repair::run(args),
        Command::Explain(args) => explain::run(args),
        Command::Export(args) => export::run(args),
        Command::Report(args) => report::run(args),
        Command::Allan(args) => allan::run(args),
        Command::Imu(args) => imu::run(args),
        Command::Serve(args) => serve::run(args),
        Command::Twin(args) => twin::run(args),
        Command::Completions { shell } => man::completions(*shell),
        Command::Man => man::man(),
    }
}

/// Prints text to stdout; a closed pipe is an error to be passed on, not a panic.
fn print(text: &str) -> Result<()> {
    let mut stdout = Stdout::lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).context("cannot write to stdout")
}

/// Prints lines for people to stdout, whatever stands in them.
fn print_lines(text: &str) -> Result<()> {
    print(&plain::lines(text))
}

/// Prints one JSON object to stdout.
fn print_json(value: &impl Serialize) -> Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

/// A warning as scripts find it: `code: text`.
pub fn coded(warning: &Warning) -> String {
    format!("{}: {}", warning.code(), warning.with(flag))
}

/// Prints warnings to stderr.
pub fn warn<T: Display>(warnings: &[T]) {
    for warning in warnings {
        say(format_args!("warning: {warning}"));
    }
}
