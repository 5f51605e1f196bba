//! The preview of the twin, for the worker of the session.

use super::now_ms;
use crate::first;
use wasm_bindgen::prelude::*;

/// A preview of a simulated unit, until there is a session.
#[wasm_bindgen]
pub struct FirstLook(first::FirstLook);

#[wasm_bindgen]
impl FirstLook {
    /// Opens the unit with these keys.
    #[wasm_bindgen(constructor)]
    pub fn new(keys: &str) -> Result<FirstLook, JsError> {
        first::FirstLook::open(keys).map(Self).map_err(|why| JsError::new(&why))
    }

    /// Reads the samples that are due, for about `budget_ms`.
    pub fn turn(&mut self, budget_ms: f64) {
        self.0.turn(&mut now_ms, budget_ms);
    }

    /// The frame with all changes, for every window; none if nothing changed.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        self.0.frame()
    }

    /// A complete frame, for a newly opened window.
    pub fn snapshot(&mut self) -> Vec<u8> {
        self.0.snapshot()
    }

    /// Duration of the preview, s of the twin's time.
    pub fn shown_s(&self) -> f64 {
        self.0.shown_s()
    }
}
