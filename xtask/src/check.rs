//! `cargo xtask check`: what a developer runs while working. It runs no test of a crate.

use crate::steps::{self, Step};
use anyhow::Result;
use xtask::arguments::Arguments;

/// In the order in which they fail most cheaply.
///
/// thumbv7em-none-eabihf is a Cortex-M4F. thumbv6m-none-eabi is a Cortex-M0: it has no compare-and-swap, which the
/// TOML parser behind the core's feature `file` needs. wasm32-unknown-unknown is the browser.
pub const STEPS: [Step; 14] = [
    Step::new("fmt", "fmt --all --check").about("Formatting of the workspace"),
    Step::new("fmt-firmware", "fmt --manifest-path firmware/Cargo.toml --all --check")
        .about("Formatting of firmware/"),
    Step::new("fmt-c", "fmt --manifest-path bindings/c/Cargo.toml --all --check").about("Formatting of bindings/c"),
    Step::new("fmt-lab", "fmt --manifest-path lab/Cargo.toml --all --check").about("Formatting of lab/"),
    Step::new("project", "test --quiet --package xtask")
        .about("Links, cited facts, line lengths, packaging, workflows, and circles among modules"),
    Step::new("clippy", "clippy --workspace --all-targets --all-features -- -D warnings")
        .about("Lints with all features"),
    Step::new("clippy-driver", "clippy -p adis16130 --all-targets -- -D warnings")
        .about("Lints of the driver with its default features"),
    Step::new("clippy-core", "clippy -p zerorate --no-default-features --lib -- -D warnings")
        .about("Lints of the core without its default features"),
    Step::new("codegen", "xtask codegen --check")
        .about("Every generated file is as `cargo xtask codegen` would write it"),
    Step::new(
        "m0",
        "build -p adis16130 -p zerorate --no-default-features --features adis16130/async --target thumbv6m-none-eabi",
    )
    .about("Driver and core on a Cortex-M0, which has no compare-and-swap"),
    Step::new("m0-driver", "build -p adis16130 --target thumbv6m-none-eabi").about("The driver alone on a Cortex-M0"),
    Step::new(
        "m4",
        "build -p adis16130 -p zerorate -p adis16130-twin --features adis16130/async,zerorate/file --target \
         thumbv7em-none-eabihf",
    )
    .about("Driver, core and twin on a Cortex-M4F"),
    Step::new(
        "wasm",
        "check -p zerorate-record -p zerorate-logs -p zerorate-view --no-default-features --features \
         zerorate-logs/hdf5,zerorate-logs/matlab,zerorate-logs/mcap,zerorate-logs/npz,zerorate-logs/packed,\
         zerorate-logs/parquet,zerorate-logs/ros --target wasm32-unknown-unknown",
    )
    .about("The readers and the pictures for a browser"),
    Step::new(
        "clippy-wasm",
        "clippy -p zerorate-web --lib --features wasm-first,wasm-live --target wasm32-unknown-unknown -- -D warnings",
    )
    .about("Lints of what stands behind the page"),
];

pub fn help() -> String {
    steps::list(&STEPS)
}

pub fn run(arguments: Arguments) -> Result<()> {
    steps::run(&steps::chosen(&STEPS, &arguments.words()?)?)
}
