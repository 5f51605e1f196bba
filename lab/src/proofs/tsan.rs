//! Runs ThreadSanitizer on code that several threads share: the hub and its queues, the readers, the chamber, the
//! libiio server, and the server of the page.

use super::nightly;
use anyhow::Result;
use xtask::venv::done;

/// The program is built with the server only, to compile less. Tests that read a file are skipped, because their
/// memory limit leaves no memory for the sanitizer. A test that waits for a calibration is skipped too.
const TESTS: [&str; 2] = [
    "--package zerorate-host --lib --test hub --test iiod",
    "--package zerorate-cli --no-default-features --features serve --test cli serve:: -- \
     --skip connections_are_limited --skip calibration_of_another_part --skip where_it_cannot_begin \
     --skip a_recording_that_is_served --skip a_lost_device --skip viewers_do_not_slow",
];

/// Runs the tests, with an instrumented standard library. A data race makes a test fail.
pub fn run() -> Result<()> {
    if !nightly::available("rust-src", "ThreadSanitizer") {
        return Ok(());
    }
    for tests in TESTS {
        let mut cargo = nightly::cargo("test --quiet -Zbuild-std", "tsan");
        cargo.args(["--target", nightly::HOST]).args(tests.split(' ')).env("RUSTFLAGS", "-Zsanitizer=thread");
        done(cargo.env("TSAN_OPTIONS", "halt_on_error=1"))?;
    }
    Ok(())
}
