//! What stands behind the page of zerorate, in `zerorate serve` and in the browser alone: readings and requests in,
//! frames and answers out. No socket, no clock and no thread is in here; whoever owns the loop hands in what came.
//!
//! The messages are [`message`], specified in `docs/formats/page.md`.

pub mod first;
pub mod live;
pub mod log;
pub mod message;
pub mod registers;
pub mod session;
pub mod source;
#[cfg(all(
    target_family = "wasm",
    any(feature = "wasm-first", feature = "wasm-live", feature = "wasm-log", feature = "wasm-replay")
))]
pub mod wasm;
