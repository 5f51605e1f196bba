//! Python environments with stated packages below `target/`, and functions that run a command.

use anyhow::{Context, Result, ensure};
use std::path::PathBuf;
use std::process::Command;

/// The absolute path of the interpreter of the environment `target/venv-NAME` with everything in `requirements`. The
/// environment is made or updated if necessary.
pub fn python(name: &str, requirements: &str) -> Result<PathBuf> {
    let folder = std::path::absolute(format!("target/venv-{name}"))?;
    let python = folder.join("bin/python");
    if !python.exists() {
        done(Command::new("python3").args(["-m", "venv"]).arg(&folder))?;
    }
    done(Command::new(&python).args(["-m", "pip", "install", "--quiet", "--requirement", requirements]))?;
    Ok(python)
}

/// Runs a command to its end. Returns an error with the command unless it succeeds.
pub fn done(command: &mut Command) -> Result<()> {
    let status = command.status().with_context(|| format!("cannot start {command:?}"))?;
    ensure!(status.success(), "{command:?} ended with {status}");
    Ok(())
}

/// Runs a command and returns its stdout.
pub fn printed(command: &mut Command) -> Result<String> {
    let output = command.stderr(std::process::Stdio::inherit()).output();
    let output = output.with_context(|| format!("cannot start {command:?}"))?;
    ensure!(output.status.success(), "{command:?} ended with {}", output.status);
    Ok(String::from_utf8(output.stdout)?)
}
