//! `cargo xtask python`: builds the wheel, installs it into an environment of its own below `target/`, and tests it
//! there.
//!
//! The wheel takes over what the step `test-full` of `cargo xtask ci` has compiled.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::Path;
use std::process::Command;
use xtask::app;
use xtask::arguments::Arguments;
use xtask::tools::{self, Tool};
use xtask::venv::done;
use xtask::wheel;

/// A part, given the interpreter of the environment.
type Part = fn(&Path) -> Result<()>;

const PARTS: [(&str, Part); 3] = [("tests", tests), ("notebook", notebook), ("allantools", allantools)];

const PACKAGE: &str = "bindings/python";

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
    let python = wheel::environment()?.map_err(anyhow::Error::msg)?;
    wheel::install(&python)?;
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
    let python = match wheel::environment()? {
        Ok(python) => python,
        Err(why) => {
            println!("SKIPPED: the Python package was not tested: {why}");
            return Ok(());
        }
    };
    tools::available(&TOOLS, "the tests of certificate, line and fleet")?;
    wheel::install(&python)?;
    for (name, part) in PARTS {
        if only.is_empty() || only.iter().any(|only| only == name) {
            println!("--- {name}");
            part(&python).with_context(|| format!("{name}; to repeat it alone: cargo xtask python {name}"))?;
        }
    }
    Ok(())
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
