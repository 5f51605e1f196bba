//! `cargo xtask python`: builds the wheel, installs it into an environment of its own below `target/`, and tests it
//! there.
//!
//! The wheel takes over what the step `test-full` of `cargo xtask ci` has compiled.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use xtask::app;
use xtask::arguments::Arguments;
use xtask::tools::{self, Tool};
use xtask::venv::{self, done};

/// A part, given the interpreter of the environment.
type Part = fn(&Path) -> Result<()>;

const PARTS: [(&str, Part); 3] = [("tests", tests), ("notebook", notebook), ("allantools", allantools)];

const PACKAGE: &str = "bindings/python";
const REQUIREMENTS: &str = "bindings/python/requirements-test.txt";
const WHEELS: &str = "target/wheels-test";

/// What the tests of certificates, of the line and of the fleet need beside Python.
const TOOLS: [Tool; 3] = [
    Tool { program: "pango-view", package: "pango1.0-tools" },
    Tool { program: "psql", package: "postgresql" },
    Tool { program: "pgrep", package: "procps" },
];

/// The release whose tests the functions of `zerorate.allantools_compat` pass.
const ALLANTOOLS: &str = "2024.6";

/// What `--help` prints behind the parts.
const ABOUT: &str = "\
Makes an environment below target/, builds the wheel into it, and runs its tests, the type checkers, the notebook, and
allantools' own tests against our functions. Where python3 or the package registry is missing, it says so and passes.";

pub fn help() -> String {
    format!("{}\n\n{ABOUT}", parts())
}

/// What `cargo xtask bench-fleet --help` prints.
pub const BENCH_HELP: &str = "\
Times 200 captures through zerorate.fleet, by threads and by Dask, beside a plain loop of the same commands, and prints
ratios, the cost of a file, and the memory of an hour. --captures N takes another number.";

/// Runs the benchmark of the fleet with the wheel and the program.
pub fn bench_fleet(mut arguments: Arguments) -> Result<()> {
    let captures = arguments.value("--captures")?.unwrap_or_else(|| "200".to_owned());
    arguments.end()?;
    let python = environment()?.map_err(anyhow::Error::msg)?;
    install_wheel(&python)?;
    let program = fs::canonicalize(app::program()?)?;
    let mut bench = Command::new(&python);
    done(bench.arg("benches/fleet.py").arg(program).args(["--captures", &captures]).current_dir(PACKAGE))
}

/// The names of the parts, for help and errors.
fn parts() -> String {
    format!("parts: {}; without one, all", PARTS.map(|(name, _)| name).join(", "))
}

/// Builds, installs, tests. Without Python or a package registry it says so and passes.
pub fn run(arguments: Arguments) -> Result<()> {
    let only = arguments.words()?;
    for part in &only {
        ensure!(PARTS.iter().any(|(name, _)| name == part), "unknown part {part}; {}", parts());
    }
    let python = match environment()? {
        Ok(python) => python,
        Err(why) => {
            println!("SKIPPED: the Python package was not tested: {why}");
            return Ok(());
        }
    };
    tools::available(&TOOLS, "the tests of certificate, line and fleet")?;
    install_wheel(&python)?;
    for (name, part) in PARTS {
        if only.is_empty() || only.iter().any(|only| only == name) {
            println!("--- {name}");
            part(&python).with_context(|| format!("{name}; to repeat it alone: cargo xtask python {name}"))?;
        }
    }
    Ok(())
}

/// The interpreter with the tests' packages, or the reason outside our control why there is none.
fn environment() -> Result<Result<PathBuf, &'static str>> {
    let has_venv = Command::new("python3").args(["-m", "venv", "--help"]).stdout(Stdio::null()).status();
    if !has_venv.is_ok_and(|status| status.success()) {
        return Ok(Err("python3 with venv is missing (apt install python3-venv)"));
    }
    match venv::python("wheel", Path::new(REQUIREMENTS)) {
        Ok(python) => Ok(Ok(fs::canonicalize("target")?.join(python.strip_prefix("target")?))),
        Err(_) if !reaches_registry() => Ok(Err("pip reaches no package registry")),
        Err(error) => Err(error),
    }
}

fn reaches_registry() -> bool {
    let mut probe = Command::new("target/venv-wheel/bin/python");
    probe.args(["-m", "pip", "download", "--quiet", "--no-deps", "--dest", "target/probe", "pip"]);
    probe.status().is_ok_and(|status| status.success())
}

fn install_wheel(python: &Path) -> Result<()> {
    if Path::new(WHEELS).is_dir() {
        fs::remove_dir_all(WHEELS).context("clearing the old wheel")?;
    }
    let mut build = Command::new(python);
    build.args(["-m", "maturin", "build", "--quiet", "--release", "--out", WHEELS]);
    done(build.args(["--manifest-path", "bindings/python/Cargo.toml", "--interpreter"]).arg(python))?;
    let wheel = fs::read_dir(WHEELS)?.next().context("maturin built no wheel")??.path();
    let mut install = Command::new(python);
    done(install.args(["-m", "pip", "install", "--quiet", "--force-reinstall", "--no-deps"]).arg(wheel))
}

/// Our tests, with the type checkers in them.
fn tests(python: &Path) -> Result<()> {
    done(Command::new(python).args(["-m", "pytest", "-q", "--durations=5"]).current_dir(PACKAGE))
}

/// The examples, executed.
fn notebook(python: &Path) -> Result<()> {
    done(Command::new(python).args(["-m", "pytest", "-q", "--nbmake", "examples"]).current_dir(PACKAGE))
}

/// allantools' own tests, against our functions of the same names. Its files stay outside of the repository.
fn allantools(python: &Path) -> Result<()> {
    let source = format!("target/allantools-{ALLANTOOLS}");
    if !Path::new(&source).is_dir() {
        let mut download = Command::new(python);
        download.args(["-m", "pip", "download", "--quiet", "--no-binary", ":all:", "--no-deps", "--dest", "target"]);
        done(download.arg(format!("allantools=={ALLANTOOLS}")))?;
        done(Command::new(python).args(["-m", "tarfile", "-e", &format!("{source}.tar.gz"), "target"]))?;
    }
    done(Command::new(python).args(["bindings/python/tests/allantools_suite.py", &source]))
}
