//! What the modules of a browser export: JavaScript's types come in and go out, and nothing is decided.

#[cfg(feature = "edge-log")]
mod file;
mod live;
#[cfg(feature = "edge-log")]
mod log;
