//! The last line on stderr, however the program ends: what it leaves behind in the world, as a chamber that heats.

use crate::output::say;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

struct Last {
    word: Option<String>,
    /// Something still has to be done about it.
    is_pending: bool,
}

static LAST: Mutex<Last> = Mutex::new(Last { word: None, is_pending: false });
static SETTLED: Condvar = Condvar::new();

fn last() -> MutexGuard<'static, Last> {
    LAST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// From here on, a program that ends at once says this.
pub fn owe(word: String) {
    *last() = Last { word: Some(word), is_pending: true };
}

/// All is done that can be done, and this came of it.
pub fn settle(word: Option<String>) {
    *last() = Last { word, is_pending: false };
    SETTLED.notify_all();
}

/// Waits for what is still being done, but no longer than this.
pub fn wait(most: Duration) {
    drop(SETTLED.wait_timeout_while(last(), most, |last| last.is_pending));
}

/// Says it, once, behind what `report` says.
pub fn say_after<T>(report: impl FnOnce() -> T) -> T {
    let mut last = last();
    let reported = report();
    if let Some(word) = last.word.take() {
        say(word);
    }
    reported
}

/// Says it, and ends the program. Nothing is said behind it.
pub fn exit(code: i32) -> ! {
    let mut last = last();
    if let Some(word) = last.word.take() {
        say(word);
    }
    std::process::exit(code)
}
