//! The symbols that the linker needs from a static library without an operating system.

use core::alloc::{GlobalAlloc, Layout};
use core::panic::PanicInfo;

/// The library has no heap. The core could allocate, but no export does, so this never gets into the library.
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

/// The library does not contain this handler either, since nothing panics.
#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
