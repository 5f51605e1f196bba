//! The session and its device, for their worker.

#[cfg(feature = "wasm-replay")]
use super::file;
use super::now_ms;
use crate::live::{Live, Open};
use crate::session::NoticeText;
#[cfg(feature = "wasm-replay")]
use crate::source::Replay;
use crate::source::{Bridge, Source, TwinSource};
use wasm_bindgen::prelude::*;
use zerorate::Calibration;

/// A session that all windows of the page share.
#[wasm_bindgen]
pub struct LiveSession(Live);

fn twin(keys: &str) -> Open {
    let keys = keys.to_owned();
    Box::new(move |_| Ok(Box::new(TwinSource::open(&keys)?) as Box<dyn Source>))
}

/// Opens the worker's file as a recording. `length` is in bytes.
#[cfg(feature = "wasm-replay")]
fn replay(name: &str, length: f64) -> Open {
    let name = name.to_owned();
    Box::new(move |_| Ok(Box::new(Replay::open(&name, file::input(length))?) as Box<dyn Source>))
}

fn bridge() -> Open {
    Box::new(|now_ms| Ok(Box::new(Bridge::open(now_ms)) as Box<dyn Source>))
}

fn opened(open: Open) -> Result<LiveSession, JsError> {
    Live::open(open, now_ms()).map(LiveSession).map_err(|why| JsError::new(&why))
}

#[wasm_bindgen]
impl LiveSession {
    pub fn of_twin(keys: &str) -> Result<LiveSession, JsError> {
        opened(twin(keys))
    }

    /// The page transfers the bridge's bytes by `received` and `to_send`.
    pub fn of_bridge() -> Result<LiveSession, JsError> {
        opened(bridge())
    }

    pub fn use_twin(&mut self, keys: &str) -> Result<(), JsError> {
        self.instead(twin(keys))
    }

    pub fn use_bridge(&mut self) -> Result<(), JsError> {
        self.instead(bridge())
    }

    /// The stored calibrations as TOML, the newest last.
    pub fn calibrations(&mut self) -> Vec<String> {
        self.0.session.calibrations().map(|calibration| calibration.to_toml()).collect()
    }

    pub fn add_calibration(&mut self, toml: &str) -> Result<String, JsError> {
        self.0.session.add_calibration(toml).map_err(|why| JsError::new(&why))
    }

    pub fn apply(&mut self, id: &str) -> Result<(), JsError> {
        self.0.session.apply(Some(id)).map_err(|why| JsError::new(&why))
    }

    pub fn applied(&mut self) -> Option<String> {
        self.0.session.applied().map(Calibration::id)
    }

    pub fn is_calibrating(&mut self) -> bool {
        self.0.session.method().is_some()
    }

    pub fn note(&mut self, text: &str) {
        self.0.session.note(NoticeText::plain(text));
    }

    pub fn cannot_open(&mut self, why: &str) {
        self.0.session.note(NoticeText::new("cannot-open", why));
    }

    pub fn catch_up(&mut self, shown_s: f64) {
        self.0.catch_up(shown_s, &mut now_ms);
    }

    pub fn turn(&mut self, budget_ms: f64) {
        self.0.turn(&mut now_ms, budget_ms);
    }

    /// Request and answer are JSON.
    pub fn ask(&mut self, request: &str) -> String {
        self.0.ask(request, now_ms())
    }

    pub fn frame(&mut self) -> Option<Vec<u8>> {
        self.0.session.frame()
    }

    pub fn snapshot(&mut self) -> Vec<u8> {
        self.0.session.snapshot()
    }

    pub fn received(&mut self, bytes: &[u8]) {
        self.0.received(bytes, now_ms());
    }

    #[wasm_bindgen(js_name = to_send)]
    pub fn outgoing(&mut self) -> Vec<u8> {
        self.0.to_send()
    }

    pub fn unplugged(&mut self, why: &str) {
        self.0.unplugged(why);
    }

    fn instead(&mut self, open: Open) -> Result<(), JsError> {
        self.0.instead(open, now_ms()).map_err(|why| JsError::new(&why))
    }
}

#[cfg(feature = "wasm-replay")]
#[wasm_bindgen]
impl LiveSession {
    pub fn of_replay(name: &str, length: f64) -> Result<LiveSession, JsError> {
        opened(replay(name, length))
    }

    pub fn use_replay(&mut self, name: &str, length: f64) -> Result<(), JsError> {
        self.instead(replay(name, length))
    }
}
