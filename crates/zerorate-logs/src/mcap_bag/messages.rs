//! Reads the messages of an MCAP file.

use crate::open::BUFFER;
use mcap::io::MessageReader;
use mcap::sans_io::{LinearReaderOptions, SummaryReadEvent, SummaryReader, SummaryReaderOptions};
use mcap::{MAGIC, McapError, McapResult, Message, Summary};
use std::collections::BTreeMap;
use std::io::{self, BufReader, ErrorKind, Read, Seek, SeekFrom};
use zerorate_input::Input;
use zerorate_input::catch_panic::catch_panic;
use zerorate_input::limits::{MemoryBudget, OverBudget};

/// Size of the head of a record in bytes: its kind and its length.
const RECORD_HEAD: usize = 9;

/// The kind of the last record.
const FOOTER: u8 = 0x02;

/// The messages of an MCAP file, up to the end of its readable part.
pub struct Messages<R> {
    reader: Option<MessageReader<BufReader<R>>>,
    room: MemoryBudget,
    bytes: u64,
}

/// The reason why there are no more messages.
#[derive(Debug, thiserror::Error)]
pub enum Torn {
    /// The file ends too early, or is damaged.
    #[error(transparent)]
    Format(#[from] McapError),
    /// The decoder panicked.
    #[error("a record makes no sense")]
    Nonsense,
    #[error(transparent)]
    OverBudget(#[from] OverBudget),
}

impl Torn {
    /// True if a check shows that bytes were changed. Earlier messages may then be wrong as well.
    pub fn is_changed(&self) -> bool {
        use McapError::{BadChunkCrc, BadDataCrc, DecompressionError};
        matches!(self, Self::Format(BadChunkCrc { .. } | BadDataCrc { .. } | DecompressionError(_)))
    }
}

/// Size of a message record without the message's data, in bytes.
const MESSAGE_HEAD: u64 = 31;

impl<R: Read> Messages<R> {
    /// Creates a reader. No record may be longer than the memory limit. The reader verifies the checksum of each chunk
    /// after its messages, and the checksum of all data before the footer.
    pub fn new(file: R, room: MemoryBudget) -> Self {
        let longest = usize::try_from(room.bytes()).unwrap_or(usize::MAX);
        let options = LinearReaderOptions::default()
            .with_record_length_limit(longest)
            .with_validate_chunk_crcs(true)
            .with_validate_data_section_crc(true);
        let reader = MessageReader::new_with_options(BufReader::with_capacity(BUFFER, file), options);
        Self { reader: Some(reader), room, bytes: 0 }
    }

    fn read(&mut self) -> Option<Result<Message<'static>, Torn>> {
        let reader = self.reader.as_mut()?;
        let Some(message) = catch_panic(|| reader.next()) else {
            return Some(Err(Torn::Nonsense));
        };
        let message = message?;
        Some(message.map_err(Torn::from).and_then(|message| {
            self.bytes = self.bytes.saturating_add(MESSAGE_HEAD + message.data.len() as u64);
            self.room.check_on_disk(self.bytes)?;
            Ok(message)
        }))
    }
}

/// Offset of the end of a file according to its records; `None` if the file was not closed.
pub fn end(file: &Input) -> io::Result<Option<u64>> {
    let file_length = file.length()?;
    let mut records = BufReader::with_capacity(BUFFER, file.try_clone()?);
    let mut at = MAGIC.len() as u64;
    records.seek(SeekFrom::Start(at))?;
    loop {
        let mut head = [0; RECORD_HEAD];
        match records.read_exact(&mut head) {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => return Ok(None),
            read => read?,
        }
        let [kind, length @ ..] = head;
        let length = u64::from_le_bytes(length);
        let Some(end) = at.checked_add(RECORD_HEAD as u64).and_then(|start| start.checked_add(length)) else {
            return Ok(None);
        };
        if kind == FOOTER {
            return Ok(Some(end.saturating_add(MAGIC.len() as u64)));
        }
        // some file systems refuse to seek far behind the end
        if end > file_length {
            return Ok(None);
        }
        records.seek_relative(length.cast_signed())?;
        at = end;
    }
}

/// The number of messages of each topic that a file states at its end; empty if the file was not closed, or does not
/// state them.
pub fn stated(file: &mut Input, room: MemoryBudget) -> BTreeMap<String, u64> {
    let summary = catch_panic(|| summary(file, room)).and_then(Result::ok).flatten();
    let Some((counts, summary)) = summary.and_then(|summary| Some((summary.stats.clone()?, summary))) else {
        return BTreeMap::new();
    };
    let mut stated = BTreeMap::new();
    for (channel, count) in counts.channel_message_counts {
        if let Some(channel) = summary.channels.get(&channel) {
            *stated.entry(channel.topic.clone()).or_default() += count;
        }
    }
    stated
}

fn summary(file: &mut Input, room: MemoryBudget) -> McapResult<Option<Summary>> {
    let longest = usize::try_from(room.bytes()).unwrap_or(usize::MAX);
    let options = SummaryReaderOptions::default().with_record_length_limit(longest).with_file_size(file.length()?);
    let mut reader = SummaryReader::new_with_options(options);
    file.rewind()?;
    while let Some(event) = reader.next_event() {
        match event? {
            SummaryReadEvent::ReadRequest(bytes) => {
                let read = file.read(reader.insert(bytes))?;
                reader.notify_read(read);
            }
            SummaryReadEvent::SeekRequest(to) => reader.notify_seeked(file.seek(to)?),
        }
    }
    Ok(reader.finish())
}

impl<R: Read> Iterator for Messages<R> {
    type Item = Result<Message<'static>, Torn>;

    fn next(&mut self) -> Option<Self::Item> {
        let message = self.read();
        if !matches!(message, Some(Ok(_))) {
            self.reader = None;
        }
        message
    }
}
