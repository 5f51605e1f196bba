//! The build that the tests, the tasks and the wheel share: one profile, one set of features.

use crate::venv::done;
use anyhow::{Context, Result};
use std::fs;
use std::path::PathBuf;
use std::process::Command;

/// Cargo options for all packages but xtask, with all features of the program. Cargo compiles a library again for each
/// set of features, so all builds use these options.
pub const WHOLE: &str = "--release --workspace --exclude xtask --features zerorate-cli/full,zerorate-web/readers";

/// Builds the program `zerorate`; returns its path.
pub fn program() -> Result<PathBuf> {
    built("zerorate")
}

/// Builds a program of the workspace; returns its path.
pub fn built(name: &str) -> Result<PathBuf> {
    let mut cargo = Command::new("cargo");
    done(cargo.args(["build", "--quiet", "--locked", "--bin", name]).args(WHOLE.split(' ')))?;
    Ok(target_folder()?.join("release").join(name))
}

/// Cargo's target folder. The running program is in it, as `debug/xtask` or as `release/lab`.
pub fn target_folder() -> Result<PathBuf> {
    let program = std::env::current_exe()?;
    Ok(program.ancestors().nth(2).context("this program is not in a target folder")?.to_owned())
}

/// Makes `folder` an empty folder, whatever it held; returns it.
pub fn emptied(folder: PathBuf) -> Result<PathBuf> {
    if folder.exists() {
        fs::remove_dir_all(&folder)?;
    }
    fs::create_dir_all(&folder)?;
    Ok(folder)
}
