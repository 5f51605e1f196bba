//! The Python package as wheels, for any Linux with glibc 2.17 or newer and Python 3.9 or newer.
//!
//! zig, from PyPI, compiles and links for that old glibc, including the C code inside crates.

use super::{Folder, VERSION, python, without_paths};
use crate::targets;
use crate::tools::{Tool, available};
use crate::venv::{done, printed};
use anyhow::{Context, Result, ensure};
use std::process::Command;

/// Cargo's target folder for the wheels. The folder of the program is not used, because the compiler flags differ.
const TARGET_DIR: &str = "target/wheels";
/// The target name in Rust, and the machine name in a wheel's file name.
const MACHINES: [(&str, &str); 2] = [("x86_64-unknown-linux-gnu", "x86_64"), ("aarch64-unknown-linux-gnu", "aarch64")];

fn name(machine: &str) -> String {
    format!("zerorate-{VERSION}-cp39-abi3-manylinux2014_{machine}.manylinux_2_17_{machine}.whl")
}

pub fn make(folder: &Folder) -> Result<()> {
    targets::add_missing(MACHINES.iter().map(|(target, _)| *target))?;
    for (target, machine) in MACHINES {
        let python = python()?;
        let programs = python.parent().context("an interpreter lies in a folder")?;
        let path = std::env::var("PATH").unwrap_or_default();
        let mut maturin = Command::new(&python);
        // the path where maturin finds zig
        maturin.env("PATH", format!("{}:{path}", programs.display())).env("RUSTFLAGS", without_paths()?);
        maturin.args(["-m", "maturin", "build", "--quiet", "--locked", "--zig", "--profile", "dist"]);
        maturin.args(["--compatibility", "manylinux2014", "--manifest-path", "bindings/python/Cargo.toml"]);
        maturin.args(["--target", target, "--target-dir", TARGET_DIR, "--out"]).arg(&folder.dist);
        done(maturin.env("SOURCE_DATE_EPOCH", &folder.epoch))?;
        let wheel = folder.of(name(machine));
        let bytes = wheel.metadata().context("maturin named it otherwise")?.len();
        println!("{}: {:.1} MB", name(machine), bytes as f64 / 1e6);
    }
    Ok(())
}

/// Tests this computer's wheel in an empty environment, and the other one under an emulator with Debian's Python.
pub fn check(folder: &Folder) -> Result<()> {
    let here = folder.empty("wheel")?;
    done(Command::new("python3").args(["-m", "venv"]).arg(&here))?;
    let python = here.join("bin/python");
    done(Command::new(&python).args(["-m", "pip", "install", "--quiet"]).arg(folder.of(name(MACHINES[0].1))))?;
    let ours = printed(Command::new(&python).args(["-c", USED]).current_dir(&here))?;
    ensure!(ours.starts_with(VERSION), "the wheel says {ours}");
    let version = printed(Command::new(here.join("bin/zerorate")).arg("--version"))?;
    ensure!(version.contains(VERSION), "the tool in the wheel says {version}");
    println!("{}: used in an empty environment", name(MACHINES[0].1));
    let Some(theirs) = emulated(folder)? else { return Ok(()) };
    ensure!(theirs == ours, "the wheel for {} says {theirs}, not {ours}", MACHINES[1].1);
    println!("{}: the same under an emulator", name(MACHINES[1].1));
    Ok(())
}

const TOOLS: [Tool; 2] = [
    Tool { program: "mmdebstrap", package: "mmdebstrap" },
    Tool { program: "qemu-aarch64-static", package: "qemu-user-static" },
];
/// The folder into which Debian's Python for the other machine is unpacked.
const PYTHON: &str = "bookworm-arm64-python";

fn emulated(folder: &Folder) -> Result<Option<String>> {
    if !available(&TOOLS, "the wheel for another machine")? {
        return Ok(None);
    }
    let root = folder.work.join(PYTHON);
    if !root.exists() {
        let part = folder.empty("part")?;
        let mut unpack = Command::new("mmdebstrap");
        unpack.args(["--quiet", "--variant=extract", "--architectures=arm64", "--include=python3-numpy", "bookworm"]);
        done(unpack.arg(&part))?;
        std::fs::rename(part, &root)?;
    }
    let packages = folder.empty("wheel-aarch64")?;
    done(Command::new("python3").args(["-m", "zipfile", "-e"]).arg(folder.of(name(MACHINES[1].1))).arg(&packages))?;
    // Debian's numpy finds these two libraries through links, which are missing because the packages are only unpacked
    let libraries = ["blas", "lapack"].map(|name| format!("/usr/lib/aarch64-linux-gnu/{name}"));
    let mut python = Command::new("qemu-aarch64-static");
    python.arg("-L").arg(&root).arg("-E").arg(format!("LD_LIBRARY_PATH={}", libraries.join(":")));
    python.arg(root.join("usr/bin/python3.11")).args(["-c", USED]).current_dir(&packages);
    let numpy = root.join("usr/lib/python3/dist-packages");
    python.env("PYTHONHOME", root.join("usr"));
    python.env("PYTHONPATH", format!("{}:{}", packages.display(), numpy.display()));
    printed(&mut python).map(Some)
}

/// A script that must print the same numbers on all machines.
const USED: &str = "
import numpy, zerorate
rate = numpy.cumsum(numpy.sin(numpy.arange(4096.0) ** 2))
result = zerorate.allan(rate, rate_hz=100.0)
unit = zerorate.calibrate(zerorate.Twin(seed=7), average=5, warmup=30, settle=10, offset=15, max_u_btc=1)
print(zerorate.__version__, [round(dev, 12) for dev in result.dev.tolist()], unit.calibration.id)";
