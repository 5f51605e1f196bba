//! `cargo xtask ci`: everything that a change must pass.
//!
//! Steps that use one core or wait run side by side. Each must pass on a busy machine; only the rig keeps the time,
//! and has the machine for itself.
//!
//! The steps share what they build: clippy and the documentation use the same checked dependencies; `test-full`, the
//! program that other steps run, and the Python package the same libraries; `test-lab` and the tasks of the lab the
//! same again.

use crate::steps::{self, Pace, Step};
use crate::{check, test};
use anyhow::{Result, ensure};
use xtask::arguments::Arguments;

/// What neither `test` nor `check` runs.
const REST: [Step; 38] = [
    Step::new("doc", "doc --workspace --no-deps --all-features")
        .about("The documentation builds without a warning")
        .with_env("RUSTDOCFLAGS", "-Dwarnings"),
    Step::new(
        "clippy-lab",
        "clippy --manifest-path lab/Cargo.toml --package lab --package codegen --all-targets --locked --target-dir \
         target/lab -- -D warnings",
    )
    .about("Lints of lab/"),
    Step::new(
        "doc-lab",
        "doc --manifest-path lab/Cargo.toml --package lab --package codegen --no-deps --locked --target-dir \
         target/lab",
    )
    .about("The documentation of lab/ builds without a warning")
    .with_env("RUSTDOCFLAGS", "-Dwarnings"),
    Step::new(
        "clippy-c",
        "clippy --manifest-path bindings/c/Cargo.toml --workspace --locked --target-dir target/c -- -D warnings",
    )
    .about("Lints of the C interface"),
    Step::new(
        "clippy-firmware",
        "clippy --manifest-path firmware/qemu/Cargo.toml --locked --target-dir target/firmware --target \
         thumbv7em-none-eabihf -- -D warnings",
    )
    .about("Lints of the images for the emulator"),
    Step::new(
        "clippy-bridge-stm32f4",
        "clippy --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4 -- -D warnings",
    )
    .about("Lints of the bridge on a Black Pill"),
    Step::new(
        "clippy-bridge-rp2040",
        "clippy --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040 -- -D warnings",
    )
    .about("Lints of the bridge on a Pico"),
    Step::new(
        "clippy-examples-stm32f4",
        "clippy --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4 -- -D warnings",
    )
    .about("Lints of the examples for an STM32F411"),
    Step::new(
        "clippy-examples-rp2040",
        "clippy --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040 -- -D warnings",
    )
    .about("Lints of the example for an RP2040"),
    Step::new("test-full", "test --release --workspace --all-features").about("All tests, with all features"),
    // in `release`, all crates but this one check for overflow
    Step::new("test-allan", "test -p zerorate-allan --all-features")
        .about("The tests of zerorate-allan, with checks for overflow"),
    Step::new("test-driver", "test -p adis16130").about("The tests of the driver with its default features"),
    Step::new("test-lab", "test --manifest-path lab/Cargo.toml --locked --release --target-dir target/lab")
        .about("The tests of lab/"),
    Step::new(
        "test-codegen",
        "test --manifest-path lab/Cargo.toml --package codegen --locked --target-dir target/lab",
    )
    .about("The tests of what writes generated files"),
    Step::new("test-bridge", "test --manifest-path firmware/bridge/Cargo.toml --locked --target-dir target/firmware")
        .about("The bridge on this computer, with the twin as the sensor"),
    Step::new(
        "bridge-stm32f4",
        "build --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4",
    )
    .about("The image of the bridge for a Black Pill"),
    Step::new(
        "bridge-rp2040",
        "build --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040",
    )
    .about("The image of the bridge for a Pico"),
    Step::new(
        "test-examples",
        "test --manifest-path firmware/examples/Cargo.toml --locked --target-dir target/firmware",
    )
    .about("The examples on this computer, with the twin as the sensor"),
    Step::new(
        "examples-stm32f4",
        "build --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4",
    )
    .about("The images of the examples for an STM32F411"),
    Step::new(
        "examples-rp2040",
        "build --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040",
    )
    .about("The image of the example for an RP2040"),
    // uncommitted changes are for a developer to judge
    Step::new("publish", "publish --dry-run --allow-dirty -p adis16130 -p zerorate-allan")
        .about("Driver and zerorate-allan would be accepted by crates.io; nothing is uploaded"),
    // the longest first, so that none is left alone at the end
    Step::new("python", "xtask python")
        .about("The wheel: its tests with real servers and deaths, type checkers, notebook, and allantools' own tests")
        .at(Pace::Beside)
        .installing("what requirements-test.txt names, below target/; pango1.0-tools postgresql procps"),
    Step::new("web", "xtask web --site target/site --check")
        .about("The page and its static site, both tested in Chromium")
        .at(Pace::Beside)
        .installing("nodejs npm clang chromium qemu-system-arm, what web/package-lock.json names in web/node_modules"),
    Step::new("bridge", "xtask bridge")
        .about("The program at a bridge in an emulator, over good and bad cables")
        .at(Pace::Beside)
        .installing("qemu-system-arm"),
    Step::new("trust", "xtask trust --quick")
        .about("No result is wrong and silent where sensor, cable, disk, files or program break")
        .at(Pace::Beside),
    Step::new("proofs", "xtask proofs --check")
        .about("The C interface in Miri, and called at random under AddressSanitizer, where nightly Rust is installed")
        .at(Pace::Beside)
        .installing("clang"),
    Step::new("mutants", "xtask mutants --share 120 adis16130")
        .about("The tests of the driver fail where one of nine lines is made wrong")
        .at(Pace::Beside)
        .installing("cargo-mutants, below target/tools"),
    Step::new("coverage", "xtask code-coverage --at-least 96 adis16130")
        .about("The tests of the driver reach its lines")
        .at(Pace::Beside)
        .installing("cargo-llvm-cov, below target/tools"),
    Step::new("serve", "xtask bench-serve --check")
        .about("20 pages and 4 libiio clients watch a minute of the twin, and the recording loses nothing")
        .at(Pace::Beside)
        .installing("libiio-utils"),
    Step::new("firmware", "xtask firmware")
        .about("Results, instructions and bytes on a Cortex-M4F; a rise of more than 5 % fails")
        .at(Pace::Beside)
        .installing("qemu-system-arm"),
    Step::new("methods", "xtask methods --quick")
        .about("Every way to calibrate, on a few units against their truth")
        .at(Pace::Beside),
    Step::new("book", "xtask book --check")
        .about("The book renders, its links lead somewhere, its commands run, three pages open in Chromium")
        .at(Pace::Beside)
        .installing("chromium"),
    Step::new("iiod", "xtask iiod")
        .about("The libiio server, read by libiio's own clients and by pyadi-iio")
        .at(Pace::Beside)
        .installing("libiio-utils python3-libiio, what lab/iiod-requirements.txt names, below target/"),
    Step::new("endurance", "xtask endurance --check")
        .about("Memory and descriptors stay while visitors come and go; the clock is set, a disk fills and is freed")
        .at(Pace::Beside)
        .installing("libiio-utils faketime"),
    Step::new("attacks", "xtask attacks http websocket libiio")
        .about("Smuggled requests, Autobahn's cases and libiio's test programs, turned on the server")
        .at(Pace::Beside)
        .installing("libiio-utils, Autobahn's test suite below target/ where Python 2.7 is"),
    Step::new("c", "xtask c")
        .about("The C library, and C against Rust on the host and on an emulated Cortex-M4F")
        .at(Pace::Beside)
        .installing("build-essential gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"),
    Step::new("deny", "xtask deny")
        .about("Advisories, licences and sources of every lock file, by cargo-deny")
        .at(Pace::Beside)
        .installing("cargo-deny, below target/tools"),
    Step::new("rig", "xtask rig")
        .about("A stock Linux kernel reads the twin as hardware; it keeps the time, so it runs alone")
        .installing("qemu-system-x86 busybox-static cpio kmod xz-utils acpica-tools, a kernel below target/"),
];

