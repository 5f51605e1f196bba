//! `cargo xtask python`: builds the wheel, installs it into an environment below `target/`, and tests it there.

use anyhow::{Context, Result, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use xtask::app;
use xtask::arguments::Arguments;
use xtask::images::{self, QEMU};
use xtask::tools::{self, Tool};
use xtask::venv::{self, done};
use xtask::wheel;

type Part = fn(&Wheel) -> Result<()>;

/// The parts: name, description, function. The first one runs if none is named.
const PARTS: [(&str, &str, Part); 6] = [
    ("tests", "Its tests, with the type checkers", tests),
    ("stores", "The fleet on an object store and on Dask", stores),
    ("notebook", "The examples", notebook),
    ("allantools", "The tests of allantools, on our functions", allantools),
    ("certificate", "The tests of extras/zerorate-certificate", certificate),
    ("bridge", "Its tests at a bridge in an emulator", bridge),
];

/// The wheel, and the interpreter of the environment in which it was built.
struct Wheel {
    python: PathBuf,
    path: PathBuf,
}

const PACKAGE: &str = "bindings/python";
const CERTIFICATE: &str = "extras/zerorate-certificate";

/// Debian's package of this tool also installs the libraries that turn a certificate into a PDF.
const PANGO: Tool = Tool { program: "pango-view", package: "pango1.0-tools" };

/// The release of allantools whose tests `zerorate.allantools_compat` must pass.
const ALLANTOOLS: &str = "2024.6";

pub fn help() -> String {
    format!(
        "Parts ({} if none is named):\n{}\nWithout python3 or the package registry, the task says so and passes.",
        PARTS[0].0,
        PARTS.map(|(name, about, _)| format!("  {name:11}  {about}\n")).concat()
    )
}

pub const BENCH_HELP: &str = "\
\x20 --captures N  Number of captures, 200 by default

Times threads, Dask, and a plain loop of the same commands. Also prints the cost of a file and the memory of an hour.";

pub fn bench_fleet(mut arguments: Arguments) -> Result<()> {
    let captures = arguments.value("--captures")?.unwrap_or_else(|| "200".to_owned());
    arguments.end()?;
    let python = wheel::environment()?.map_err(anyhow::Error::msg)?;
    let path = wheel::build(&python)?;
    let python = night(&Wheel { python, path })?;
    let program = fs::canonicalize(app::program()?)?;
    let mut bench = Command::new(&python);
    done(bench.arg("benches/fleet.py").arg(program).args(["--captures", &captures]).current_dir(PACKAGE))
}

pub fn run(arguments: Arguments) -> Result<()> {
    let mut only = arguments.words()?;
    if only.is_empty() {
        only.push(PARTS[0].0.to_owned());
    }
    for part in &only {
        ensure!(PARTS.iter().any(|(name, ..)| name == part), "unknown part {part}; --help lists the parts");
    }
    let python = match wheel::environment()? {
        Ok(python) => python,
        Err(why) => {
            println!("SKIPPED: the Python package was not tested: {why}");
            return Ok(());
        }
    };
    let wheel = Wheel { path: wheel::build(&python)?, python };
    for (name, _, part) in PARTS {
        if only.iter().any(|only| only == name) {
            println!("--- {name}");
            part(&wheel).with_context(|| format!("{name}; to repeat it alone: cargo xtask python {name}"))?;
        }
    }
    Ok(())
}

fn tests(wheel: &Wheel) -> Result<()> {
    wheel::install_into(&wheel.python, &wheel.path)?;
    pytest(&wheel.python, PACKAGE, &["--durations=5"])
}

fn stores(wheel: &Wheel) -> Result<()> {
    pytest(&night(wheel)?, PACKAGE, &["-m", "stores"])
}

fn notebook(wheel: &Wheel) -> Result<()> {
    pytest(&night(wheel)?, PACKAGE, &["--nbmake", "examples"])
}

/// Compares the package with allantools, and runs allantools' own tests on it. Their source stays in `target/`.
fn allantools(wheel: &Wheel) -> Result<()> {
    let python = &night(wheel)?;
    pytest(python, PACKAGE, &["-m", "allantools"])?;
    let source = format!("target/allantools-{ALLANTOOLS}");
    if !Path::new(&source).is_dir() {
        let mut download = Command::new(python);
        download.args(["-m", "pip", "download", "--quiet", "--no-binary", ":all:", "--no-deps", "--dest", "target"]);
        done(download.arg(format!("allantools=={ALLANTOOLS}")))?;
        done(Command::new(python).args(["-m", "tarfile", "-e", &format!("{source}.tar.gz"), "target"]))?;
    }
    done(Command::new(python).args(["bindings/python/tests/allantools_suite.py", &source]))
}

fn certificate(wheel: &Wheel) -> Result<()> {
    if !tools::available(&[PANGO], "the tests of certificates")? {
        return Ok(());
    }
    let python = venv::python("certificate", &format!("{CERTIFICATE}/requirements-test.txt"))?;
    wheel::install_into(&python, &wheel.path)?;
    wheel::install_into(&python, Path::new(CERTIFICATE))?;
    pytest(&python, CERTIFICATE, &["--durations=5"])
}

fn bridge(wheel: &Wheel) -> Result<()> {
    if !tools::available(&[QEMU], "the Python package at a bridge")? {
        return Ok(());
    }
    wheel::install_into(&wheel.python, &wheel.path)?;
    let image = images::build("release", "bridge")?;
    let mut pytest = Command::new(&wheel.python);
    pytest.args(["-m", "pytest", "-q", "-m", "bridge"]).env("ZERORATE_BRIDGE", image);
    done(pytest.current_dir(PACKAGE))
}

/// Prepares the Python environment for `stores`, `notebook`, `allantools` and the benchmark of the fleet: the packages
/// of requirements-night.txt, and the wheel.
fn night(wheel: &Wheel) -> Result<PathBuf> {
    let python = venv::python("wheel-night", &format!("{PACKAGE}/requirements-night.txt"))?;
    wheel::install_into(&python, &wheel.path)?;
    Ok(python)
}

fn pytest(python: &Path, folder: &str, arguments: &[&str]) -> Result<()> {
    done(Command::new(python).args(["-m", "pytest", "-q"]).args(arguments).current_dir(folder))
}
