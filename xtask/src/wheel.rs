//! The wheel of the Python package, in an environment of its own below `target/`.

use crate::venv::{self, done};
use anyhow::{Context, Result};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const REQUIREMENTS: &str = "bindings/python/requirements-test.txt";
const WHEELS: &str = "target/wheels-test";

/// The interpreter with the packages for the tests of `cargo xtask ci`, or the reason why this machine has none.
pub fn environment() -> Result<Result<PathBuf, &'static str>> {
    let has_venv = Command::new("python3").args(["-m", "venv", "--help"]).stdout(Stdio::null()).status();
    if !has_venv.is_ok_and(|status| status.success()) {
        return Ok(Err("python3 with venv is missing (apt install python3-venv)"));
    }
    match venv::python("wheel", REQUIREMENTS) {
        Ok(python) => Ok(Ok(python)),
        Err(_) if !reaches_registry() => Ok(Err("pip reaches no package registry")),
        Err(error) => Err(error),
    }
}

fn reaches_registry() -> bool {
    let mut probe = Command::new("target/venv-wheel/bin/python");
    probe.args(["-m", "pip", "download", "--quiet", "--no-deps", "--dest", "target/probe", "pip"]);
    probe.status().is_ok_and(|status| status.success())
}

/// Builds the wheel with the maturin of the environment of `python`. The build reuses what the tests with
/// `zerorate-cli/full` have compiled.
pub fn build(python: &Path) -> Result<PathBuf> {
    if Path::new(WHEELS).is_dir() {
        fs::remove_dir_all(WHEELS).context("clearing the old wheel")?;
    }
    let mut build = Command::new(python);
    build.args(["-m", "maturin", "build", "--quiet", "--release", "--out", WHEELS]);
    done(build.args(["--manifest-path", "bindings/python/Cargo.toml", "--interpreter"]).arg(python))?;
    Ok(fs::read_dir(WHEELS)?.next().context("maturin built no wheel")??.path())
}

/// Installs a wheel, or the package in a folder, into an environment that has its dependencies.
pub fn install_into(python: &Path, package: &Path) -> Result<()> {
    let mut install = Command::new(python);
    done(install.args(["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"]).arg(package))
}
