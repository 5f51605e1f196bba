//! The program `zerorate` as a library: the noise of any gyroscope, and the bias of an ADIS16130.
//!
//! The program calls [`main_confined`]. The command line in the Python wheel calls [`main`].

#![deny(
    clippy::print_stderr,
    clippy::print_stdout,
    reason = "they panic where a stream is full or closed: use output::say and output::print"
)]

mod cli;
mod column;
mod commands;
#[cfg(target_os = "linux")]
mod confined;
mod device;
mod exit;
mod exit_message;
mod first_steps;
#[cfg(test)]
#[expect(clippy::print_stderr, reason = "its replay is for the person who runs the tests")]
mod fuzz;
mod interrupt;
mod memory;
mod output;
mod part;
mod picture;
mod progress;
mod reference;
#[cfg(feature = "serve")]
mod serve;
mod wording;

use std::ffi::OsString;
use std::process::ExitCode;

/// Runs the command line `args`, program name first. Returns 0 for success, 1 failure, 2 usage error, 3 refusal.
///
/// `zerorate help` may end the process, because clap prints its text.
pub fn main(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let args: Vec<OsString> = args.into_iter().collect();
    match first_steps::parse(&args) {
        Ok(cli) => run(&cli),
        Err(code) => code,
    }
}

/// Runs the command line as the main function of a program does.
///
/// On Linux, a command that reads files from untrusted sources runs in a child process with limited memory.
pub fn main_confined(args: impl IntoIterator<Item = OsString>) -> ExitCode {
    let args: Vec<OsString> = args.into_iter().collect();
    let cli = match first_steps::parse(&args) {
        Ok(cli) => cli,
        Err(code) => return code,
    };
    #[cfg(target_os = "linux")]
    if let confined::Role::Supervisor(code) = confined::run(&args, &cli.foreign_files()) {
        return code;
    }
    run(&cli)
}

fn run(cli: &cli::Cli) -> ExitCode {
    let busy = cli.activity().map(progress::Busy::with);
    let ended = interrupt::handle().and_then(|()| cli.run());
    drop(busy);
    exit_message::say_after(|| match ended {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => exit::report(&error),
    })
}
