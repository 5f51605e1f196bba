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
const REST: [Step; 33] = [
    Step::new("doc", "doc --workspace --no-deps --all-features").with_env("RUSTDOCFLAGS", "-Dwarnings"),
    Step::new(
        "clippy-lab",
        "clippy --manifest-path lab/Cargo.toml --package lab --package codegen --all-targets --locked --target-dir \
         target/lab -- -D warnings",
    ),
    Step::new(
        "doc-lab",
        "doc --manifest-path lab/Cargo.toml --package lab --package codegen --no-deps --locked --target-dir \
         target/lab",
    )
    .with_env("RUSTDOCFLAGS", "-Dwarnings"),
    Step::new(
        "clippy-c",
        "clippy --manifest-path bindings/c/Cargo.toml --workspace --locked --target-dir target/c -- -D warnings",
    ),
    Step::new(
        "clippy-firmware",
        "clippy --manifest-path firmware/qemu/Cargo.toml --locked --target-dir target/firmware --target \
         thumbv7em-none-eabihf -- -D warnings",
    ),
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
    Step::new("test-full", "test --release --workspace --all-features"),
    // in `release`, all crates but this one check for overflow
    Step::new("test-allan", "test -p zerorate-allan --all-features"),
    Step::new("test-driver", "test -p adis16130"),
    Step::new("test-lab", "test --manifest-path lab/Cargo.toml --locked --release --target-dir target/lab"),
    Step::new(
        "test-codegen",
        "test --manifest-path lab/Cargo.toml --package codegen --locked --target-dir target/lab",
    ),
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
    // uncommitted changes are for a developer to judge
    Step::new("publish", "publish --dry-run --allow-dirty -p adis16130 -p zerorate-allan"),
    // the longest first, so that none is left alone at the end
    Step::new("python", "xtask python")
        .at(Pace::Beside)
        .installing("what bindings/python/requirements-test.txt names, below target/"),
    Step::new("web", "xtask web --site target/site --check")
        .at(Pace::Beside)
        .installing("nodejs npm clang chromium qemu-system-arm, what web/package-lock.json names in web/node_modules"),
    Step::new("bridge", "xtask bridge").at(Pace::Beside).installing("qemu-system-arm"),
    Step::new("trust", "xtask trust --quick").at(Pace::Beside),
    Step::new("serve", "xtask bench-serve --check").at(Pace::Beside).installing("libiio-utils"),
    Step::new("firmware", "xtask firmware").at(Pace::Beside).installing("qemu-system-arm"),
    Step::new("methods", "xtask methods --quick").at(Pace::Beside),
    Step::new("book", "xtask book --check").at(Pace::Beside).installing("chromium"),
    Step::new("iiod", "xtask iiod")
        .at(Pace::Beside)
        .installing("libiio-utils python3-libiio, what lab/iiod-requirements.txt names, below target/"),
    Step::new("c", "xtask c")
        .at(Pace::Beside)
        .installing("build-essential gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"),
    Step::new("deny", "xtask deny").at(Pace::Beside).installing("cargo-deny, below target/tools"),
    Step::new("rig", "xtask rig")
        .installing("qemu-system-x86 busybox-static cpio kmod xz-utils acpica-tools, a kernel below target/"),
];

pub fn help() -> String {
    format!(
        "  --rest  Leave out `test`, for where it has run already\n  --list  Print the names of the steps, and run \
         nothing\n\n{}\nDebian's packages are installed where this is Debian and you are root. Elsewhere a step says \
         what it skips, and passes.",
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
