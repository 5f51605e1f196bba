//! A file that the user gave to the browser. It is read in pieces, never as a whole.

use std::io;
use std::sync::Arc;
use wasm_bindgen::prelude::*;
use zerorate_input::{Input, RemoteBytes};

#[wasm_bindgen]
extern "C" {
    /// Reads bytes of the worker's file, from offset `at` on, into `into`. Returns their number.
    #[wasm_bindgen(js_namespace = zerorate, js_name = readAt, catch)]
    fn read_at(at: f64, into: &mut [u8]) -> Result<u32, JsValue>;
}

/// The file of this worker. A worker has one file at a time.
#[derive(Debug)]
struct File {
    length: u64,
}

impl RemoteBytes for File {
    fn length(&self) -> u64 {
        self.length
    }

    fn read_at(&self, at: u64, into: &mut [u8]) -> io::Result<usize> {
        let read = read_at(at as f64, into).map_err(|why| io::Error::other(words(&why)))?;
        Ok(read as usize)
    }
}

fn words(why: &JsValue) -> String {
    why.as_string().unwrap_or_else(|| "the browser does not give the file's bytes; drop the file again".to_owned())
}

/// The worker's file as an input. `length` is in bytes.
pub fn input(length: f64) -> Input {
    Input::remote(Arc::new(File { length: length as u64 }))
}
