//! The session behind zerorate's page, for `zerorate serve` and for a browser without a server. The session takes
//! readings and requests, and returns frames and answers. It has no socket, clock or thread: the owner of the event
//! loop calls it.
//!
//! The messages are in [`message`], and specified in `docs/formats/page.md`.

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
