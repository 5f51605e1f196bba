//! Writes a capture as an Arrow IPC stream.

use crate::CaptureError;
use crate::blocks::{BlockSink, Out};
use crate::chain::End;
use arrow_array::RecordBatch;
use arrow_ipc::writer::{
    DictionaryTracker, EncodedData, IpcDataGenerator, IpcWriteContext, IpcWriteOptions, StreamWriter, write_message,
};
use arrow_schema::{ArrowError, SchemaRef};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use zerorate_input::InputError;
use zerorate_input::messages::with_note;
use zerorate_input::table::{BATCH_CHECK, END};

/// Size of the write buffer, bytes. A batch of raw columns fits, so that it reaches the operating system in one
/// write.
const WRITE_BUFFER: usize = 1 << 20;

pub struct StreamSink {
    path: PathBuf,
    schema: SchemaRef,
    writer: StreamWriter<BufWriter<Out>>,
}

impl StreamSink {
    /// Starts the stream by writing the schema, so that even a capture without rows can be read.
    pub fn create(path: &Path, out: Out, schema: &SchemaRef) -> Result<Self, CaptureError> {
        let wrong = |error| InputError::arrow("write", path, error);
        let mut writer = StreamWriter::try_new(BufWriter::with_capacity(WRITE_BUFFER, out), schema).map_err(wrong)?;
        writer.flush().map_err(wrong)?;
        Ok(Self { path: path.to_owned(), schema: schema.clone(), writer })
    }

    /// Writes a batch whose message carries the metadata entry `key` = `note`, and flushes it.
    fn write_noted(&mut self, batch: &RecordBatch, key: &str, note: &str) -> Result<(), CaptureError> {
        let options = IpcWriteOptions::default();
        let mut no_dictionaries = DictionaryTracker::new(true);
        let written = IpcDataGenerator::default()
            .encode(batch, &mut no_dictionaries, &options, &mut IpcWriteContext::default())
            .and_then(|(_, EncodedData { ipc_message, arrow_data })| {
                let ipc_message = with_note(&ipc_message, key, note).map_err(ArrowError::IpcError)?;
                write_message(self.writer.get_mut(), EncodedData { ipc_message, arrow_data }, &options)
            })
            .and_then(|_| self.writer.flush());
        written.map_err(|error| InputError::arrow("write", &self.path, error).into())
    }
}

impl BlockSink for StreamSink {
    fn write(&mut self, rows: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError> {
        self.write_noted(rows, BATCH_CHECK, check.unwrap_or_default())
    }

    fn finish(mut self: Box<Self>, _: Option<&str>, end: &End) -> Result<(), CaptureError> {
        self.write_noted(&RecordBatch::new_empty(self.schema.clone()), END, &end.to_text())?;
        let ended = self.writer.finish().and_then(|()| self.writer.flush());
        ended.map_err(|error| InputError::arrow("write", &self.path, error).into())
    }
}
