//! The functions that the browser's modules export. They only convert between Rust's and JavaScript's types.
//!
//! Each feature makes a module: `wasm-first` shows a preview of the twin quickly, `wasm-live` runs the session,
//! `wasm-replay` runs it with recordings, and `wasm-log` reads logs. Each module is this crate, built as a cdylib
//! with one of these features.

#[cfg(any(feature = "wasm-log", feature = "wasm-replay"))]
mod file;
#[cfg(feature = "wasm-first")]
mod first;
#[cfg(any(feature = "wasm-live", feature = "wasm-replay"))]
mod live;
#[cfg(feature = "wasm-log")]
mod log;

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn now_ms() -> f64;
}