/// What holds for all steps.
const NOTES: &str = "\
A step whose command is `cargo xtask TASK` says more in `cargo xtask TASK --help`.

The first step that fails ends the run, which prints the command that repeats it. Steps that wait or use one core run
side by side; their output is shown when they end. All steps but `rig` pass on a busy machine.

Rust targets are added through rustup. Debian's packages are installed where this is Debian and you are root. Elsewhere
a step says what it skips, and passes.

CI runs `.ci/run`: `cargo xtask test`, then `cargo xtask ci --rest`. `.github/workflows/ci.yml` runs the same steps in
jobs.";

pub fn help() -> String {
    format!(
        "  --rest  Leave out `test`, for where it has run already\n  --list  Print the names of the steps, and run \
         nothing\n\n{}\n{NOTES}",
        steps::list(&all())
    )
}

fn all() -> Vec<Step> {
    [[test::STEP].as_slice(), &check::STEPS, &REST].concat()
}

pub fn run(mut arguments: Arguments) -> Result<()> {
    let (rest, list) = (arguments.flag("--rest"), arguments.flag("--list"));
    let names = arguments.words()?;
    ensure!(!rest || names.is_empty(), "--rest leaves `test` out of all steps; it goes with no STEP");
    let all = all();
    let all = if rest { &all[1..] } else { &all };
    let chosen = steps::chosen(all, &names)?;
    if list {
        chosen.iter().for_each(|step| println!("{}", step.name));
        return Ok(());
    }
    steps::run(&chosen)
}
