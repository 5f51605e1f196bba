//! The nightly toolchain, which Miri and Rust's sanitizers need.

use super::WORK;
use std::path::Path;
use std::process::{Command, Stdio};

/// The target for the sanitizers. Cargo does not instrument build scripts, because this target is named explicitly.
pub const HOST: &str = "x86_64-unknown-linux-gnu";

/// True if nightly Rust with this component is installed for this computer. If not, prints what is missing to stderr.
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

/// `cargo` of nightly Rust, with its own target folder, and without the environment variables of the stable cargo
/// that started this program.
pub fn cargo(arguments: &str, folder: &str) -> Command {
    let mut cargo = Command::new("rustup");
    cargo.args(["run", "nightly", "cargo"]).args(arguments.split(' '));
    cargo.arg("--locked").arg("--target-dir").arg(Path::new(WORK).join(folder));
    cargo.env_remove("RUSTUP_TOOLCHAIN").env_remove("CARGO").env_remove("RUSTC");
    cargo
}
