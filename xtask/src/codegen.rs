//! `cargo xtask codegen`: all files that are generated from other sources of the project.

use anyhow::{Context, Result, ensure};
use std::process::{Command, Stdio};
use xtask::arguments::Arguments;
use xtask::lab;

/// The text of `--help`.
pub const HELP: &str = "\
\x20 --check  Write nothing, and fail where a file is not as it would be written

Generated files: bindings/c/include/zerorate.h, web/src/protocol.ts, firmware/examples/src/unit.rs, docs/codes.md,
docs/reference/commands.md, and in docs/pictures/ the drawings and the spectrum.

allan.svg and correction.svg come from hours of the twin: `cargo xtask dist program pictures` draws them, and with
--check compares them. Pages of measurements are not generated files; the tasks that measure write them: methods,
`trust --update`, `firmware --update`.";

/// Tests that compare a file with what it would be now, and write the file where [`UPDATE`] is set.
const OF_TESTS: [(&str, &str); 3] = [
    ("web/src/protocol.ts", "the_page_knows_these_types"),
    ("docs/codes.md", "the_chapter_is_that_of_the_table"),
    ("docs/reference/commands.md", "the_page_is_that_of_the_program"),
];
/// The build is the one of the step `test-full`, so that nothing is compiled twice.
const BUILD: &str = "test --release --workspace --all-features --quiet --lib --test codes --";
const UPDATE: &str = "ZERORATE_UPDATE";

pub fn run(mut arguments: Arguments) -> Result<()> {
    let check = arguments.flag("--check");
    arguments.end()?;
    lab::tool("codegen", check.then_some("--check")).context("generated files")?;
    let mut cargo = Command::new("cargo");
    cargo.args(BUILD.split(' ')).args(OF_TESTS.map(|(_, test)| test)).env_remove(UPDATE).stderr(Stdio::inherit());
    if !check {
        cargo.env(UPDATE, "1");
    }
    let output = cargo.output().context("cannot start cargo")?;
    let said = String::from_utf8_lossy(&output.stdout);
    let files = OF_TESTS.map(|(file, _)| file).join(", ");
    ensure!(output.status.success(), "{files}: `cargo xtask codegen` writes them:\n{said}");
    ensure!(said.matches("1 passed").count() == OF_TESTS.len(), "not every one of {files} was compared:\n{said}");
    Ok(())
}
