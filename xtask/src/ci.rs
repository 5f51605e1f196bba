//! `cargo xtask ci`: the gate that every change must pass.
//!
//! Everything is built once, in one profile and with one set of features (`xtask::app::WHOLE`): `test` builds it, and
//! the program, the lab, the wheel and the book of the later steps use that build. Random samples, checks that depend
//! on the date, and tests with a Linux kernel belong to `cargo xtask night`. Each step must pass on a busy machine.

use crate::steps::{self, AtFailure, Step};
use crate::{check, test};
use anyhow::Result;
use xtask::arguments::Arguments;

/// The steps that are not in `check`.
const REST: [Step; 13] = [
    // beside the last steps of `check`
    Step::beside("page", "xtask web")
        .about("The page builds; the program of `test` has it inside")
        .installing("nodejs npm clang, what web/package-lock.json names in web/node_modules"),
    test::WHOLE_STEP,
    Step::new("codegen", "xtask codegen --check")
        .about("Every generated file is as `cargo xtask codegen` would write it"),
    Step::new("instructions", "xtask instructions")
        .about("Reading and checking a log costs at most half of its deviations, in instructions")
        .installing("valgrind"),
    // the longest steps first, so that none runs alone at the end
    Step::beside("web", "xtask web --check")
        .about("The page of the program, tested in Chromium: served bench and reader of logs")
        .installing("chromium"),
    Step::beside("python", "xtask python")
        .about("The wheel, its tests and type checkers")
        .installing("what requirements-test.txt names, below target/"),
    Step::beside("bridge", "xtask bridge")
        .about("The program at a bridge in an emulator, over good and bad cables")
        .installing("qemu-system-arm"),
    Step::beside(
        "test-bridge",
        "test --manifest-path firmware/Cargo.toml -p firmware-bridge --locked --target-dir target/firmware",
    )
    .about("The bridge on this computer, with the twin as the sensor"),
    Step::beside("serve", "xtask bench-serve --check")
        .about("20 pages and 4 libiio clients watch a minute of the twin, and the recording loses nothing")
        .installing("libiio-utils"),
    Step::beside("firmware", "xtask firmware")
        .about("Results, instructions and bytes on a Cortex-M4F; a rise of more than 5 % fails")
        .installing("qemu-system-arm"),
    Step::beside("book", "xtask book --check")
        .about("The book renders, its links lead somewhere, its commands run, three pages open in Chromium")
        .installing("chromium"),
    Step::beside("iiod", "xtask iiod")
        .about("The libiio server, read by libiio's own clients and by pyadi-iio")
        .installing("libiio-utils python3-libiio, what lab/iiod-requirements.txt names, below target/"),
    Step::beside("c", "xtask c")
        .about("The C library, and C against Rust on the host and on an emulated Cortex-M4F")
        .installing("build-essential gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm"),
];

const NOTES: &str = "\
A step whose command is `cargo xtask TASK` says more in `cargo xtask TASK --help`.

The first step that fails ends the run, which prints the command that repeats it. Steps that wait or use one core run
side by side; their output is shown when they end. All steps pass on a busy machine.

Rust targets are added through rustup. Debian's packages are installed where this is Debian and you are root. Elsewhere
a step says what it skips, and passes.

CI runs `.ci/run`, which is this command. `.github/workflows/ci.yml` runs the same steps in jobs. `cargo xtask night`
has what samples, follows the calendar, or needs a kernel or the image of a board.";

pub fn help() -> String {
    format!("  --list  Print the names of the steps, and run nothing\n\n{}\n{NOTES}", steps::list(&all()))
}

/// The steps of `cargo xtask ci`, those of `check` first.
pub fn all() -> Vec<Step> {
    [check::STEPS.as_slice(), &REST].concat()
}

pub fn run(mut arguments: Arguments) -> Result<()> {
    let list = arguments.flag("--list");
    let chosen = steps::chosen(&all(), &arguments.words()?)?;
    if list {
        chosen.iter().for_each(|step| println!("{}", step.name));
        return Ok(());
    }
    steps::run(&chosen, AtFailure::Stop)
}
