//! The tasks in `lab/`, which is built when one of them is called, and the tools in `lab/tools`.

use crate::app::{built, target_folder};
use crate::venv::done;
use anyhow::Result;
use std::ffi::OsStr;
use std::path::PathBuf;
use std::process::Command;

/// The tasks, each with a description. A test of the lab compares this table with the lab's command line.
pub const TASKS: [(&str, &str); 20] = [
    ("coverage", "Calibrate many units of the twin and compare the stated uncertainties with their truth"),
    ("methods", "Calibrate many units by every method, compare all with their truth, and write the page"),
    ("tracking", "Track many units of the twin for a day in four worlds, and print the table of docs/tracking.md"),
    ("coverage-allan", "Simulate records at rest and compare the fitted noise coefficients with their truth"),
    ("coverage-tempcal", "Simulate logs of gyroscopes that warm, and compare their curves with the truth"),
    ("bench-peers", "Time the Allan deviation beside its peers, which it installs, and print ratios"),
    ("bench-serve", "Serve the twin to 20 pages and 4 clients of libiio while it is recorded, and print the cost"),
    ("bench-web", "Time the core in WebAssembly beside the program, and the page's first picture"),
    ("firmware", "Run driver, twin and correction on an emulated Cortex-M4F; count instructions and bytes"),
    ("bridge", "Read the twin through a bridge's firmware in an emulator, by socket and by serial port"),
    ("c", "Check the C interface: library, and C against Rust on the host and on an emulated Cortex-M4F"),
    ("iiod", "Read the libiio server with libiio's own clients, and with pyadi-iio"),
    ("rig", "Boot a stock Linux kernel in QEMU with the twin as hardware, and read it there"),
    ("twin-usb", "Plug the twin into a virtual machine, as an SPI and GPIO adapter on its USB port"),
    ("trust", "Break part, files and program at random moments; look for results that are wrong and silent"),
    ("attacks", "Turn other projects' attacks and test files on the program: HTTP, WebSocket, libiio, logs"),
    ("endurance", "Serve for long while visitors come and go; set the clock by an hour; fill the disk and free it"),
    ("proofs", "Look for undefined behaviour and data races: Miri, the sanitizers, valgrind"),
    ("book", "Render docs/ as a book, run its commands and follow its links"),
    ("dist", "Make the distribution in target/dist: programs, packages, wheels, libraries, firmware"),
];

/// Builds the lab and returns the command that runs a task, without the arguments of the task.
pub fn task(name: &str) -> Result<Command> {
    let mut command = Command::new(built("lab")?);
    command.arg(name);
    Ok(command)
}

/// `cargo ACTION` on a package of `lab/tools`, a workspace of its own with its own target folder.
pub fn cargo(action: &str, package: &str, profile: &str) -> Result<Command> {
    let mut cargo = Command::new("cargo");
    cargo.args([action, "--locked", "--manifest-path", "lab/tools/Cargo.toml", "--package", package]);
    cargo.args(["--profile", profile, "--target-dir"]).arg(folder()?);
    Ok(cargo)
}

/// Runs a tool of `lab/tools`. The tool runs for seconds only, and is therefore built without optimisation.
pub fn tool<T: AsRef<OsStr>>(package: &str, arguments: impl IntoIterator<Item = T>) -> Result<()> {
    let mut command = cargo("run", package, "dev")?;
    done(command.args(["--quiet", "--"]).args(arguments))
}

/// The target folder of `lab/tools`, inside the project's target folder, so that one folder holds all builds.
pub fn folder() -> Result<PathBuf> {
    Ok(target_folder()?.join("tools"))
}
