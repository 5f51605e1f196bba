//! `cargo xtask codegen`: all files that are made of other sources of the project.

use anyhow::{Context, Result};
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::lab;
use xtask::venv::done;

/// What `--help` prints.
pub const HELP: &str = "\
  --check  Write nothing, and fail where a file is not as it would be written

Pages of measurements are not generated files; the tasks that measure write them: methods, `trust --update`,
`firmware --update`.";

/// The test of the page's session that compares `web/src/protocol.ts`, and writes it where [`UPDATE`] is set.
const PROTOCOL: &str = "test --quiet --package zerorate-web --lib -- the_page_knows_these_types";
const UPDATE: &str = "ZERORATE_UPDATE";

pub fn run(mut arguments: Arguments) -> Result<()> {
    let check = arguments.flag("--check");
    arguments.end()?;
    lab::tool("codegen", check.then_some("--check")).context("generated files")?;
    let mut protocol = Command::new("cargo");
    protocol.args(PROTOCOL.split(' ')).env_remove(UPDATE);
    if !check {
        protocol.env(UPDATE, "1");
    }
    done(&mut protocol).context("web/src/protocol.ts; `cargo xtask codegen` writes it")
}
