//! Images for the emulated Cortex-M4F.

use crate::tools::Tool;
use crate::venv::done;
use anyhow::Result;
use std::path::PathBuf;
use std::process::Command;

/// The Rust target of the images: a Cortex-M4F.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// The emulator that runs the images.
pub const QEMU: Tool = Tool { program: "qemu-system-arm", package: "qemu-system-arm" };
const PROJECT: &str = "firmware/qemu";

/// Builds an image and returns its path. The images `driver`, `empty` and `tracker` are built without the twin.
pub fn build(profile: &str, name: &str) -> Result<PathBuf> {
    let target_dir = std::path::absolute("target/firmware")?;
    let mut cargo = Command::new("cargo");
    cargo.current_dir(PROJECT).args(["build", "--quiet", "--locked", "--target", TARGET]);
    cargo.args(["--profile", profile, "--bin", name]).arg("--target-dir").arg(&target_dir);
    match name {
        "driver" | "empty" => drop(cargo.arg("--no-default-features")),
        "tracker" => drop(cargo.args(["--no-default-features", "--features", "tracker"])),
        _ => {}
    }
    done(&mut cargo)?;
    Ok(target_dir.join(TARGET).join(profile).join(name))
}
