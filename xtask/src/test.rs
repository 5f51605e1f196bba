//! `cargo xtask test`: the tests of the project, by `cargo test --release` and nothing else.

use crate::steps::{Step, clock};
use anyhow::{Result, ensure};
use std::time::Instant;
use xtask::arguments::Arguments;

/// All crates, with their default features and with documentation tests. The profile is the one of the README's first
/// command, which has built the dependencies by then. Building them in another profile takes minutes. `test-full` of
/// `ci` tests in the profile `dev`, which checks for overflow.
pub const STEP: Step = Step::new("test", "test --release");

/// The tests that are left out here, in one line.
const BESIDE: &str = "`cargo xtask check` looks at format, lints, generated files and bare targets; `cargo xtask ci` \
                      does all this and tests all features, C, Python, the page, firmware and rigs.";

pub fn help() -> String {
    format!("This is `{STEP}`. Cargo itself runs some of the tests: `cargo test --release -p CRATE NAME`.\n{BESIDE}")
}

pub fn run(arguments: Arguments) -> Result<()> {
    let words = arguments.words()?;
    let words = words.join(" ");
    ensure!(
        words.is_empty(),
        "to run some tests: `cargo test --release {words}`; to run a step: `cargo xtask ci {words}`"
    );
    let start = Instant::now();
    ensure!(STEP.command()?.status()?.success(), "a test failed; to repeat: {STEP}");
    println!("\nAll tests passed in {}. {BESIDE}", clock(start.elapsed()));
    Ok(())
}
