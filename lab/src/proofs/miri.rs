//! Runs Miri on the C interface, whose Rust side has all `unsafe` code with pointers from C, and on driver and core.

use super::nightly;
use anyhow::Result;
use xtask::venv::done;

/// A target with 32 bits, like the microcontrollers. (On x86-64, libm uses assembly, which Miri cannot run.)
const TARGET: &str = "armv7-unknown-linux-gnueabihf";

/// The tests with `--check`.
const QUICK: [&str; 1] = ["--manifest-path bindings/c/Cargo.toml --package zerorate-c"];
/// Additional tests without `--check`, which take less than three minutes each. Driver and core have no `unsafe` code.
const LONG: [&str; 2] = [
    "--package adis16130 --features bridge --test driver -- asynch bridge codes diagnosis --skip a_counter_in --skip \
     every_damaged",
    "--package zerorate --lib -- chamber::plan chamber::file code_table correction::tests::table \
     correction::tests::a_curve correction::tests::what",
];

/// Runs the tests. Undefined behaviour makes a test fail.
pub fn run(check: bool) -> Result<()> {
    if !nightly::available("miri", "Miri") {
        return Ok(());
    }
    for tests in QUICK.iter().chain(LONG.iter().filter(|_| !check)) {
        let mut cargo = nightly::cargo("miri test --quiet", "miri");
        cargo.args(["--target", TARGET]).args(tests.split(' '));
        done(cargo.env("MIRIFLAGS", "-Zmiri-disable-isolation"))?;
    }
    Ok(())
}
