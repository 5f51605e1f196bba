//! The program `zerorate`, for the tasks that run it.

use crate::venv::done;
use anyhow::{Context, Result};
use std::path::PathBuf;
use std::process::Command;

/// Builds the program with the tests of the workspace, as the step `test-full` of `cargo xtask ci` does, so that
/// nothing is compiled twice.
pub fn program() -> Result<PathBuf> {
    let arguments = "test --release --workspace --all-features --no-run --quiet --test cli";
    done(Command::new("cargo").args(arguments.split(' ')))?;
    Ok(target_folder()?.join("release/zerorate"))
}

/// Cargo's target folder, in which this very program lies: as `debug/xtask`, or as `lab/release/lab`.
pub fn target_folder() -> Result<PathBuf> {
    let program = std::env::current_exe()?;
    let of_workspace = program.ancestors().nth(2).context("this program is not in a target folder")?;
    let folder = if of_workspace.ends_with("lab") { of_workspace.parent() } else { None };
    Ok(folder.unwrap_or(of_workspace).to_owned())
}
