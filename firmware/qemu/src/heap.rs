//! The heap, which the twin and the readings need.

use core::sync::atomic::{AtomicBool, Ordering};
use embedded_alloc::LlffHeap;

const BYTES: usize = 256 * 1024;

#[global_allocator]
static HEAP: LlffHeap = LlffHeap::empty();

/// Gives the allocator its memory. Call it once, before the first allocation.
#[expect(unsafe_code, reason = "a heap is memory that nothing else uses")]
pub fn set_up() {
    static ONCE: AtomicBool = AtomicBool::new(false);
    if ONCE.swap(true, Ordering::Relaxed) {
        return;
    }
    // SAFETY: reached once, with a size above zero and memory of its own.
    unsafe {
        embedded_alloc::init!(HEAP, BYTES);
    }
}
