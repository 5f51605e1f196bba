//! The last line on stderr, however the program ends: what it leaves behind, such as a chamber that heats.

use crate::output::say;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

struct Last {
    word: Option<String>,
    /// Whether work is still going on that will change the word.
    is_pending: bool,
}

static LAST: Mutex<Last> = Mutex::new(Last { word: None, is_pending: false });
static SETTLED: Condvar = Condvar::new();

fn last() -> MutexGuard<'static, Last> {
    LAST.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Sets the word that a program says if it ends from here on.
pub fn owe(word: String) {
    *last() = Last { word: Some(word), is_pending: true };
}

/// Sets the final word: everything that can be done is done.
pub fn settle(word: Option<String>) {
    *last() = Last { word, is_pending: false };
    SETTLED.notify_all();
}

/// Waits for pending work, at most this long.
pub fn wait(most: Duration) {
    drop(SETTLED.wait_timeout_while(last(), most, |last| last.is_pending));
}

/// Says the word once, after the output of `report`.
pub fn say_after<T>(report: impl FnOnce() -> T) -> T {
    let mut last = last();
    let reported = report();
    if let Some(word) = last.word.take() {
        say(word);
    }
    reported
}

/// Says the word and ends the program. Nothing follows it.
pub fn exit(code: i32) -> ! {
    let mut last = last();
    if let Some(word) = last.word.take() {
        say(word);
    }
    std::process::exit(code)
}
