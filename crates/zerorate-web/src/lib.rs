//! The session behind the page of zerorate, for `zerorate serve` and for the browser alone. Readings and requests go
//! in, frames and answers come out. It has no socket, no clock and no thread: the owner of the loop passes in what
//! arrives.
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
