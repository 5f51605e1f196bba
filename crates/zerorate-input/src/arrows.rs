//! Reads Arrow IPC streams, the format of recordings. All whole batches stay readable if a stream is cut off.

use crate::catch_panic::catch_panic;
use crate::limits::MemoryBudget;
use crate::messages::{Message, MessageBytes, Messages};
use crate::table::{BATCH_CHECK, BatchSource, CHECKS, END, Stated};
use crate::{Input, InputError, InputWarning};
use arrow_array::RecordBatch;
use arrow_buffer::Buffer;
use arrow_ipc::reader::StreamDecoder;
use std::io::BufReader;
use std::path::{Path, PathBuf};

/// Reads a recording batch by batch, up to the last whole batch.
pub struct StreamReader {
    path: PathBuf,
    messages: Messages<BufReader<Input>>,
    decoder: StreamDecoder,
    /// A second handle of the same file, to search what is behind the end or a message that is cut off.
    rest: Input,
    len: u64,
    room: MemoryBudget,
    stated: Stated,
}

impl StreamReader {
    /// Opens a stream and reads its schema.
    pub fn open(path: &Path, input: Input) -> Result<Self, InputError> {
        let failed = |error| InputError::io("read", path, error);
        let len = input.length().map_err(failed)?;
        let room = MemoryBudget::of(input.stored().map_err(failed)?);
        let rest = input.try_clone().map_err(failed)?;
        let mut messages = Messages::new(BufReader::new(input));
        let mut decoder = StreamDecoder::new();
        let schema = match messages.next_message().map_err(failed)? {
            Message::Whole(bytes) => {
                let schema = bytes.schema().map_err(|what| InputError::not_a_log(path, what))?;
                decode(&mut decoder, bytes.into()).map_err(|what| InputError::not_a_log(path, what))?;
                schema
            }
            Message::EndOfStream { .. } | Message::Torn => {
                return Err(InputError::not_a_log(
                    path,
                    "it ends inside its Arrow schema, so it holds no sample either",
                ));
            }
        };
        Ok(Self { path: path.to_owned(), messages, decoder, rest, len, room, stated: Stated::new(schema) })
    }

    /// Decodes the message that starts at byte `start`. Returns `None` for the end statement or a message without
    /// batch.
    fn decode(&mut self, start: u64, bytes: MessageBytes) -> Result<Option<RecordBatch>, InputError> {
        let damaged = |what: String| InputError::damaged(&self.path, format!("byte {start}"), what);
        if self.stated.end.is_some() {
            return Err(damaged("a message follows behind the end of the capture".to_owned()));
        }
        bytes.check(self.room).map_err(damaged)?;
        if let Some(end) = bytes.note(END) {
            if bytes.rows() != Some(0) {
                return Err(damaged("its end is malformed: it has rows".to_owned()));
            }
            self.stated.end = Some(end);
            return Ok(None);
        }
        self.stated.check = bytes.note(BATCH_CHECK);
        decode(&mut self.decoder, bytes.into()).map_err(damaged)
    }

    fn end_of_stream(&mut self) -> Result<(), InputError> {
        self.stated.ended = true;
        self.stated.warning = InputWarning::behind_end(&self.path, &self.rest, self.messages.position())?;
        Ok(())
    }

    /// Marks the stream as cut off inside the message that starts at byte `whole`. Returns an error if further
    /// messages follow: then the file was not cut off, and this message states a wrong length.
    fn torn(&mut self, whole: u64) -> Result<(), InputError> {
        // every batch of a recording carries a check, and this one may still have its own
        let check = |from| self.rest.find(CHECKS.as_bytes(), from);
        let second = check(whole).and_then(|first| first.map_or(Ok(None), |first| check(first + 1)));
        if second.map_err(|error| InputError::io("read", &self.path, error))?.is_some() {
            let what = "a message states a wrong length, for others follow within it";
            return Err(InputError::damaged(&self.path, format!("byte {whole}"), what));
        }
        (self.stated.ended, self.stated.torn) = (true, true);
        let (path, dropped) = (self.path.display(), self.len.saturating_sub(whole));
        let text = format!("{path} was not closed; the {dropped} bytes after its last whole batch are dropped");
        self.stated.warning = Some(InputWarning::Torn(text));
        Ok(())
    }
}

/// Decodes one message of a stream; `None` if it holds no batch.
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

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, InputError> {
        while !self.stated.ended {
            let start = self.messages.position();
            match self.messages.next_message().map_err(|error| InputError::io("read", &self.path, error))? {
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
