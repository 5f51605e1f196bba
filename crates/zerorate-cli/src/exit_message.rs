//! The last line on stderr, however the program ends. It tells what the program leaves, such as a chamber that heats.

use crate::output::say;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

struct Last {
    text: Option<String>,
    /// True if unfinished work will still change the text.
    is_pending: bool,
}

static LAST: Mutex<Last> = Mutex::new(Last { text: None, is_pending: false });
static SETTLED: Condvar = Condvar::new();

fn last() -> MutexGuard<'static, Last> {
    LAST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets the message that is printed if the program ends from now on.
pub fn set_pending(text: String) {
    *last() = Last { text: Some(text), is_pending: true };
}

/// Sets the final message, after all work is done.
pub fn settle(text: Option<String>) {
    *last() = Last { text, is_pending: false };
    SETTLED.notify_all();
}

/// Waits until the unfinished work is done, but no longer than `most`.
pub fn wait(most: Duration) {
    drop(SETTLED.wait_timeout_while(last(), most, |last| last.is_pending));
}

/// Calls `report` and then prints the last message, unless it was printed before.
pub fn say_after<T>(report: impl FnOnce() -> T) -> T {
    let mut last = last();
    let reported = report();
    if let Some(text) = last.text.take() {
        say(text);
    }
    reported
}

/// Prints the last message, unless it was printed before, and ends the program.
pub fn exit(code: i32) -> ! {
    let mut last = last();
    if let Some(text) = last.text.take() {
        say(text);
    }
    std::process::exit(code)
}
