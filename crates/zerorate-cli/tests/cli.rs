//! The program, run as its users and their scripts run it: what it prints where, how it ends, which files it leaves.

mod cli_commands;
mod files;
mod harness;
#[cfg(all(unix, feature = "serve"))]
mod serve;
