//! `cargo xtask night`: campaigns with fresh seeds, and steps that need not run before each change.

use crate::steps::{self, AtFailure, Step};
use anyhow::{Context, Result};
use std::hash::{BuildHasher, RandomState};
use xtask::arguments::Arguments;

const STEPS: [Step; 20] = [
    Step::new("test-default", "xtask test").about("The README's command: the tests with the default features"),
    // a debug build, because the profile `release` does not check zerorate-allan for overflow
    Step::new("test-allan", "test -p zerorate-allan --all-features")
        .about("The tests of zerorate-allan, with checks for overflow"),
    Step::new("test-driver", "test -p adis16130").about("The tests of the driver with its default features"),
    // `--allow-dirty`, so that the step also runs with uncommitted changes
    Step::new("publish", "publish --dry-run --allow-dirty -p adis16130 -p zerorate-allan")
        .about("Driver and zerorate-allan would be accepted by crates.io; nothing is uploaded"),
    Step::new(
        "clippy-wasm",
        "clippy --release -p zerorate-web -p zerorate-logs --lib --features zerorate-web/wasm-first,\
         zerorate-web/wasm-live,zerorate-logs/hdf5,zerorate-logs/matlab,zerorate-logs/mcap,zerorate-logs/npz,\
         zerorate-logs/packed,zerorate-logs/parquet,zerorate-logs/ros --target wasm32-unknown-unknown -- -D warnings",
    )
    .about("What stands behind the page, and the readers that need no C, in a browser"),
    Step::new(
        "clippy-firmware-m0",
        "clippy --release --manifest-path firmware/Cargo.toml -p firmware-bridge -p firmware-examples --locked \
         --target-dir target/firmware --target thumbv6m-none-eabi --features \
         firmware-bridge/rp2040,firmware-examples/rp2040 -- -D warnings",
    )
    .about("Bridge and example on an RP2040"),
    Step::new(
        "images-m4",
        "build --manifest-path firmware/Cargo.toml -p firmware-bridge -p firmware-examples --locked --release \
         --target-dir target/firmware --target thumbv7em-none-eabihf --features \
         firmware-bridge/stm32f4,firmware-examples/stm32f4",
    )
    .about("The images of the bridge and the examples for an STM32F411"),
    Step::new(
        "images-m0",
        "build --manifest-path firmware/Cargo.toml -p firmware-bridge -p firmware-examples --locked --release \
         --target-dir target/firmware --target thumbv6m-none-eabi --features \
         firmware-bridge/rp2040,firmware-examples/rp2040",
    )
    .about("The images of the bridge and the example for an RP2040"),
    Step::new(
        "test-examples",
        "test --manifest-path firmware/Cargo.toml -p firmware-examples --locked --target-dir target/firmware",
    )
    .about("The examples on this computer, with the twin as the sensor"),
    Step::beside("web-live", "xtask web --site target/site --live")
        .about("The static site with the page's second home, a twin and a bridge in the browser, in Chromium")
        .installing("nodejs npm clang chromium qemu-system-arm, what web/package-lock.json names in web/node_modules"),
    Step::beside("trust", "xtask trust --quick --seed {seed}")
        .about("No result is wrong and silent where sensor, cable, disk, files or program break"),
    Step::beside("python-more", "xtask python stores notebook allantools certificate bridge")
        .about("The fleet on Dask and S3, the notebook, allantools' own tests, certificates, an emulated bridge")
        .installing("what requirements-night.txt names, below target/; pango1.0-tools qemu-system-arm"),
    Step::beside("proofs", "xtask proofs --check --seed {seed}")
        .about("The C interface in Miri, and called at random under AddressSanitizer, where nightly Rust is installed")
        .installing("clang libclang-rt-dev"),
    Step::beside("mutants", "xtask mutants --share 120 --seed {seed} adis16130")
        .about("The tests of the driver fail where one of nine lines is made wrong")
        .installing("cargo-mutants, below target/tools"),
    Step::beside("coverage", "xtask code-coverage --at-least 96 adis16130")
        .about("The tests of the driver reach its lines")
        .installing("cargo-llvm-cov, below target/tools"),
    Step::beside("methods", "xtask methods --quick --seed {seed}")
        .about("Every way to calibrate, on a few units against their truth"),
    Step::beside("endurance", "xtask endurance --check --seed {seed}")
        .about("Memory and descriptors stay while visitors come and go; the clock is set, a disk fills and is freed")
        .installing("libiio-utils faketime"),
    Step::beside("attacks", "xtask attacks http websocket libiio")
        .about("Smuggled requests, Autobahn's cases and libiio's test programs, turned on the server")
        .installing("libiio-utils, Autobahn's test suite below target/ where Python 2.7 is"),
    Step::beside("deny", "xtask deny")
        .about("Advisories, licences and sources of every lock file, by cargo-deny")
        .installing("cargo-deny, below target/tools"),
    Step::new("rig", "xtask rig")
        .about("A stock Linux kernel reads the twin as hardware; it keeps the time, so it runs alone")
        .installing("qemu-system-x86 busybox-static cpio kmod xz-utils acpica-tools, a kernel below target/"),
];

/// The range of the random seeds: short to type, and above the seeds of the units that the documentation names.
const SEEDS: std::ops::Range<u64> = 100_000..1_000_000;

const NOTES: &str = "\
Each run draws a fresh seed and prints it. All steps run, also after one that fails; the end names each that failed,
with the command that repeats it with its seed. `.github/workflows/nightly.yml` runs this task by cron.";

pub fn help() -> String {
    format!(
        "  --seed N  The seed of the campaigns, instead of a fresh one\n  --list    Print the names of the steps, and \
         run nothing\n\n{}\n{NOTES}",
        steps::list(&STEPS)
    )
}

pub fn run(mut arguments: Arguments) -> Result<()> {
    let seed =
        arguments.value("--seed")?.map(|text| text.parse().context("--seed takes a whole number")).transpose()?;
    let list = arguments.flag("--list");
    let seed = seed.unwrap_or_else(fresh);
    let chosen: Vec<Step> =
        steps::chosen(&STEPS, &arguments.words()?)?.into_iter().map(|step| step.with_seed(seed)).collect();
    if list {
        chosen.iter().for_each(|step| println!("{}", step.name));
        return Ok(());
    }
    println!("seed {seed}; to repeat: cargo xtask night --seed {seed}");
    steps::run(&chosen, AtFailure::GoOn)
}

/// A random seed, from the keys that the operating system gives the standard library for its hash tables.
fn fresh() -> u64 {
    SEEDS.start + RandomState::new().hash_one(()) % (SEEDS.end - SEEDS.start)
}
