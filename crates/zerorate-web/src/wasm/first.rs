//! The first look at the twin, for the worker of the session.

use super::now_ms;
use crate::first;
use wasm_bindgen::prelude::*;

/// The view of a unit of the twin, until there is a session.
#[wasm_bindgen]
pub struct FirstLook(first::FirstLook);

#[wasm_bindgen]
impl FirstLook {
    /// Opens the unit with these keys.
    #[wasm_bindgen(constructor)]
    pub fn new(keys: &str) -> Result<FirstLook, JsError> {
        first::FirstLook::open(keys).map(Self).map_err(|why| JsError::new(&why))
    }

    /// Takes readings whose time has come, for at most this long, ms.
    pub fn turn(&mut self, budget_ms: f64) {
        self.0.turn(&mut now_ms, budget_ms);
    }

    /// The frame with everything that changed, for every window; none if nothing did.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        self.0.frame()
    }

    /// The frame with everything, for a window that just opened.
    pub fn snapshot(&mut self) -> Vec<u8> {
        self.0.snapshot()
    }

    /// How long the twin was looked at, s of its time.
    pub fn shown_s(&self) -> f64 {
        self.0.shown_s()
    }
}
