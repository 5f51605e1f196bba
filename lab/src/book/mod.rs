//! `cargo xtask book`: `docs/` as a book, which loads nothing from elsewhere.
//!
//! `lab/book` renders it, a package of its own for the sake of mdBook's dependencies. Here are the commands of the
//! chapters, which are run as a reader would.

mod browser;
mod commands;

use crate::app;
use anyhow::Result;
use std::path::{Path, PathBuf};
use xtask::lab;

/// Command line of `cargo xtask book`.
#[derive(clap::Args)]
pub struct BookArgs {
    /// Folder to write to; a folder that exists must hold a book, and is replaced
    #[arg(long, value_name = "DIR", default_value = "target/book/site")]
    out: PathBuf,
    /// Open pages in Chromium, and run the commands of the chapters
    #[arg(long)]
    check: bool,
    /// The program whose commands are run, instead of building it
    #[arg(long, value_name = "FILE", requires = "check")]
    program: Option<PathBuf>,
}

pub fn run(args: &BookArgs) -> Result<()> {
    make(&args.out)?;
    if args.check {
        browser::check(&args.out)?;
        let program = args.program.clone().map_or_else(app::program, Ok)?;
        commands::run(&std::path::absolute(program)?)?;
    }
    Ok(())
}

/// Renders the book into `out`, and follows its links.
fn make(out: &Path) -> Result<()> {
    lab::tool("book", [Path::new("."), out])
}
