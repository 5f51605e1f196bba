//! The preview of the twin, for the worker of the session.

use super::now_ms;
use crate::first;
use wasm_bindgen::prelude::*;

/// A preview of a simulated unit, until there is a session.
#[wasm_bindgen]
pub struct FirstLook(first::FirstLook);

#[wasm_bindgen]
impl FirstLook {
    #[wasm_bindgen(constructor)]
    pub fn new(keys: &str) -> Result<FirstLook, JsError> {
        first::FirstLook::open(keys).map(Self).map_err(|why| JsError::new(&why))
    }

    pub fn turn(&mut self, budget_ms: f64) {
        self.0.turn(&mut now_ms, budget_ms);
    }

    pub fn frame(&mut self) -> Option<Vec<u8>> {
        self.0.frame()
    }

    pub fn snapshot(&mut self) -> Vec<u8> {
        self.0.snapshot()
    }

    pub fn shown_s(&self) -> f64 {
        self.0.shown_s()
    }
}
