//! The program as its users and their scripts run it: its output, its exit code, and the files that it leaves.

mod cli_commands;
mod files;
mod harness;
#[cfg(all(unix, feature = "serve"))]
mod serve;
