//! The program `zerorate`, for the tasks that run it.

use crate::venv::done;
use anyhow::{Context, Result};
use std::path::PathBuf;
use std::process::Command;

/// What a task takes that tries the program on a unit of the twin.
#[derive(clap::Args)]
pub struct Args {
    /// The unit of the twin
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Print one JSON object to stdout
    #[arg(long)]
    pub json: bool,
    /// The program to test, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

impl Args {
    /// The program that was named, or else one that is built now.
    pub fn program(&self) -> Result<PathBuf> {
        Ok(std::path::absolute(self.program.clone().map_or_else(program, Ok)?)?)
    }
}

/// Builds the program with the tests of the workspace, as `cargo xtask test` does, so that nothing is compiled twice.
pub fn program() -> Result<PathBuf> {
    let arguments = "test --workspace --all-features --no-run --quiet --test cli";
    done(Command::new("cargo").args(arguments.split(' ')))?;
    Ok(target_folder()?.join("debug/zerorate"))
}

/// Cargo's target folder, in which this very program lies.
pub fn target_folder() -> Result<PathBuf> {
    let program = std::env::current_exe()?;
    let folder = program.ancestors().nth(2).context("xtask lies outside of a target folder")?;
    Ok(folder.to_owned())
}
