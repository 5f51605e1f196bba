//! Ctrl-C, SIGTERM and SIGHUP. Loops that listen are asked to end cleanly, and a second signal ends the program at once; so does the first
//! where nothing listens. Temporary files are removed in either case.

use crate::output;
use anyhow::Context;
use std::sync::atomic::{AtomicBool, Ordering};

static LISTENED_TO: AtomicBool = AtomicBool::new(false);
static ASKED: AtomicBool = AtomicBool::new(false);

/// Exit code of a program that was ended by SIGINT, as shells report it.
const INTERRUPTED: i32 = 130;

/// From here on a signal ends the program. To be called before any command runs.
pub fn handle() -> anyhow::Result<()> {
    let handled = ctrlc::set_handler(|| {
        if !LISTENED_TO.load(Ordering::Relaxed) || ASKED.swap(true, Ordering::Relaxed) {
            output::remove_all_for_good();
            std::process::exit(INTERRUPTED);
        }
    });
    match handled {
        // the second command line of a process that has several, such as Python
        Ok(()) | Err(ctrlc::Error::MultipleHandlers) => Ok(()),
        Err(error) => Err(error).context("installing the handler of Ctrl-C"),
    }
}

/// From here on the first signal only sets the flag that [`asked`] reads.
pub fn listen() {
    LISTENED_TO.store(true, Ordering::Relaxed);
}

/// Whether the user asked to stop. One relaxed load: fit for the per-sample path.
#[inline]
pub fn asked() -> bool {
    ASKED.load(Ordering::Relaxed)
}
