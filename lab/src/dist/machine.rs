//! The kinds of computers for which programs and packages are built.

use crate::tools::{Tool, available};
use anyhow::Result;

pub struct Machine {
    /// The name of the kind in file names.
    pub name: &'static str,
    pub target: &'static str,
    /// The architecture name in Debian.
    pub debian: &'static str,
    /// Debian's cross compiler, with the C library that is linked statically.
    pub compiler: Tool,
    /// Whether Rust's own linker links the program. GNU ld 2.40 drops the Thumb bit of functions beyond 16 MB, and
    /// such a program crashes before `main`.
    pub rust_linker: bool,
    /// The emulator that runs programs for this kind of computer here; `None` if they run without one.
    pub emulator: Option<&'static str>,
}

pub const MACHINES: [Machine; 3] = [
    Machine {
        name: "x86_64",
        target: "x86_64-unknown-linux-gnu",
        debian: "amd64",
        compiler: Tool { program: "gcc", package: "build-essential" },
        rust_linker: false,
        emulator: None,
    },
    Machine {
        name: "aarch64",
        target: "aarch64-unknown-linux-gnu",
        debian: "arm64",
        compiler: Tool { program: "aarch64-linux-gnu-gcc", package: "gcc-aarch64-linux-gnu" },
        rust_linker: false,
        emulator: Some("qemu-aarch64-static"),
    },
    Machine {
        name: "armv7",
        target: "armv7-unknown-linux-gnueabihf",
        debian: "armhf",
        compiler: Tool { program: "arm-linux-gnueabihf-gcc", package: "gcc-arm-linux-gnueabihf" },
        rust_linker: true,
        emulator: Some("qemu-arm-static"),
    },
];

impl Machine {
    /// True if programs for this kind of computer can run here. If not, prints that they are skipped.
    pub fn runs_here(&self) -> Result<bool> {
        let Some(program) = self.emulator else { return Ok(true) };
        available(&[Tool { program, package: "qemu-user-static" }], &format!("running programs for {}", self.name))
    }
}
