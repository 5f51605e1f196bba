//! `cargo xtask deny`: the dependencies against `deny.toml`: known holes, abandoned crates, licences, sources.

use anyhow::Result;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::venv::done;

const VERSION: &str = "0.20.2";
const TOOLS: &str = "target/tools";

/// What `--help` prints.
pub const HELP: &str = "\
Builds cargo-deny once, below target/, and holds every lock file against deny.toml. Where the database of advisories
cannot be fetched, it says so, and checks licences and sources only.";

/// Each project has a lock file of its own.
const PROJECTS: [&str; 4] = ["Cargo.toml", "firmware/Cargo.toml", "bindings/c/Cargo.toml", "lab/Cargo.toml"];

/// Runs all checks that need no network, and the advisories if their database is available.
pub fn run(arguments: Arguments) -> Result<()> {
    arguments.end()?;
    let program = program()?;
    let advisories = Command::new(&program).args(["deny", "fetch", "db"]).status()?.success();
    if !advisories {
        eprintln!(
            "SKIPPED: advisories: their database cannot be fetched; licences and sources are checked all the same"
        );
    }
    let wanted = ["licenses", "bans", "sources", "advisories"];
    for manifest in PROJECTS {
        println!("{manifest}:");
        let mut check = Command::new(&program);
        check.args(["deny", "--manifest-path", manifest, "--workspace", "--config", "deny.toml"]);
        check.args(["check", "--hide-inclusion-graph"]);
        done(check.args(&wanted[..if advisories { 4 } else { 3 }]))?;
    }
    Ok(())
}

/// cargo-deny in this version: the one below `target/`, which is built once.
fn program() -> Result<PathBuf> {
    let program = std::path::absolute(Path::new(TOOLS).join("bin/cargo-deny"))?;
    if !program.exists() {
        println!("cargo-deny {VERSION} is built, once");
        let install =
            ["install", "cargo-deny", "--version", VERSION, "--locked", "--quiet", "--debug", "--root", TOOLS];
        done(Command::new("cargo").args(install))?;
    }
    Ok(program)
}
