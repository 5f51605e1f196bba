//! The Arrow IPC stream form: the one to record in, because every whole batch in it can be read whatever happens next.

use super::CaptureError;
use super::messages::{Message, Messages};
use super::table::{BatchSink, BatchSource};
use crate::limits::Room;
use crate::survive::survive;
use arrow::array::RecordBatch;
use arrow::buffer::Buffer;
use arrow::datatypes::SchemaRef;
use arrow::ipc::reader::StreamDecoder;
use arrow::ipc::writer::StreamWriter;
use std::fs::File;
use std::io::{BufReader, BufWriter};
use std::path::{Path, PathBuf};

/// A batch of any capture fits in here, so that it reaches the system in one piece.
const WRITE_BUFFER: usize = 1 << 20;

/// Writes a stream.
pub struct Sink {
    path: PathBuf,
    writer: StreamWriter<BufWriter<File>>,
}

impl Sink {
    /// Writes the schema, so that even a capture without a row can be read.
    pub fn create(path: &Path, file: File, schema: &SchemaRef) -> Result<Self, CaptureError> {
        let wrong = |error| CaptureError::arrow("write", path, error);
        let mut writer = StreamWriter::try_new(BufWriter::with_capacity(WRITE_BUFFER, file), schema).map_err(wrong)?;
        writer.flush().map_err(wrong)?;
        Ok(Self { path: path.to_owned(), writer })
    }
}

impl BatchSink for Sink {
    fn write(&mut self, batch: &RecordBatch) -> Result<(), CaptureError> {
        let written = self.writer.write(batch).and_then(|()| self.writer.flush());
        written.map_err(|error| CaptureError::arrow("write", &self.path, error))
    }

    fn finish(mut self: Box<Self>) -> Result<(), CaptureError> {
        let ended = self.writer.finish().and_then(|()| self.writer.flush());
        ended.map_err(|error| CaptureError::arrow("write", &self.path, error))
    }
}

/// Reads a stream, up to the last whole batch.
pub struct Source {
    path: PathBuf,
    messages: Messages<BufReader<File>>,
    decoder: StreamDecoder,
    schema: SchemaRef,
    len: u64,
    room: Room,
    ended: bool,
    warning: Option<String>,
}

impl Source {
    /// Reads the schema.
    pub fn open(path: &Path, file: File) -> Result<Self, CaptureError> {
        let failed = |error| CaptureError::io("read", path, error);
        let len = file.metadata().map_err(failed)?.len();
        let mut messages = Messages::new(BufReader::new(file));
        let mut decoder = StreamDecoder::new();
        let schema = match messages.next().map_err(failed)? {
            Message::Whole(bytes) => {
                let schema = bytes.schema().map_err(|what| CaptureError::not_a_capture(path, what))?;
                decode(&mut decoder, bytes.into()).map_err(|what| CaptureError::not_a_capture(path, what))?;
                schema
            }
            Message::EndOfStream | Message::Torn => {
                return Err(CaptureError::not_a_capture(
                    path,
                    "it ends inside its Arrow schema, so it holds no sample either",
                ));
            }
        };
        Ok(Self {
            path: path.to_owned(),
            messages,
            decoder,
            schema,
            len,
            room: Room::of(len),
            ended: false,
            warning: None,
        })
    }

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, CaptureError> {
        while !self.ended {
            let start = self.messages.position();
            match self.messages.next().map_err(|error| CaptureError::io("read", &self.path, error))? {
                Message::Whole(bytes) => {
                    let checked = bytes.check(self.room).and_then(|()| decode(&mut self.decoder, bytes.into()));
                    let batch =
                        checked.map_err(|what| CaptureError::damaged(&self.path, format!("byte {start}"), what))?;
                    if batch.is_some() {
                        return Ok(batch);
                    }
                }
                Message::EndOfStream => self.end_of_stream(),
                Message::Torn => self.torn(start),
            }
        }
        Ok(None)
    }

    /// The stream was closed; nothing should follow.
    fn end_of_stream(&mut self) {
        self.ended = true;
        let trailing = self.len.saturating_sub(self.messages.position());
        if trailing > 0 {
            self.warning =
                Some(format!("{}: the {trailing} bytes after its end of stream are ignored", self.path.display()));
        }
    }

    /// The file ended before the stream did, in a message that began at `whole`.
    fn torn(&mut self, whole: u64) {
        self.ended = true;
        self.warning = Some(format!(
            "{} was not closed (a power cut?): every whole batch is read, the {} bytes after the last one are dropped",
            self.path.display(),
            self.len.saturating_sub(whole)
        ));
    }
}

/// The batch of a message, if it carries one.
pub fn decode(decoder: &mut StreamDecoder, bytes: Vec<u8>) -> Result<Option<RecordBatch>, String> {
    let decoded = survive(|| decoder.decode(&mut Buffer::from_vec(bytes)));
    decoded.ok_or_else(|| "its batch makes no sense".to_owned())?.map_err(|error| error.to_string())
}

impl Iterator for Source {
    type Item = Result<RecordBatch, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        let batch = self.read_batch().transpose();
        self.ended |= !matches!(batch, Some(Ok(_)));
        batch
    }
}

impl BatchSource for Source {
    fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }

    fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }
}
