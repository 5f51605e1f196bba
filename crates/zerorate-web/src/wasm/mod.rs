//! What the modules of a browser export: JavaScript's types come in and go out, and nothing is decided.

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
