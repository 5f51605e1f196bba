//! The first look at the twin, as the worker of the session calls it.

use super::now_ms;
use crate::first;
use wasm_bindgen::prelude::*;

/// What is seen of a unit of the twin, until there is a session.
#[wasm_bindgen]
pub struct FirstLook(first::FirstLook);

#[wasm_bindgen]
impl FirstLook {
    /// By its keys.
    #[wasm_bindgen(constructor)]
    pub fn new(keys: &str) -> Result<FirstLook, JsError> {
        first::FirstLook::open(keys).map(Self).map_err(|why| JsError::new(&why))
    }

    /// Takes readings for at most so long, ms, as far as their time has come.
    pub fn turn(&mut self, budget_ms: f64) {
        self.0.turn(&mut now_ms, budget_ms);
    }

    /// What is new, for every window; none: nothing.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        self.0.frame()
    }

    /// All there is, for a window that just came.
    pub fn snapshot(&mut self) -> Vec<u8> {
        self.0.snapshot()
    }

    /// How long it was looked at, s of its time.
    pub fn shown_s(&self) -> f64 {
        self.0.shown_s()
    }
}
