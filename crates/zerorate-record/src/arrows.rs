//! The Arrow IPC stream form: the form to record in, because every whole batch in it stays readable.

use super::CaptureError;
use super::blocks::{BatchSource, BlockSink, Out, Stated};
use super::chain::{self, End};
use super::messages::{Message, MessageBytes, Messages, with_note};
use crate::Input;
use crate::catch_panic::catch_panic;
use crate::limits::Room;
use crate::warning::CaptureWarning;
use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::reader::StreamDecoder;
use arrow_ipc::writer::{
    DictionaryTracker, EncodedData, IpcDataGenerator, IpcWriteContext, IpcWriteOptions, StreamWriter, write_message,
};
use arrow_schema::ArrowError;
use arrow_schema::SchemaRef;
use std::io::{self, BufReader, BufWriter, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};

/// A batch of any capture fits in here, so that it reaches the system in one piece.
const WRITE_BUFFER: usize = 1 << 20;

/// Bytes that are looked through at once.
const SCAN: u64 = 1 << 16;

/// Writes a stream.
pub struct StreamSink {
    path: PathBuf,
    schema: SchemaRef,
    writer: StreamWriter<BufWriter<Out>>,
}

impl StreamSink {
    /// Writes the schema, so that even a capture without a row can be read.
    pub fn create(path: &Path, out: Out, schema: &SchemaRef) -> Result<Self, CaptureError> {
        let wrong = |error| CaptureError::arrow("write", path, error);
        let mut writer = StreamWriter::try_new(BufWriter::with_capacity(WRITE_BUFFER, out), schema).map_err(wrong)?;
        writer.flush().map_err(wrong)?;
        Ok(Self { path: path.to_owned(), schema: schema.clone(), writer })
    }
}

impl StreamSink {
    /// A batch in one piece, with what is stated about it.
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
        written.map_err(|error| CaptureError::arrow("write", &self.path, error))
    }
}

impl BlockSink for StreamSink {
    fn write(&mut self, rows: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError> {
        self.write_noted(rows, chain::BATCH, check.unwrap_or_default())
    }

    fn finish(mut self: Box<Self>, _: Option<&str>, end: &End) -> Result<(), CaptureError> {
        self.write_noted(&RecordBatch::new_empty(self.schema.clone()), chain::END, &end.to_text())?;
        let ended = self.writer.finish().and_then(|()| self.writer.flush());
        ended.map_err(|error| CaptureError::arrow("write", &self.path, error))
    }
}

/// Reads a stream, up to the last whole batch.
pub struct StreamReader {
    path: PathBuf,
    messages: Messages<BufReader<Input>>,
    decoder: StreamDecoder,
    /// The same file once more, to look beyond a place that cannot be read.
    rest: Input,
    len: u64,
    room: Room,
    stated: Stated,
}

impl StreamReader {
    /// Reads the schema.
    pub fn open(path: &Path, input: Input) -> Result<Self, CaptureError> {
        let failed = |error| CaptureError::io("read", path, error);
        let len = input.length().map_err(failed)?;
        let room = Room::of(input.stored().map_err(failed)?);
        let rest = input.try_clone().map_err(failed)?;
        let mut messages = Messages::new(BufReader::new(input));
        let mut decoder = StreamDecoder::new();
        let schema = match messages.next_message().map_err(failed)? {
            Message::Whole(bytes) => {
                let schema = bytes.schema().map_err(|what| CaptureError::not_a_capture(path, what))?;
                decode(&mut decoder, bytes.into()).map_err(|what| CaptureError::not_a_capture(path, what))?;
                schema
            }
            Message::EndOfStream { .. } | Message::Torn => {
                return Err(CaptureError::not_a_capture(
                    path,
                    "it ends inside its Arrow schema, so it holds no sample either",
                ));
            }
        };
        Ok(Self { path: path.to_owned(), messages, decoder, rest, len, room, stated: Stated::new(schema) })
    }

    /// The batch of a whole message; none if it is the end or no batch at all.
    fn decode(&mut self, start: u64, bytes: MessageBytes) -> Result<Option<RecordBatch>, CaptureError> {
        let damaged = |what: String| CaptureError::damaged(&self.path, format!("byte {start}"), what);
        if self.stated.end.is_some() {
            return Err(damaged("a message follows behind the end of the capture".to_owned()));
        }
        bytes.check(self.room).map_err(damaged)?;
        if let Some(end) = bytes.note(chain::END) {
            let stated = End::parse(&end).filter(|_| bytes.rows() == Some(0));
            self.stated.end = Some(stated.ok_or_else(|| damaged(format!("its end is malformed: {end}")))?);
            return Ok(None);
        }
        self.stated.check = bytes.note(chain::BATCH);
        decode(&mut self.decoder, bytes.into()).map_err(damaged)
    }

    /// The stream was closed; nothing should follow.
    fn end_of_stream(&mut self) -> Result<(), CaptureError> {
        self.stated.ended = true;
        self.stated.warning = CaptureWarning::behind_end(&self.path, &self.rest, self.messages.position())?;
        Ok(())
    }

    /// The file ended before the stream did, in a message that began at `whole`. Only one message can be torn: where
    /// others follow, the file is damaged here.
    fn torn(&mut self, whole: u64) -> Result<(), CaptureError> {
        let follow =
            checks_from(&mut self.rest, whole).map_err(|error| CaptureError::io("read", &self.path, error))?;
        if follow > 1 {
            let what = "a message states a wrong length, for others follow within it";
            return Err(CaptureError::damaged(&self.path, format!("byte {whole}"), what));
        }
        (self.stated.ended, self.stated.torn) = (true, true);
        let (path, dropped) = (self.path.display(), self.len.saturating_sub(whole));
        let text = format!("{path} was not closed; the {dropped} bytes after its last whole batch are dropped");
        self.stated.warning = Some(CaptureWarning::Torn(text));
        Ok(())
    }
}

/// The number of messages from `start` on that carry a check.
fn checks_from(input: &mut Input, start: u64) -> io::Result<usize> {
    let mark = chain::CHECKS.as_bytes();
    input.seek(SeekFrom::Start(start))?;
    let mut seen = Vec::new();
    let mut found = 0;
    while input.take(SCAN).read_to_end(&mut seen)? > 0 {
        found += seen.windows(mark.len()).filter(|window| *window == mark).count();
        // a mark may lie across two pieces
        seen.drain(..seen.len().saturating_sub(mark.len() - 1));
    }
    Ok(found)
}

/// The batch of a message, if it carries one.
pub fn decode(decoder: &mut StreamDecoder, bytes: Vec<u8>) -> Result<Option<RecordBatch>, String> {
    let decoded = catch_panic(|| decoder.decode(&mut Buffer::from_vec(bytes)));
    decoded.ok_or_else(|| "its batch makes no sense".to_owned())?.map_err(|error| error.to_string())
}

impl BatchSource for StreamReader {
    fn form(&self) -> &'static str {
        "Arrow stream"
    }

    fn stated(&self) -> &Stated {
        &self.stated
    }

    fn stated_mut(&mut self) -> &mut Stated {
        &mut self.stated
    }

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, CaptureError> {
        while !self.stated.ended {
            let start = self.messages.position();
            match self.messages.next_message().map_err(|error| CaptureError::io("read", &self.path, error))? {
                Message::Whole(bytes) => {
                    if let Some(batch) = self.decode(start, bytes)? {
                        return Ok(Some(batch));
                    }
                }
                Message::EndOfStream { marked: true } => self.end_of_stream()?,
                Message::EndOfStream { marked: false } | Message::Torn => self.torn(start)?,
            }
        }
        Ok(None)
    }
}
