//! ThreadSanitizer on what several threads share: the hub and its queues, the readers, the chamber, the libiio server.

use super::nightly;
use anyhow::Result;
use xtask::venv::done;

const TESTS: &str = "--package zerorate-host --lib --test hub --test iiod";

/// Runs the tests with a standard library of the same build; a race ends one with an error.
pub fn run() -> Result<()> {
    if !nightly::available("rust-src", "ThreadSanitizer") {
        return Ok(());
    }
    let mut cargo = nightly::cargo("test --quiet --release -Zbuild-std", "tsan");
    cargo.args(["--target", nightly::HOST]).args(TESTS.split(' ')).env("RUSTFLAGS", "-Zsanitizer=thread");
    done(cargo.env("TSAN_OPTIONS", "halt_on_error=1"))
}
