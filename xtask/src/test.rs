//! `cargo xtask test`: the tests of the project, by `cargo test --release` and nothing else.

use crate::steps::{Step, clock};
use anyhow::{Result, ensure};
use std::time::Instant;
use xtask::arguments::Arguments;

/// All crates with their default features, including documentation tests. The profile is that of the README's first
/// command, which has built the dependencies by then.
const STEP: Step = Step::new("test", "test --release").about("The tests of the crates with their default features");

pub const WHOLE_STEP: Step =
    Step::new("test", "xtask test --full").about("All tests of the workspace, with all features of the program");

/// The tests of the whole workspace, in the build of [`xtask::app::WHOLE`].
const WHOLE: Step = Step::new(
    "test",
    "test --release --workspace --exclude xtask --features zerorate-cli/full,zerorate-web/readers --locked",
);

const BESIDE: &str = "`cargo xtask check` looks at format, lints, links and bare targets;\n`cargo xtask ci` does all \
                      this and tests C, Python, the page, the bridge and the book.";

pub fn help() -> String {
    format!(
        "  --full  Test the whole workspace with all features of the program, as `cargo xtask ci` does\n\n\
         This is `{STEP}`; with --full,\n`{WHOLE}`.\n\
         Cargo itself runs some of the tests: `cargo test --release -p CRATE NAME`.\n{BESIDE}\n\n\
         Some tests compare with published reference data that this repository may not carry. They look in \
         ../shared/data,\nor where ZERORATE_REFERENCE_DATA points to. Where the data is missing, they print that they \
         were skipped."
    )
}

pub fn run(mut arguments: Arguments) -> Result<()> {
    let step = if arguments.flag("--full") { WHOLE } else { STEP };
    let words = arguments.words()?.join(" ");
    ensure!(
        words.is_empty(),
        "to run some tests: `cargo test --release {words}`; to run a step: `cargo xtask ci {words}`"
    );
    let start = Instant::now();
    ensure!(step.command()?.status()?.success(), "a test failed; to repeat: {step}");
    println!("\nAll tests passed in {}. {BESIDE}", clock(start.elapsed()));
    Ok(())
}
