//! `cargo xtask book`: `docs/` as a book, which loads nothing from elsewhere.
//!
//! `xtask/book` renders it, a package of its own for the sake of mdBook's dependencies. Here are the chapters that are
//! made rather than written, the drawings, and the commands, which are run as a reader would.

mod browser;
mod commands;
mod drawings;
mod spectrum;

use crate::app;
use crate::venv::done;
use anyhow::{Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use zerorate_view::codes;

/// Command line of `cargo xtask book`.
#[derive(clap::Args)]
pub struct Args {
    /// Where to; what is there must be a book, and is replaced
    #[arg(long, value_name = "DIR", default_value = "target/book/site")]
    out: PathBuf,
    /// Write what is made rather than written: docs/codes.md, drawings, the spectrum
    #[arg(long)]
    update: bool,
    /// Open pages in Chromium, run the commands of the chapters, and check what is made
    #[arg(long, conflicts_with = "update")]
    check: bool,
    /// The program whose commands are run, instead of building it
    #[arg(long, value_name = "FILE", requires = "check")]
    program: Option<PathBuf>,
}

pub fn run(args: &Args) -> Result<()> {
    for (path, text) in made()? {
        if args.update {
            fs::write(path, text)?;
        } else if args.check {
            let stands = fs::read_to_string(path).unwrap_or_default();
            ensure!(stands == text, "{path} is not what is made today: cargo xtask book --update");
        }
    }
    make(&args.out)?;
    if args.check {
        browser::check(&args.out)?;
        let program = args.program.clone().map_or_else(app::program, Ok)?;
        commands::run(&std::path::absolute(program)?)?;
    }
    Ok(())
}

/// Renders the book into `out`, and follows its links.
pub fn make(out: &Path) -> Result<()> {
    let target = app::target_folder()?.join("book");
    let mut cargo = Command::new("cargo");
    cargo.args(["run", "--quiet", "--locked", "--manifest-path", "xtask/book/Cargo.toml", "--target-dir"]);
    done(cargo.arg(target).args(["--", "."]).arg(out))
}

/// Files of the book that are made, each with its text.
fn made() -> Result<Vec<(&'static str, String)>> {
    let facts = fs::read_to_string("docs/facts.md")?;
    let beside = [("docs/codes.md", codes::page()), ("docs/pictures/spectrum.svg", spectrum::draw()?)];
    Ok(drawings::all(&facts)?.into_iter().chain(beside).collect())
}
