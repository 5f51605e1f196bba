//! What the modules of a browser export: JavaScript's types come in and go out, and nothing is decided.

mod file;
#[cfg(feature = "edge-live")]
mod live;
#[cfg(feature = "edge-log")]
mod log;
