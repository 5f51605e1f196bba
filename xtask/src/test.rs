//! `cargo xtask test`: every check that a change must pass.
//!
//! The steps share what they build: clippy and the documentation use the same checked dependencies; the tests, the
//! program that other steps run, and the Python package the same libraries. xtask is tested by itself, since its own
//! dependencies ask for features of shared ones, with which all of them would be built once more.

use std::fmt;
use std::process::Command;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail};

use crate::targets;

/// Command line of `cargo xtask test`.
#[derive(clap::Args)]
pub struct Args {
    /// Run only these steps; default: all
    #[arg(value_name = "STEP", value_parser = clap::builder::PossibleValuesParser::new(STEPS.map(|step| step.name)))]
    only: Vec<String>,
}

/// One cargo command.
struct Step {
    name: &'static str,
    env: Option<(&'static str, &'static str)>,
    args: &'static str,
}

impl Step {
    const fn new(name: &'static str, args: &'static str) -> Self {
        Self { name, env: None, args }
    }

    const fn with_env(mut self, key: &'static str, value: &'static str) -> Self {
        self.env = Some((key, value));
        self
    }

    /// The Rust targets it builds for, the host left out.
    fn targets(&self) -> impl Iterator<Item = &'static str> {
        let words = self.args.split(' ');
        words.clone().zip(words.skip(1)).filter(|(option, _)| *option == "--target").map(|(_, target)| target)
    }
}

/// The command as one would type it.
impl fmt::Display for Step {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some((key, value)) = self.env {
            write!(f, "{key}={value} ")?;
        }
        write!(f, "cargo {}", self.args)
    }
}

/// All steps, in the order in which they fail most cheaply.
///
/// thumbv7em-none-eabihf is a Cortex-M4F. thumbv6m-none-eabi is a Cortex-M0: it has no compare-and-swap, which the
/// TOML parser behind the core's feature `file` needs. wasm32-unknown-unknown is the browser.
const STEPS: [Step; 35] = [
    Step::new("fmt", "fmt --all --check"),
    Step::new("clippy", "clippy --workspace --all-targets --all-features -- -D warnings"),
    Step::new("clippy-driver", "clippy -p adis16130 --all-targets -- -D warnings"),
    Step::new("fmt-firmware", "fmt --manifest-path firmware/qemu/Cargo.toml --check"),
    Step::new(
        "clippy-firmware",
        "clippy --manifest-path firmware/qemu/Cargo.toml --locked --target-dir target/firmware --target \
         thumbv7em-none-eabihf -- -D warnings",
    ),
    Step::new("fmt-bridge", "fmt --manifest-path firmware/bridge/Cargo.toml --check"),
    Step::new(
        "clippy-bridge-stm32f4",
        "clippy --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4 -- -D warnings",
    ),
    Step::new(
        "clippy-bridge-rp2040",
        "clippy --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040 -- -D warnings",
    ),
    Step::new("fmt-examples", "fmt --manifest-path firmware/examples/Cargo.toml --check"),
    Step::new(
        "clippy-examples-stm32f4",
        "clippy --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4 -- -D warnings",
    ),
    Step::new(
        "clippy-examples-rp2040",
        "clippy --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040 -- -D warnings",
    ),
    Step::new("fmt-c", "fmt --manifest-path bindings/c/Cargo.toml --all --check"),
    Step::new(
        "clippy-c",
        "clippy --manifest-path bindings/c/Cargo.toml --workspace --locked --target-dir target/c -- -D warnings",
    ),
    Step::new("clippy-core", "clippy -p zerorate --no-default-features --lib -- -D warnings"),
    Step::new("doc", "doc --workspace --no-deps --all-features").with_env("RUSTDOCFLAGS", "-Dwarnings"),
    Step::new(
        "m0",
        "build -p adis16130 -p zerorate --no-default-features --features adis16130/async --target thumbv6m-none-eabi",
    ),
    Step::new("m0-driver", "build -p adis16130 --target thumbv6m-none-eabi"),
    Step::new(
        "m4",
        "build -p adis16130 -p zerorate -p adis16130-twin --features adis16130/async,zerorate/file --target \
         thumbv7em-none-eabihf",
    ),
    Step::new("wasm", "check -p zerorate-data -p zerorate-view --no-default-features --target wasm32-unknown-unknown"),
    Step::new("test", "test --workspace --exclude xtask --all-features"),
    Step::new("test-xtask", "test -p xtask"),
    Step::new("test-driver", "test -p adis16130"),
    Step::new("test-bridge", "test --manifest-path firmware/bridge/Cargo.toml --locked --target-dir target/firmware"),
    Step::new(
        "bridge-stm32f4",
        "build --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4",
    ),
    Step::new(
        "bridge-rp2040",
        "build --manifest-path firmware/bridge/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040",
    ),
    Step::new(
        "test-examples",
        "test --manifest-path firmware/examples/Cargo.toml --locked --target-dir target/firmware",
    ),
    Step::new(
        "examples-stm32f4",
        "build --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv7em-none-eabihf --features stm32f4",
    ),
    Step::new(
        "examples-rp2040",
        "build --manifest-path firmware/examples/Cargo.toml --locked --release --target-dir target/firmware --target \
         thumbv6m-none-eabi --features rp2040",
    ),
    Step::new("deny", "xtask deny"),
    Step::new("firmware", "xtask firmware"),
    Step::new("c", "xtask c"),
    Step::new("bridge", "xtask bridge"),
    Step::new("rig", "xtask rig"),
    Step::new("python", "xtask python"),
    Step::new("trust", "xtask trust --quick"),
];

/// Runs the steps in order and stops at the first that fails.
pub fn run(args: &Args) -> Result<()> {
    let chosen: Vec<&Step> =
        STEPS.iter().filter(|step| args.only.is_empty() || args.only.iter().any(|name| name == step.name)).collect();
    targets::add_missing(chosen.iter().flat_map(|step| step.targets()))?;
    let mut passed = Vec::new();
    for (index, step) in chosen.iter().enumerate() {
        println!("\n=== {} of {}: {}: {step}", index + 1, chosen.len(), step.name);
        let start = Instant::now();
        let ok = execute(step)?;
        println!("=== {}: {} in {}", step.name, if ok { "passed" } else { "FAILED" }, clock(start.elapsed()));
        if !ok {
            summarise(&passed);
            bail!("{} failed; to repeat it alone: {step}", step.name);
        }
        passed.push((step.name, start.elapsed()));
    }
    summarise(&passed);
    Ok(())
}

fn execute(step: &Step) -> Result<bool> {
    let status = Command::new("cargo").args(step.args.split(' ')).envs(step.env).status();
    Ok(status.with_context(|| format!("cannot run `{step}`"))?.success())
}

fn summarise(passed: &[(&str, Duration)]) {
    println!("\nPassed {} of the steps:", passed.len());
    for (name, time) in passed {
        println!("  {name:24} {:>12}", clock(*time));
    }
    println!("  {:24} {:>12}", "together", clock(passed.iter().map(|(_, time)| *time).sum()));
}

/// `7 min 05 s`, or `5.3 s` below a minute.
fn clock(time: Duration) -> String {
    match time.as_secs() {
        0..60 => format!("{:.1} s", time.as_secs_f64()),
        s => format!("{} min {:02} s", s / 60, s % 60),
    }
}
