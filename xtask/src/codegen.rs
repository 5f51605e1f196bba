//! `cargo xtask codegen`: all files that are generated from other sources of the project.

use anyhow::{Context, Result};
use std::process::Command;
use xtask::app;
use xtask::arguments::Arguments;
use xtask::venv::done;

/// The text of `--help`.
pub const HELP: &str = "\
\x20 --check  Write nothing, and fail where a file is not as it would be written

Generated files: bindings/c/include/zerorate.h, firmware/examples/src/unit.rs, and in docs/pictures/ the drawings and
the spectrum. `cargo xtask web` makes web/src/protocol.ts, which git does not keep.

allan.svg and correction.svg come from hours of the twin: `cargo xtask dist program pictures` draws them, and with
--check compares them. Pages of measurements are not generated files; the tasks that measure write them: methods,
`trust --update`, `firmware --update`.";

pub fn run(mut arguments: Arguments) -> Result<()> {
    let check = arguments.flag("--check");
    arguments.end()?;
    done(Command::new(app::built("codegen")?).args(check.then_some("--check"))).context("generated files")
}
