//! The program `zerorate`, for tasks that run it.

use anyhow::Result;
use std::path::{Path, PathBuf};
pub use xtask::app::{WHOLE, emptied, program, target_folder};

/// Options of a task that tries the program on a unit of the twin.
#[derive(clap::Args)]
pub struct ProgramArgs {
    /// The unit of the twin
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// The program to test, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

impl ProgramArgs {
    pub fn program(&self) -> Result<PathBuf> {
        given_or_built(self.program.as_deref())
    }
}

/// The absolute path of the given program, or of a program that is built now.
pub fn given_or_built(given: Option<&Path>) -> Result<PathBuf> {
    Ok(std::path::absolute(given.map_or_else(program, |given| Ok(given.to_owned()))?)?)
}
