//! Rust targets for the builds for microcontrollers and for browsers.

use std::collections::BTreeSet;
use std::io::ErrorKind;
use std::process::{Command, Stdio};

use anyhow::{Context, Result, bail, ensure};

/// Adds each of `wanted` that the active toolchain lacks, and prints its name.
pub fn add_missing(wanted: impl Iterator<Item = &'static str>) -> Result<()> {
    let wanted: BTreeSet<_> = wanted.collect();
    if wanted.is_empty() {
        return Ok(());
    }
    let installed = rustup(&["target", "list", "--installed"])?;
    for target in wanted {
        if !installed.lines().any(|line| line == target) {
            println!("Rust target {target} is missing: adding it with `rustup target add {target}`");
            rustup(&["target", "add", target])?;
        }
    }
    Ok(())
}

/// Runs rustup and returns what it printed on stdout; its stderr goes to the terminal.
fn rustup(args: &[&str]) -> Result<String> {
    let command = format!("rustup {}", args.join(" "));
    let output = match Command::new("rustup").args(args).stderr(Stdio::inherit()).output() {
        Ok(output) => output,
        Err(e) if e.kind() == ErrorKind::NotFound => bail!(
            "rustup was not found, and the no_std builds get their targets from it: \
             install it from https://rustup.rs and run this command again"
        ),
        Err(e) => return Err(e).context(command),
    };
    ensure!(output.status.success(), "`{command}` failed ({}): see its message above", output.status);
    String::from_utf8(output.stdout).context(command)
}
