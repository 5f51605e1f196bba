//! `cargo xtask codegen`: writes files that are generated from other sources of the project.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::venv::{done, printed};
use xtask::{app, lab};

pub const HELP: &str = "\
\x20 --check  Write nothing, and fail if a file is out of date

The files are bindings/c/include/zerorate.h, firmware/examples/src/unit.rs, and bandwidth.svg and spectrum.svg in
docs/pictures/. ARCHITECTURE.md names the tasks that write other generated files.";

/// The C header. `lab/tools/header` prints its text.
const HEADER: &str = "bindings/c/include/zerorate.h";

pub fn run(mut arguments: Arguments) -> Result<()> {
    let check = arguments.flag("--check");
    arguments.end()?;
    header(check).context(HEADER)?;
    done(Command::new(app::built("codegen")?).args(check.then_some("--check"))).context("generated files")
}

fn header(check: bool) -> Result<()> {
    let text = printed(lab::cargo("run", "header", "dev")?.arg("--quiet"))?;
    if fs::read_to_string(HEADER).is_ok_and(|there| there == text) {
        return Ok(());
    }
    ensure!(!check, "it is out of date; `cargo xtask codegen` writes it");
    fs::write(HEADER, text)?;
    println!("{HEADER}: written");
    Ok(())
}
