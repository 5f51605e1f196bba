//! What the modules of a browser export: JavaScript's types come in and go out, and nothing is decided.

#[cfg(any(feature = "edge-log", feature = "edge-replay"))]
mod file;
#[cfg(feature = "edge-first")]
mod first;
#[cfg(any(feature = "edge-live", feature = "edge-replay"))]
mod live;
#[cfg(feature = "edge-log")]
mod log;

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    #[wasm_bindgen(js_namespace = performance, js_name = now)]
    fn now_ms() -> f64;
}
