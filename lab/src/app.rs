//! The program `zerorate`, for tasks that run it.

use anyhow::Result;
use std::path::PathBuf;
pub use xtask::app::{WHOLE, program, target_folder};

/// Options of a task that tries the program on a unit of the twin.
#[derive(clap::Args)]
pub struct ProgramArgs {
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

impl ProgramArgs {
    /// The path of the given program, or of one that is built now.
    pub fn program(&self) -> Result<PathBuf> {
        Ok(std::path::absolute(self.program.clone().map_or_else(program, Ok)?)?)
    }
}
