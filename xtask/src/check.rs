//! `cargo xtask check`: the checks for a developer while working, without the tests of the crates.

use crate::steps::{self, AtFailure, Step};
use anyhow::Result;
use xtask::arguments::Arguments;

/// The steps, cheap ones first. Lints and documentation use the profile of the tests, so that build scripts, macros
/// and C libraries are compiled once for all.
///
/// thumbv7em-none-eabihf is a Cortex-M4F. thumbv6m-none-eabi is a Cortex-M0: it has no compare-and-swap, which the
/// TOML parser behind the core's feature `file` needs.
pub const STEPS: [Step; 13] = [
    Step::new("fmt", "fmt --all --check").about("Formatting of the workspace"),
    Step::new("fmt-firmware", "fmt --manifest-path firmware/Cargo.toml --all --check")
        .about("Formatting of firmware/"),
    Step::new("fmt-c", "fmt --manifest-path bindings/c/Cargo.toml --all --check").about("Formatting of bindings/c"),
    Step::new("fmt-tools", "fmt --manifest-path lab/tools/Cargo.toml --all --check").about("Formatting of lab/tools"),
    Step::new("project", "test --quiet --package xtask")
        .about("Links, cited facts, line lengths, packaging, workflows, and circles among modules"),
    Step::new("clippy", "clippy --release --workspace --all-targets --all-features -- -D warnings")
        .about("Lints with all features"),
    Step::new("clippy-default", "clippy --release -p zerorate-cli -- -D warnings")
        .about("Lints of the program and its libraries with the default features"),
    Step::new("doc", "doc --release --workspace --no-deps --all-features")
        .about("The documentation builds without a warning")
        .with_env("RUSTDOCFLAGS", "-Dwarnings"),
    Step::new(
        "clippy-m0",
        "clippy --release -p adis16130 -p zerorate --lib --no-default-features --features adis16130/async --target \
         thumbv6m-none-eabi -- -D warnings",
    )
    .about("Driver and core on a Cortex-M0, which has no compare-and-swap"),
    Step::new("clippy-m0-driver", "clippy --release -p adis16130 --lib --target thumbv6m-none-eabi -- -D warnings")
        .about("The driver alone on a Cortex-M0"),
    Step::new(
        "clippy-m4",
        "clippy --release -p adis16130 -p zerorate -p adis16130-twin --lib --features \
         adis16130/async,zerorate/file --target thumbv7em-none-eabihf -- -D warnings",
    )
    .about("Driver, core and twin on a Cortex-M4F"),
    // the last two have target folders of their own, and run side by side
    Step::beside(
        "clippy-c",
        "clippy --release --manifest-path bindings/c/Cargo.toml --workspace --locked --target-dir target/c -- -D \
         warnings",
    )
    .about("The C interface"),
    Step::beside(
        "clippy-firmware-m4",
        "clippy --release --manifest-path firmware/Cargo.toml --workspace --locked --target-dir target/firmware \
         --target thumbv7em-none-eabihf --features firmware-bridge/stm32f4,firmware-examples/stm32f4 -- -D warnings",
    )
    .about("Images for the emulator, bridge and examples on an STM32F411"),
];

pub fn help() -> String {
    steps::list(&STEPS)
}

pub fn run(arguments: Arguments) -> Result<()> {
    steps::run(&steps::chosen(&STEPS, &arguments.words()?)?, AtFailure::Stop)
}
