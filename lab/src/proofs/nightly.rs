//! The nightly toolchain, which Miri and the sanitizers of Rust need.

use super::WORK;
use std::path::Path;
use std::process::{Command, Stdio};

/// The target of the sanitizers. It is named, so that they do not reach build scripts.
pub const HOST: &str = "x86_64-unknown-linux-gnu";

/// Whether nightly Rust with this component is installed for this computer. Else stderr says what is missing.
pub fn available(component: &str, purpose: &str) -> bool {
    let list = ["+nightly", "component", "list", "--installed"];
    let list = Command::new("rustup").args(list).stderr(Stdio::null()).output();
    let installed = list.is_ok_and(|list| {
        list.status.success() && String::from_utf8_lossy(&list.stdout).lines().any(|line| line.starts_with(component))
    });
    let is_here = cfg!(all(target_arch = "x86_64", target_os = "linux")) && installed;
    if !is_here {
        eprintln!("SKIPPED: {purpose}: no {component} of nightly Rust on {HOST}");
        eprintln!("(rustup toolchain install nightly --profile minimal --component miri,rust-src)");
    }
    is_here
}

/// `cargo` of nightly Rust, with a target folder of its own, and without what the stable cargo that started this
/// program has set.
pub fn cargo(arguments: &str, folder: &str) -> Command {
    let mut cargo = Command::new("rustup");
    cargo.args(["run", "nightly", "cargo"]).args(arguments.split(' '));
    cargo.arg("--locked").arg("--target-dir").arg(Path::new(WORK).join(folder));
    cargo.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").env_remove("RUSTC");
    cargo
}
