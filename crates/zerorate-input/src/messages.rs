//! Reads the frames of an Arrow IPC stream: where each message begins and ends, and whether it is complete.
//!
//! The Arrow library decodes the messages, but it trusts their offsets and does not report whether a stream ended
//! properly. Recordings may be cut off, so this module reads the frames.

use crate::catch_panic::catch_panic;
use crate::limits::MemoryBudget;
use arrow_ipc::convert::{metadata_to_fb, try_fb_to_schema};
use arrow_ipc::{self as ipc, MessageArgs, RecordBatchArgs, root_as_message};
use arrow_schema::{Metadata, Schema, SchemaRef};
use flatbuffers::FlatBufferBuilder;
use std::io::{self, Read};
use std::ops::Range;
use std::sync::Arc;

/// The first bytes of every message since Arrow 0.15.
const CONTINUATION: [u8; 4] = [0xFF; 4];

/// The largest alignment to which writers pad buffers, in bytes.
const ALIGNMENT: usize = 64;

/// Reads the messages of a stream.
pub struct Messages<R> {
    reader: R,
    position: u64,
}

/// The message at the reader's position.
pub enum Message {
    /// A message with all its bytes.
    Whole(MessageBytes),
    /// The end-of-stream marker, or zeros that a file system allocated and that were never filled.
    EndOfStream {
        /// True for the marker, false for zeros.
        marked: bool,
    },
    /// The file ends before the stream does.
    Torn,
}

impl<R: Read> Messages<R> {
    /// Reads a stream from its start.
    pub fn new(reader: R) -> Self {
        Self { reader, position: 0 }
    }

    /// Number of bytes read so far.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// Reads the next message, or reports the end of the stream or of the file.
    pub fn next_message(&mut self) -> io::Result<Message> {
        let mut bytes = Vec::new();
        let Some(metadata_len) = self.read_length(&mut bytes)? else {
            return Ok(Message::Torn);
        };
        if metadata_len == 0 {
            return Ok(Message::EndOfStream { marked: bytes.starts_with(&CONTINUATION) });
        }
        let start = bytes.len();
        if !self.append(&mut bytes, u64::from(metadata_len))? {
            return Ok(Message::Torn);
        }
        let metadata = start..bytes.len();
        // a message that cannot be parsed gets no body here, and `MessageBytes::check` reports it
        let body_len = root_as_message(&bytes[metadata.clone()]).map_or(0, |message| message.bodyLength());
        if !self.append(&mut bytes, u64::try_from(body_len).unwrap_or(0))? {
            return Ok(Message::Torn);
        }
        Ok(Message::Whole(MessageBytes { bytes, metadata }))
    }

    fn read_length(&mut self, bytes: &mut Vec<u8>) -> io::Result<Option<u32>> {
        loop {
            if !self.append(bytes, 4)? {
                return Ok(None);
            }
            if *bytes != CONTINUATION {
                return Ok(bytes.last_chunk().map(|length| u32::from_le_bytes(*length)));
            }
        }
    }

    /// Appends `len` bytes; `false` if the file has fewer. A wrong length takes no more memory than the file size.
    fn append(&mut self, bytes: &mut Vec<u8>, len: u64) -> io::Result<bool> {
        let read = (&mut self.reader).take(len).read_to_end(bytes)? as u64;
        self.position += read;
        Ok(read == len)
    }
}

/// The bytes of a whole message: length, metadata, body.
pub struct MessageBytes {
    bytes: Vec<u8>,
    metadata: Range<usize>,
}

impl MessageBytes {
    /// The schema that this message carries.
    pub fn schema(&self) -> Result<SchemaRef, String> {
        let schema = self.message()?.header_as_schema().ok_or("it does not start with an Arrow schema")?;
        // the library would read the bytes of each number in the wrong order
        if schema.endianness() != ipc::Endianness::Little {
            return Err("its numbers are big-endian: write it again on a little-endian machine".to_owned());
        }
        // a schema message has no body: with a wrong length, the next message would count as the body
        if self.bytes.len() > self.metadata.end {
            return Err(format!("its Arrow schema states a body of {} bytes", self.bytes.len() - self.metadata.end));
        }
        let schema: Option<Result<Schema, _>> = catch_panic(|| try_fb_to_schema(schema));
        let schema = schema.ok_or("its Arrow schema makes no sense")?.map_err(|error| error.to_string())?;
        Ok(Arc::new(schema))
    }

    /// Checks what the Arrow library assumes of a batch: its buffers lie inside the message, fit into `room` when
    /// unpacked, and are long enough for the stated rows.
    pub fn check(&self, room: MemoryBudget) -> Result<(), String> {
        let message = self.message()?;
        let body = &self.bytes[self.metadata.end..];
        if usize::try_from(message.bodyLength()) != Ok(body.len()) {
            return Err(format!("a message states a body of {} bytes", message.bodyLength()));
        }
        let dictionary = || message.header_as_dictionary_batch().and_then(|dictionary| dictionary.data());
        let batch = message.header_as_record_batch().or_else(dictionary);
        let batch = batch.ok_or_else(|| "a message is not a batch of rows".to_owned())?;
        let unpacked = check_buffers(batch, body)?;
        room.check(unpacked).map_err(|why| why.to_string())?;
        check_rows(batch, unpacked)
    }

    /// The custom metadata of this message under `key`.
    pub fn note(&self, key: &str) -> Option<String> {
        let notes = self.message().ok()?.custom_metadata()?;
        let note = notes.iter().find(|note| note.key() == Some(key))?;
        note.value().map(str::to_owned)
    }

