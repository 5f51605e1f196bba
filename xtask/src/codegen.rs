//! `cargo xtask codegen`: all files that are made of other sources of the project.

use anyhow::{Context, Result, ensure};
use std::process::{Command, Stdio};
use xtask::arguments::Arguments;
use xtask::lab;

/// What `--help` prints.
pub const HELP: &str = "\
  --check  Write nothing, and fail where a file is not as it would be written

Pages of measurements are not generated files; the tasks that measure write them: methods, `trust --update`,
`firmware --update`.";

/// The test that compares `web/src/protocol.ts` with the session of the page, and writes it where [`UPDATE`] is set.
/// It is built alone: beside those of the other libraries it would take several times as long.
const PROTOCOL: &str = "test --quiet --package zerorate-web --lib the_page_knows_these_types";
const UPDATE: &str = "ZERORATE_UPDATE";

pub fn run(mut arguments: Arguments) -> Result<()> {
    let check = arguments.flag("--check");
    arguments.end()?;
    lab::tool("codegen", check.then_some("--check")).context("generated files")?;
    let mut protocol = Command::new("cargo");
    protocol.args(PROTOCOL.split(' ')).env_remove(UPDATE).stderr(Stdio::inherit());
    if !check {
        protocol.env(UPDATE, "1");
    }
    let output = protocol.output().context("cannot start cargo")?;
    let said = String::from_utf8_lossy(&output.stdout);
    ensure!(output.status.success(), "web/src/protocol.ts: `cargo xtask codegen` writes it:\n{said}");
    ensure!(said.contains("1 passed"), "no test compared web/src/protocol.ts:\n{said}");
    Ok(())
}
