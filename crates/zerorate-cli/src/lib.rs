//! The program `zerorate` as a library: an ADIS16130 gyroscope, from its pins to a bias-free angular rate.
//!
//! The program is a call of [`main`], and so is the command line in the Python wheel.

#![deny(
    clippy::print_stderr,
    clippy::print_stdout,
    reason = "they panic where a stream is full or closed: output::say, output::print"
)]

mod cli;
mod column;
mod commands;
#[cfg(target_os = "linux")]
mod confined;
mod device;
mod exit;
#[cfg(test)]
#[expect(clippy::print_stderr, reason = "its replay is for whoever runs the tests")]
mod fuzz;
mod interrupt;
mod last_word;
mod memory;
mod output;
mod part;
mod progress;
#[cfg(feature = "serve")]
mod serve;
#[cfg(unix)]
mod twin_usb;
mod wording;

use clap::Parser;
use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the command line `args`, program name first, to its exit code: 0 done, 1 failed, 2 usage, 3 refused.
///
/// Help, `--version` and a command line that makes no sense end the process, as clap does.
pub fn main(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let cli = cli::Cli::parse_from(args);
    cli.set_limits();
    run(&cli)
}

/// The same for a process that is nothing but this program: on Linux, what reads files of unknown origin runs in a
/// child with a limit on its memory.
pub fn main_confined(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let args: Vec<OsString> = args.into_iter().collect();
    let cli = cli::Cli::parse_from(&args);
    cli.set_limits();
    #[cfg(target_os = "linux")]
    if let confined::Role::Supervisor(code) = confined::run(&args, &cli.foreign_files()) {
        return code;
    }
    run(&cli)
}

fn run(cli: &cli::Cli) -> ExitCode {
    let ended = interrupt::handle().and_then(|()| cli.run());
    last_word::say_after(|| match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => exit::report(&error),
    })
}
