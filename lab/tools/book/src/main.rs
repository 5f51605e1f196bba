//! Makes the book from `docs/`: `book ROOT OUT COMMANDS`. `cargo xtask book` calls this program. COMMANDS is a file
//! with the reference of the commands of `zerorate`.
//!
//! This program stages the chapters and lets mdBook render them. It moves the scripts from the pages to files, so that
//! a content security policy can forbid inline code. Then it follows every link.

mod links;
mod policy;
mod stage;

use anyhow::{Context, Result, bail};
use mdbook_driver::MDBook;
use mdbook_driver::config::Config;
use std::fs;
use std::path::{Path, PathBuf};

fn main() -> Result<()> {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let [root, out, commands] = arguments.as_slice() else {
        bail!("book ROOT OUT COMMANDS: the project, a folder for the book, and the commands in Markdown")
    };
    let out = std::path::absolute(out)?;
    let staged = tempfile::tempdir()?;
    stage::fill(root, staged.path(), &fs::read_to_string(commands)?)?;
    render(root, staged.path(), &out)?;
    let pages = policy::apply(&out)?;
    links::check(&out, &pages)?;
    println!("{}: {} pages", out.display(), pages.len());
    Ok(())
}

fn render(root: &Path, staged: &Path, out: &Path) -> Result<()> {
    let mut config = Config::from_disk(root.join("docs/book.toml"))?;
    config.book.src = PathBuf::from(".");
    config.build.build_dir = out.to_owned();
    config.build.create_missing = false;
    if out.exists() {
        ours(out)?;
        fs::remove_dir_all(out).with_context(|| format!("cannot clear {}", out.display()))?;
    }
    MDBook::load_with_config(staged, config)?.build()
}

/// Checks that the output folder is empty or contains a book, since a book may only replace a book.
fn ours(out: &Path) -> Result<()> {
    let is_ours = out.join("toc.html").exists() || fs::read_dir(out)?.next().is_none();
    is_ours.then_some(()).with_context(|| format!("{} exists and is not a book; it was not touched", out.display()))
}
