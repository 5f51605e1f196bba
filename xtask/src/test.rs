//! `cargo xtask test`: the tests of the project, by `cargo test` and nothing else.

use crate::steps::{Step, show_times};
use anyhow::{Result, ensure};
use std::time::Instant;
use xtask::arguments::Arguments;

/// All crates but the Python package, with their default features; documentation tests are among them.
pub const STEP: Step = Step::new("test", "test");

/// What is not tested here, in one line.
const BESIDE: &str = "Beside these, `cargo xtask check` looks at format, lints, generated files and bare targets, and \
                      `cargo xtask ci` also tests all features, C, Python, the page, firmware and rigs.";

pub fn help() -> String {
    format!("This is `{STEP}`. Cargo itself runs some of the tests: `cargo test -p CRATE NAME`.\n{BESIDE}")
}

pub fn run(arguments: Arguments) -> Result<()> {
    let words = arguments.words()?;
    let words = words.join(" ");
    ensure!(words.is_empty(), "to run some tests: `cargo test {words}`; to run a step: `cargo xtask ci {words}`");
    let start = Instant::now();
    let passed = STEP.command().status()?.success();
    show_times(&[], start.elapsed());
    println!("{BESIDE}");
    ensure!(passed, "a test failed; to repeat: {STEP}");
    Ok(())
}
