//! `cargo xtask deny`: checks the dependencies against `deny.toml`: known vulnerabilities, abandoned crates, licences,
//! sources.

use anyhow::{Context, Result, ensure};
use std::process::Command;
use xtask::arguments::Arguments;
use xtask::tools;
use xtask::venv::done;

const VERSION: &str = "0.20.2";

pub const HELP: &str = "\
\x20 --advisories DIR  Take the advisories from DIR, a clone of https://github.com/RustSec/advisory-db

Builds cargo-deny once, below target/, and checks every lock file against deny.toml. If the database of advisories
cannot be fetched, the task says so and checks licences and sources only.";

/// The address of the advisories that cargo-deny uses by default.
const DATABASE: &str = "https://github.com/RustSec/advisory-db";

/// The manifests of the projects. Each project has its own lock file.
const PROJECTS: [&str; 4] = ["Cargo.toml", "firmware/Cargo.toml", "bindings/c/Cargo.toml", "lab/tools/Cargo.toml"];

pub fn run(mut arguments: Arguments) -> Result<()> {
    let handed_in = arguments.value("--advisories")?.map(database).transpose()?;
    arguments.end()?;
    let program = tools::of_cargo("cargo-deny", VERSION)?;
    let deny = || {
        let mut deny = Command::new(&program);
        deny.arg("deny").envs(handed_in.iter().flatten().cloned());
        deny
    };
    let advisories = deny().args(["--config", "deny.toml", "fetch", "db"]).status()?.success();
    ensure!(advisories || handed_in.is_none(), "the advisories that were handed in cannot be read");
    if !advisories {
        eprintln!(
            "SKIPPED: advisories: their database cannot be fetched (--advisories DIR takes a clone); licences and \
             sources are checked all the same"
        );
    }
    let wanted = ["licenses", "bans", "sources", "advisories"];
    for manifest in PROJECTS {
        println!("{manifest}:");
        let mut check = deny();
        check.args(["--manifest-path", manifest, "--workspace", "--config", "deny.toml"]);
        check.args(["check", "--hide-inclusion-graph"]);
        done(check.args(&wanted[..if advisories { 4 } else { 3 }]))?;
    }
    Ok(())
}

/// Environment variables that make git fetch the advisories from the clone in `directory`.
fn database(directory: String) -> Result<[(&'static str, String); 3]> {
    let directory = std::fs::canonicalize(&directory).with_context(|| format!("--advisories {directory}"))?;
    let mut newest = Command::new("git");
    newest.arg("-C").arg(&directory).args(["log", "-1", "--format=%cs", "--", "crates/*/RUSTSEC-*.md"]);
    let newest = newest.output().context("git")?;
    ensure!(
        newest.status.success() && !newest.stdout.is_empty(),
        "--advisories {}: this is not a clone of {DATABASE}",
        directory.display()
    );
    println!("advisories up to {}", String::from_utf8_lossy(&newest.stdout).trim());
    Ok([
        ("GIT_CONFIG_COUNT", "1".to_owned()),
        ("GIT_CONFIG_KEY_0", format!("url.file://{}.insteadOf", directory.display())),
        ("GIT_CONFIG_VALUE_0", DATABASE.to_owned()),
    ])
}
