//! Programs that a task needs beside the Rust toolchain.

use crate::venv::done;
use anyhow::Result;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// A program, and the Debian package that has it.
#[derive(Clone, Copy)]
pub struct Tool {
    /// Name of the executable, which is searched in PATH.
    pub program: &'static str,
    /// Debian's name of the package.
    pub package: &'static str,
}

/// True if all `tools` are available. On Debian as root, missing ones are installed. Elsewhere stderr names them, with
/// the command that installs them, and the caller skips its work.
pub fn available(tools: &[Tool], purpose: &str) -> Result<bool> {
    let missing: Vec<&str> = tools.iter().filter(|tool| !runs(tool.program)).map(|tool| tool.package).collect();
    installed(&missing, purpose)
}

/// Like [`available`], for the library `file` that clang links.
pub fn of_clang_available(file: &str, package: &str, purpose: &str) -> Result<bool> {
    // clang prints the whole path of a file that it finds
    let found = Command::new("clang").arg(format!("-print-file-name={file}")).output()?.stdout;
    if found.starts_with(b"/") { Ok(true) } else { installed(&[package], purpose) }
}

/// Like [`available`], for a module of Debian's Python.
pub fn module_available(module: &str, package: &str, purpose: &str) -> Result<bool> {
    let import = Command::new(DEBIAN_PYTHON).args(["-c", &format!("import {module}")]).stderr(Stdio::null()).status();
    let is_there = import.is_ok_and(|status| status.success());
    if is_there { Ok(true) } else { installed(&[package], purpose) }
}

/// The Python for which Debian packages its modules.
const DEBIAN_PYTHON: &str = "/usr/bin/python3";

/// Installs the missing packages on Debian as root. Elsewhere names them on stderr and returns false.
fn installed(missing: &[&str], purpose: &str) -> Result<bool> {
    if missing.is_empty() {
        return Ok(true);
    }
    let packages = missing.join(" ");
    if !(Path::new("/etc/debian_version").exists() && is_root()) {
        eprintln!("SKIPPED: {purpose}: not installed: {packages} (sudo apt-get install {packages})");
        return Ok(false);
    }
    eprintln!("{purpose}: installing {packages} with apt-get");
    done(apt_get().args(["update", "-qq"]))?;
    done(apt_get().args(["install", "-y", "-qq"]).args(missing))?;
    Ok(true)
}

fn apt_get() -> Command {
    let mut command = Command::new("apt-get");
    command.env("DEBIAN_FRONTEND", "noninteractive");
    command
}

/// True if a program can be started. Its exit code does not count, because not every program knows `--version`.
fn runs(program: &str) -> bool {
    Command::new(program).arg("--version").stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok()
}

/// True if this process runs as root, and so may install packages.
pub fn is_root() -> bool {
    Command::new("id").arg("-u").output().is_ok_and(|output| output.stdout == b"0\n")
}

/// The path of a cargo subcommand in this version. The subcommand is built once, below `target/`.
pub fn of_cargo(name: &str, version: &str) -> Result<PathBuf> {
    let tools = Path::new("target/tools").join(format!("{name}-{version}"));
    let program = std::path::absolute(tools.join("bin").join(name))?;
    if !program.exists() {
        println!("{name} {version} is built, once");
        let install = ["install", name, "--version", version, "--locked", "--quiet", "--debug", "--root"];
        done(Command::new("cargo").args(install).arg(&tools))?;
    }
    Ok(program)
}
