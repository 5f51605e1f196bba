//! Messages of an MCAP file.

use crate::limits::{NoRoom, Room};
use crate::survive::survive;
use mcap::io::MessageReader;
use mcap::sans_io::LinearReaderOptions;
use mcap::{McapError, Message};
use std::io::{BufReader, Read};

/// Bytes that a read asks the system for.
const BUFFER: usize = 1 << 18;

/// The messages of an MCAP file, up to where it is torn or damaged.
pub struct Messages<R> {
    reader: Option<MessageReader<BufReader<R>>>,
    room: Room,
    bytes: u64,
}

/// Why there are no more messages.
#[derive(Debug, thiserror::Error)]
pub enum Torn {
    /// It ends where it should not, or is damaged.
    #[error(transparent)]
    Format(#[from] McapError),
    /// The decoder gave up.
    #[error("a record makes no sense")]
    Nonsense,
    /// There is more in it than may be read.
    #[error(transparent)]
    NoRoom(#[from] NoRoom),
}

impl Torn {
    /// Whether the file ends too early, with nothing wrong before.
    pub fn is_end(&self) -> bool {
        matches!(self, Self::Format(McapError::UnexpectedEof))
    }
}

/// What a message takes besides its data: the head of its record.
const MESSAGE_HEAD: u64 = 31;

impl<R: Read> Messages<R> {
    /// A record is as long as the room at most, whatever length it states.
    pub fn new(file: R, room: Room) -> Self {
        Self::with(file, room, LinearReaderOptions::default())
    }

    /// The same, where a file is held to all that it states: of its chunks, and of all in front of its end.
    pub fn checked(file: R, room: Room) -> Self {
        let options = LinearReaderOptions::default().with_validate_chunk_crcs(true);
        Self::with(file, room, options.with_validate_data_section_crc(true))
    }

    fn with(file: R, room: Room, options: LinearReaderOptions) -> Self {
        let longest = usize::try_from(room.bytes()).unwrap_or(usize::MAX);
        let options = options.with_record_length_limit(longest);
        let reader = MessageReader::new_with_options(BufReader::with_capacity(BUFFER, file), options);
        Self { reader: Some(reader), room, bytes: 0 }
    }

    fn read(&mut self) -> Option<Result<Message<'static>, Torn>> {
        let reader = self.reader.as_mut()?;
        let Some(message) = survive(|| reader.next()) else {
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
