//! The computers that programs and packages are made for.

use crate::tools::{Tool, available};
use anyhow::Result;
use std::path::Path;
use std::process::Command;

/// A kind of computer that runs Linux.
pub struct Machine {
    /// Its name in the names of files.
    pub name: &'static str,
    /// Rust's name of it.
    pub target: &'static str,
    /// Debian's name of it.
    pub debian: &'static str,
    /// Debian's compiler for it, with the C library that the program takes into itself.
    pub compiler: Tool,
    /// The emulator that runs its programs here; none for this computer.
    pub emulator: Option<&'static str>,
}

pub const MACHINES: [Machine; 3] = [
    Machine {
        name: "x86_64",
        target: "x86_64-unknown-linux-gnu",
        debian: "amd64",
        compiler: Tool { program: "gcc", package: "build-essential" },
        emulator: None,
    },
    Machine {
        name: "aarch64",
        target: "aarch64-unknown-linux-gnu",
        debian: "arm64",
        compiler: Tool { program: "aarch64-linux-gnu-gcc", package: "gcc-aarch64-linux-gnu" },
        emulator: Some("qemu-aarch64-static"),
    },
    Machine {
        name: "armv7",
        target: "armv7-unknown-linux-gnueabihf",
        debian: "armhf",
        compiler: Tool { program: "arm-linux-gnueabihf-gcc", package: "gcc-arm-linux-gnueabihf" },
        emulator: Some("qemu-arm-static"),
    },
];

impl Machine {
    /// Whether its programs can be run here; says so where they cannot.
    pub fn runs_here(&self) -> Result<bool> {
        let Some(program) = self.emulator else { return Ok(true) };
        available(&[Tool { program, package: "qemu-user-static" }], &format!("running programs for {}", self.name))
    }

    /// A command that runs `program`, which was built for this machine. A program that starts itself again, as
    /// `zerorate` does to read files under a limit, cannot do that under an emulator, and goes on without.
    pub fn command(&self, program: &Path) -> Command {
        let Some(emulator) = self.emulator else { return Command::new(program) };
        let mut command = Command::new(emulator);
        command.arg(program);
        command
    }
}