    /// Number of rows in this message, if it is a batch.
    pub fn rows(&self) -> Option<i64> {
        Some(self.message().ok()?.header_as_record_batch()?.length())
    }

    fn message(&self) -> Result<ipc::Message<'_>, String> {
        root_as_message(&self.bytes[self.metadata.clone()]).map_err(|error| format!("no Arrow message: {error}"))
    }
}

/// Adds custom metadata to a record batch message. The Arrow library cannot write such metadata.
pub fn with_note(message: &[u8], key: &str, value: &str) -> Result<Vec<u8>, String> {
    let message = root_as_message(message).map_err(|error| error.to_string())?;
    let batch = message.header_as_record_batch().ok_or("no record batch")?;
    let mut builder = FlatBufferBuilder::new();
    let nodes: Vec<_> = batch.nodes().into_iter().flatten().copied().collect();
    let buffers: Vec<_> = batch.buffers().into_iter().flatten().copied().collect();
    let nodes = Some(builder.create_vector(&nodes));
    let buffers = Some(builder.create_vector(&buffers));
    let args = RecordBatchArgs { length: batch.length(), nodes, buffers, ..RecordBatchArgs::default() };
    let header = ipc::RecordBatch::create(&mut builder, &args).as_union_value();
    let notes = metadata_to_fb(&mut builder, &Metadata::default().with(key, value));
    let args = MessageArgs {
        version: message.version(),
        header_type: message.header_type(),
        header: Some(header),
        bodyLength: message.bodyLength(),
        custom_metadata: Some(notes),
    };
    let root = ipc::Message::create(&mut builder, &args);
    builder.finish(root, None);
    Ok(builder.finished_data().to_vec())
}

/// Number of bytes in all buffers of a batch, unpacked. It is an error if the body is longer than its buffers, because
/// it then includes the next message.
fn check_buffers(batch: ipc::RecordBatch<'_>, body: &[u8]) -> Result<u64, String> {
    let (mut unpacked, mut used) = (0u64, 0);
    for buffer in batch.buffers().ok_or("a batch without buffers")? {
        let outside = || {
            let (length, offset) = (buffer.length(), buffer.offset());
            format!("a batch refers to {length} bytes at {offset}, outside its own {}", body.len())
        };
        let start = usize::try_from(buffer.offset()).map_err(|_| outside())?;
        let length = usize::try_from(buffer.length()).map_err(|_| outside())?;
        let end = start.checked_add(length).ok_or_else(outside)?;
        let bytes = body.get(start..end).ok_or_else(outside)?;
        used = used.max(end);
        let stated = match (batch.compression(), bytes.first_chunk()) {
            (None, _) => length as i64,
            (Some(_), None) => 0,
            // the unpacked length, or -1 if the buffer is not packed
            (Some(_), Some(stated)) => match i64::from_le_bytes(*stated) {
                -1 => length as i64,
                stated => stated,
            },
        };
        let stated = u64::try_from(stated).map_err(|_| format!("a buffer states {stated} bytes"))?;
        unpacked = unpacked.saturating_add(stated);
    }
    if body.len() > used.next_multiple_of(ALIGNMENT) {
        return Err(format!("a batch of {used} bytes states a body of {}", body.len()));
    }
    Ok(unpacked)
}

/// Refuses a batch that states more rows or nulls in a column than `bytes` can hold at one bit each.
fn check_rows(batch: ipc::RecordBatch<'_>, bytes: u64) -> Result<(), String> {
    let possible = |length: i64| u64::try_from(length).is_ok_and(|length| length <= bytes.saturating_mul(8));
    let nodes = batch.nodes().ok_or("a batch without columns")?;
    if let Some(wrong) = nodes.iter().find(|node| !possible(node.length()) || !possible(node.null_count())) {
        return Err(format!(
            "a batch states {} rows and {} nulls in {bytes} bytes",
            wrong.length(),
            wrong.null_count()
        ));
    }
    Ok(())
}

impl From<MessageBytes> for Vec<u8> {
    fn from(message: MessageBytes) -> Self {
        message.bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a stream with an empty schema in this byte order, and reads the schema back.
    fn schema(endianness: ipc::Endianness) -> Result<SchemaRef, String> {
        let mut builder = FlatBufferBuilder::new();
        let fields = Some(builder.create_vector::<flatbuffers::ForwardsUOffset<ipc::Field<'_>>>(&[]));
        let args = ipc::SchemaArgs { endianness, fields, ..ipc::SchemaArgs::default() };
        let header = Some(ipc::Schema::create(&mut builder, &args).as_union_value());
        let header_type = ipc::MessageHeader::Schema;
        let args = MessageArgs { version: ipc::MetadataVersion::V5, header_type, header, ..MessageArgs::default() };
        let root = ipc::Message::create(&mut builder, &args);
        builder.finish(root, None);
        let message = builder.finished_data();
        let bytes = [&CONTINUATION[..], &(message.len() as u32).to_le_bytes(), message].concat();
        match Messages::new(&bytes[..]).next_message().unwrap() {
            Message::Whole(bytes) => bytes.schema(),
            _ => panic!("a message"),
        }
    }

    /// Arrow for Java wrote a file on a big-endian machine, which was once read with wrong numbers (arrow-testing,
    /// 1.0.0-bigendian).
    #[test]
    fn numbers_of_the_other_byte_order_are_refused() {
        assert!(schema(ipc::Endianness::Little).is_ok());
        let why = schema(ipc::Endianness::Big).unwrap_err();
        assert!(why.contains("big-endian"), "{why}");
    }
}
