//! The symbols that the linker needs from a static library without an operating system.

use core::alloc::{GlobalAlloc, Layout};
use core::panic::PanicInfo;

/// An allocator without memory. No exported function allocates, so the linker leaves it out of the library.
struct NoHeap;

#[global_allocator]
static NO_HEAP: NoHeap = NoHeap;

// SAFETY: an allocator may refuse everything; what was never given is never taken back.
unsafe impl GlobalAlloc for NoHeap {
    unsafe fn alloc(&self, _: Layout) -> *mut u8 {
        core::ptr::null_mut()
    }

    unsafe fn dealloc(&self, _: *mut u8, _: Layout) {}
}

/// Halts. The linker leaves this handler out too, since nothing panics.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
