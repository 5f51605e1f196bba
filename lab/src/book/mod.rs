//! `cargo xtask book`: makes a book of `docs/` that loads nothing from other sites.
//!
//! `lab/tools/book` renders the book. That tool is a separate package because of mdBook's dependencies. With
//! `--check`, this module opens pages in a browser, and runs the commands of the chapters as a reader would.

mod browser;
mod commands;

use crate::app;
use crate::venv::printed;
use anyhow::Result;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::lab;

#[derive(clap::Args)]
pub struct BookArgs {
    /// Folder to write to; a folder that exists must hold a book, and is replaced
    #[arg(long, value_name = "DIR", default_value = "target/book/site")]
    out: PathBuf,
    /// Open pages in Chromium, and run the commands of the chapters
    #[arg(long)]
    check: bool,
    /// The program whose commands are shown and run, instead of building it
    #[arg(long, value_name = "FILE")]
    program: Option<PathBuf>,
}

pub fn run(args: &BookArgs) -> Result<()> {
    let program = app::given_or_built(args.program.as_deref())?;
    make(&args.out, &program)?;
    if args.check {
        browser::check(&args.out)?;
        commands::run(&program)?;
    }
    Ok(())
}

/// Renders the book into `out`, with a reference of all commands and options of `program`, and checks its links.
fn make(out: &Path, program: &Path) -> Result<()> {
    let commands = tempfile::NamedTempFile::new()?;
    fs::write(&commands, printed(Command::new(program).args(["man", "--markdown"]))?)?;
    lab::tool("book", [Path::new("."), out, commands.path()])
}
