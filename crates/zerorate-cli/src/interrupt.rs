//! Ctrl-C and SIGTERM: the first asks the loops to end cleanly, a second one ends the program at once.

use anyhow::Context;
use std::sync::atomic::{AtomicBool, Ordering};

static ASKED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was ended by SIGINT, as shells report it.
const INTERRUPTED: i32 = 130;

/// From here on a signal only sets the flag. Called once, by the commands that run for long.
pub fn listen() -> anyhow::Result<()> {
    ctrlc::set_handler(|| {
        if ASKED.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
    })
    .context("installing the Ctrl-C handler")
}

/// Whether the user asked to stop. One relaxed load: fit for the per-sample path.
#[inline]
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
