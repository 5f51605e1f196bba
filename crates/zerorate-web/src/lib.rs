//! What stands behind the page of zerorate, in `zerorate serve` and in the browser alone: readings and requests in,
//! frames and answers out. No socket, no clock and no thread is in here; whoever owns the loop hands in what came.
//!
//! The messages are [`message`], specified in `docs/formats/page.md`.

#[cfg(all(
    target_family = "wasm",
    any(feature = "edge-first", feature = "edge-live", feature = "edge-log", feature = "edge-replay")
))]
pub mod edge;
pub mod first;
pub mod live;
pub mod log;
pub mod message;
pub mod registers;
pub mod session;
pub mod source;
