//! The reader of logs, for its worker.

use super::{file, now_ms};
use crate::log::LogReader;
use crate::log::message::{LogSettings, NoiseFileCommand};
use serde::Serialize;
use wasm_bindgen::prelude::*;
use zerorate_allan::{Input, Stat, deviations, octaves};
use zerorate_input::limits::{Bytes, set_max_memory};

/// The memory for the columns of a log, of the 4 GiB that a module can have. The analysis needs the rest.
const MAX_MEMORY: Bytes = Bytes(2 << 30);

/// A log and its results so far.
#[wasm_bindgen]
pub struct Log {
    reader: Option<LogReader>,
    looked: String,
}

#[wasm_bindgen]
impl Log {
    /// Reads the worker's file. `settings` is a `LogSettings` in JSON.
    #[wasm_bindgen(constructor)]
    pub fn new(name: &str, length: f64, settings: &str) -> Result<Log, JsError> {
        set_max_memory(MAX_MEMORY);
        let settings: LogSettings = serde_json::from_str(settings)?;
        let (looked, reader) = LogReader::look(name, || file::input(length), &settings);
        Ok(Self { reader, looked: json(&looked)? })
    }

    /// The result of opening the log: a `LogInspection` in JSON.
    pub fn looked(&self) -> String {
        self.looked.clone()
    }

    pub fn left(&self) -> usize {
        self.reader.as_ref().map_or(0, LogReader::left)
    }

    /// Analyses the next column and returns a `LogAxis` in JSON; none if no column is left.
    pub fn analyse(&mut self) -> Result<Option<String>, JsError> {
        let found = self.open()?.analyse().map_err(|why| JsError::new(&why))?;
        found.as_ref().map(json).transpose()
    }

    /// A `LogBias` in JSON; none if the log has no temperature that changes enough, and in each call but the first.
    pub fn bias(&mut self) -> Result<Option<String>, JsError> {
        self.open()?.bias().as_ref().map(json).transpose()
    }

    /// The summary of all columns: a `LogSummary` in JSON.
    pub fn summary(&mut self) -> Result<String, JsError> {
        json(&self.open()?.summary())
    }

    /// Makes the file for a filter, a `Download` in JSON. `command` is a `NoiseFileCommand` in JSON.
    pub fn noise_file(&mut self, command: &str) -> Result<String, JsError> {
        let command: NoiseFileCommand = serde_json::from_str(command)?;
        let file = self.open()?.noise_file(&command).map_err(|why| JsError::new(&why))?;
        json(&file)
    }

    fn open(&mut self) -> Result<&mut LogReader, JsError> {
        self.reader.as_mut().ok_or_else(|| JsError::new("no log has been read yet"))
    }
}

fn json(value: &impl Serialize) -> Result<String, JsError> {
    Ok(serde_json::to_string(value)?)
}

/// Computes the overlapping Allan deviation at octaves for `cargo xtask bench-web`. Returns the duration, ms, and
/// then the deviations. The duration does not include copying the samples into the module.
#[wasm_bindgen]
pub fn oadev(rate: &[f64]) -> Vec<f64> {
    let began_ms = now_ms();
    let found = deviations(&Input::Rate(rate), 1.0, Stat::Oadev, &octaves(rate.len()));
    let took_ms = now_ms() - began_ms;
    std::iter::once(took_ms).chain(found.into_iter().flatten().map(|one| one.dev)).collect()
}
