//! `cargo xtask codegen`: all files that are generated from other sources of the project.

use anyhow::{Context, Result, ensure};
use std::process::{Command, Stdio};
use xtask::arguments::Arguments;
use xtask::lab;

/// The text of `--help`.
pub const HELP: &str = "\
\x20 --check  Write nothing, and fail where a file is not as it would be written

Generated files: bindings/c/include/zerorate.h, web/src/protocol.ts, firmware/examples/src/unit.rs, docs/codes.md, and
in docs/pictures/ the drawings and the spectrum.

allan.svg and correction.svg come from hours of the twin: `cargo xtask dist program pictures` draws them, and with
--check compares them. Pages of measurements are not generated files; the tasks that measure write them: methods,
`trust --update`, `firmware --update`.";

/// Files that tests compare with what they would be now, and write where [`UPDATE`] is set.
/// Each test is built alone. With the tests of the other libraries it would take several times as long.
const OF_TESTS: [(&str, &str); 3] = [
    ("web/src/protocol.ts", "test --quiet --package zerorate-web --lib the_page_knows_these_types"),
    ("docs/codes.md", "test --quiet --package zerorate-jobs --test codes the_chapter_is_that_of_the_table"),
    (
        "docs/reference/commands.md",
        "test --quiet --package zerorate-cli --features serve --lib the_page_is_that_of_the_program",
    ),
];
const UPDATE: &str = "ZERORATE_UPDATE";

pub fn run(mut arguments: Arguments) -> Result<()> {
    let check = arguments.flag("--check");
    arguments.end()?;
    lab::tool("codegen", check.then_some("--check")).context("generated files")?;
    OF_TESTS.iter().try_for_each(|(file, test)| of_test(file, test, check))
}

fn of_test(file: &str, test: &str, check: bool) -> Result<()> {
    let mut cargo = Command::new("cargo");
    cargo.args(test.split(' ')).env_remove(UPDATE).stderr(Stdio::inherit());
    if !check {
        cargo.env(UPDATE, "1");
    }
    let output = cargo.output().context("cannot start cargo")?;
    let said = String::from_utf8_lossy(&output.stdout);
    ensure!(output.status.success(), "{file}: `cargo xtask codegen` writes it:\n{said}");
    ensure!(said.contains("1 passed"), "no test compared {file}:\n{said}");
    Ok(())
}
