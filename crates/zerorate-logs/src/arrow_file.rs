//! Reads Arrow files, also called Feather: a stream between two magic numbers, and an index, which is not needed.
//!
//! The messages are split by [`Messages`], as in a capture, because the library's own file reader trusts the lengths
//! and offsets in a file.

use crate::open::BUFFER;
use arrow_array::RecordBatch;
use arrow_ipc::reader::StreamDecoder;
use std::io::{self, BufReader, Read, Seek, SeekFrom, Take};
use std::path::{Path, PathBuf};
use zerorate_input::arrows::decode;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::messages::{Message, Messages};
use zerorate_input::table::{BatchSource, Stated};
use zerorate_input::{Input, InputError, InputWarning};

/// The magic number at the start of the file is padded with zeros to a multiple of this, bytes.
const ALIGNMENT: usize = 8;

/// Number of bytes at the start of the file in which the padding must end. Rust's writer pads to 64 bytes.
const MAX_PADDING: u64 = 1024;

/// Size of the end of the file, bytes: the length of the index, and the magic number.
const END: u64 = 4 + MARK.len() as u64;

const MARK: &[u8] = b"ARROW1";

pub struct ArrowFile {
    path: PathBuf,
    /// Offset of the stream in the file.
    start: u64,
    /// Largest possible offset of the end of the stream.
    end: u64,
    /// A second handle of the file, to check the bytes behind the stream.
    rest: Input,
    messages: Messages<BufReader<Take<Input>>>,
    decoder: StreamDecoder,
    room: MemoryBudget,
    stated: Stated,
}

impl ArrowFile {
    pub fn open(path: &Path, mut file: Input, room: MemoryBudget) -> Result<Self, InputError> {
        let failed = |error| InputError::io("read", path, error);
        let wrong = |what: String| InputError::damaged(path, "as an Arrow file", what);
        let end = stream_end(&mut file).map_err(failed)?;
        let start = stream_start(&mut file).map_err(failed)?;
        file.seek(SeekFrom::Start(start)).map_err(failed)?;
        let rest = file.try_clone().map_err(failed)?;
        let stream = BufReader::with_capacity(BUFFER, file.take(end.saturating_sub(start)));
        let mut messages = Messages::new(stream);
        let mut decoder = StreamDecoder::new();
        let Message::Whole(bytes) = messages.next_message().map_err(failed)? else {
            return Err(wrong("it ends inside its schema".to_owned()));
        };
        let schema = bytes.schema().map_err(wrong)?;
        decode(&mut decoder, bytes.into()).map_err(wrong)?;
        let stated = Stated::new(schema);
        Ok(Self { path: path.to_owned(), start, end, rest, messages, decoder, room, stated })
    }

    /// Sets a warning if more than the index of the file follows.
    fn end_of_stream(&mut self) -> Result<(), InputError> {
        self.stated.ended = true;
        let end = self.start + self.messages.position();
        if end < self.end {
            let mark = self.rest.find(MARK, end).map_err(|error| InputError::io("read", &self.path, error))?;
            let end = mark.map_or(end, |at| at + MARK.len() as u64);
            self.stated.warning = InputWarning::behind_end(&self.path, &self.rest, end)?;
        }
        Ok(())
    }
}

/// Offset of the stream, behind the magic number and its padding of zeros. No message begins with zeros.
fn stream_start(file: &mut Input) -> io::Result<u64> {
    let mut head = Vec::new();
    file.rewind()?;
    file.take(MAX_PADDING).read_to_end(&mut head)?;
    let is_padding = |block: &[u8]| block.iter().all(|byte| *byte == 0);
    let padding = head.chunks(ALIGNMENT).skip(1).take_while(|block| is_padding(block)).count();
    Ok((ALIGNMENT * (1 + padding)) as u64)
}

/// Largest possible end of the stream: the start of the index, or the end of a file that was cut off.
fn stream_end(file: &mut Input) -> io::Result<u64> {
    let length = file.length()?;
    let mut end = Vec::new();
    file.seek(SeekFrom::Start(length.saturating_sub(END)))?;
    file.take(END).read_to_end(&mut end)?;
    let index = match end.split_first_chunk() {
        Some((index, MARK)) => u64::from(u32::from_le_bytes(*index)) + END,
        _ => 0,
    };
    Ok(length.saturating_sub(index))
}

impl BatchSource for ArrowFile {
    fn stated(&self) -> &Stated {
        &self.stated
    }

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, InputError> {
        while !self.stated.ended {
            let start = self.start + self.messages.position();
            match self.messages.next_message().map_err(|error| InputError::io("read", &self.path, error))? {
                Message::Whole(bytes) => {
                    let checked = bytes.check(self.room).and_then(|()| decode(&mut self.decoder, bytes.into()));
                    let batch =
                        checked.map_err(|what| InputError::damaged(&self.path, format!("byte {start}"), what))?;
                    if batch.is_some() {
                        return Ok(batch);
                    }
                }
                Message::EndOfStream { .. } => self.end_of_stream()?,
                Message::Torn => {
                    self.stated.ended = true;
                    let path = self.path.display();
                    let text = format!("{path} was not closed: every whole batch is read, what follows is dropped");
                    self.stated.warning = Some(InputWarning::Torn(text));
                }
            }
        }
        Ok(None)
    }
}
