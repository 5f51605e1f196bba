//! Third-party decoders panic on some damaged files. This module catches such a panic, so that it becomes an error.

use std::cell::Cell;
use std::panic::{self, AssertUnwindSafe};
use std::sync::Once;

thread_local! {
    static INSIDE: Cell<bool> = const { Cell::new(false) };
}

/// Runs a third-party decoder. Returns `None` if it panicked; the panic is not printed.
pub fn catch_panic<T>(decode: impl FnOnce() -> T) -> Option<T> {
    static HOOK: Once = Once::new();
    HOOK.call_once(|| {
        let before = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if !INSIDE.get() {
                before(panic);
            }
        }));
    });
    let outer = INSIDE.replace(true);
    let survived = panic::catch_unwind(AssertUnwindSafe(decode));
    INSIDE.set(outer);
    survived.ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_returns_none() {
        assert_eq!(catch_panic(|| 7), Some(7));
        assert_eq!(catch_panic(|| [1, 2, 3].iter().rev().map(|n| 1 / (n - 1)).sum::<i32>()), None);
        assert!(!INSIDE.get());
    }
}
