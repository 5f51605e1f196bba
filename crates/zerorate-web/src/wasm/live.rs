//! The session with its device, as its worker calls it.

#[cfg(feature = "wasm-replay")]
use super::file;
use super::now_ms;
use crate::live::{Live, Open};
use crate::session::{Said, Session};
#[cfg(feature = "wasm-replay")]
use crate::source::Replay;
use crate::source::{Bridge, Source, TwinSource};
use wasm_bindgen::prelude::*;
use zerorate::Calibration;

/// A session that every window of the page looks at.
#[wasm_bindgen]
pub struct LiveSession(Live);

fn twin(keys: &str) -> Open {
    let keys = keys.to_owned();
    Box::new(move |_| Ok(Box::new(TwinSource::open(&keys)?) as Box<dyn Source>))
}

/// The worker's file, of this name and length.
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
    /// With a unit of the twin.
    pub fn of_twin(keys: &str) -> Result<LiveSession, JsError> {
        opened(twin(keys))
    }

    /// With a bridge, whose bytes come and go by `received` and `to_send`.
    pub fn of_bridge() -> Result<LiveSession, JsError> {
        opened(bridge())
    }

    /// The same session with a unit of the twin instead.
    pub fn use_twin(&mut self, keys: &str) -> Result<(), JsError> {
        self.instead(twin(keys))
    }

    /// The same with a bridge.
    pub fn use_bridge(&mut self) -> Result<(), JsError> {
        self.instead(bridge())
    }

    /// The calibrations on file, as TOML, the newest last.
    pub fn calibrations(&mut self) -> Vec<String> {
        self.session().calibrations().map(|calibration| calibration.to_toml()).collect()
    }

    /// Puts a calibration that the page kept on file; its id.
    pub fn add_calibration(&mut self, toml: &str) -> Result<String, JsError> {
        self.session().add_calibration(toml).map_err(|why| JsError::new(&why))
    }

    /// Applies one that is on file.
    pub fn apply(&mut self, id: &str) -> Result<(), JsError> {
        self.session().apply(Some(id)).map_err(|why| JsError::new(&why))
    }

    /// The id of the one that is applied.
    pub fn applied(&mut self) -> Option<String> {
        self.session().applied().map(Calibration::id)
    }

    /// Whether a calibration is under way.
    pub fn is_calibrating(&mut self) -> bool {
        self.session().method().is_some()
    }

    /// Something that the page has to say.
    pub fn note(&mut self, text: &str) {
        self.session().note(Said::plain(text));
    }

    /// What was to be opened cannot be.
    pub fn cannot_open(&mut self, why: &str) {
        self.session().note(Said::new("cannot-open", why));
    }

    /// Goes on where a first look at the same unit is, so long after its first reading, s.
    pub fn catch_up(&mut self, shown_s: f64) {
        self.0.catch_up(shown_s, &mut now_ms);
    }

    /// Takes readings for at most so long, ms, as far as their time has come.
    pub fn turn(&mut self, budget_ms: f64) {
        self.0.turn(&mut now_ms, budget_ms);
    }

    /// The answer to a request; both are text.
    pub fn ask(&mut self, request: &str) -> String {
        self.0.ask(request, now_ms())
    }

    /// What is new, for every window; none: nothing.
    pub fn frame(&mut self) -> Option<Vec<u8>> {
        self.session().frame()
    }

    /// All there is, for a window that just came.
    pub fn snapshot(&mut self) -> Vec<u8> {
        self.session().snapshot()
    }

    /// What came through the serial port.
    pub fn received(&mut self, bytes: &[u8]) {
        self.0.received(bytes, now_ms());
    }

    /// What is to be written to it.
    #[wasm_bindgen(js_name = to_send)]
    pub fn outgoing(&mut self) -> Vec<u8> {
        self.0.to_send()
    }

    /// The serial port is gone, and why.
    pub fn unplugged(&mut self, why: &str) {
        self.0.unplugged(why);
    }

    fn instead(&mut self, open: Open) -> Result<(), JsError> {
        self.0.instead(open, now_ms()).map_err(|why| JsError::new(&why))
    }

    fn session(&mut self) -> &mut Session {
        self.0.session()
    }
}

#[cfg(feature = "wasm-replay")]
#[wasm_bindgen]
impl LiveSession {
    /// With a recording: the worker's file.
    pub fn of_replay(name: &str, length: f64) -> Result<LiveSession, JsError> {
        opened(replay(name, length))
    }

    /// The same session with a recording instead.
    pub fn use_replay(&mut self, name: &str, length: f64) -> Result<(), JsError> {
        self.instead(replay(name, length))
    }
}
