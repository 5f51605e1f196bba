//! Reads the MCAP form.

use super::cdr::Fields;
use super::messages::decode;
use super::{CHECKS, SAMPLES};
use crate::CaptureError;
use crate::Input;
use crate::blocks::cut_off;
use crate::blocks::{BatchSource, MCAP_MARK, Stated};
use crate::chain::{self, End};
use crate::columns::{MAX_ROWS, OpenBatch};
use crate::info::CaptureInfo;
use crate::layout::Layout;
use crate::limits::Room;
use crate::mcap_messages::{Messages, Torn};
use crate::warning::CaptureWarning;
use arrow_array::RecordBatch;
use arrow_schema::{Metadata, Schema};
use mcap::Message;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Reads the rows of the capture in an MCAP file.
pub struct McapReader {
    path: PathBuf,
    messages: Messages<Input>,
    /// The first message of the capture, with which its description came.
    first: Option<Message<'static>>,
    layout: Layout,
    rows: OpenBatch,
    /// The file ends as one that was closed.
    is_closed: bool,
    stated: Stated,
}

/// The meaning of a message for the capture.
enum Entry {
    Row,
    Check(String),
    End(End),
    /// A message of other software.
    Other,
    /// The file ends.
    Nothing,
}

impl McapReader {
    /// Reads up to the first message of the capture.
    pub fn open(path: &Path, mut input: Input) -> Result<Self, CaptureError> {
        let failed = |error| CaptureError::io("read", path, error);
        let room = Room::of(input.length().map_err(failed)?);
        let is_closed = is_closed(&mut input).map_err(failed)?;
        let mut messages = Messages::new(input, room);
        let first = messages.by_ref().find(|message| !message.as_ref().is_ok_and(|message| !is_capture(message)));
        let first = match first {
            Some(Ok(first)) => first,
            Some(Err(error)) => return Err(broken(path, "its beginning", error)),
            None => {
                return Err(CaptureError::not_a_capture(
                    path,
                    format!("it is an MCAP file without the topic {SAMPLES}"),
                ));
            }
        };
        let described = first.channel.metadata.iter().filter(|(key, _)| key.starts_with("zerorate."));
        let metadata: Metadata = described.map(|(key, value)| (key.clone(), value.clone())).collect();
        let layout = CaptureInfo::from_metadata(path, &metadata)?.layout;
        let schema = Arc::new(Schema::new(layout.raw_fields()).with_metadata(metadata));
        Ok(Self {
            path: path.to_owned(),
            messages,
            first: Some(first),
            rows: OpenBatch::new(&layout),
            layout,
            is_closed,
            stated: Stated::new(schema),
        })
    }

    fn read_entry(&mut self, rows: usize) -> Result<Entry, CaptureError> {
        let message = match self.first.take().map(Ok).or_else(|| self.messages.next()) {
            None => return Ok(Entry::Nothing),
            Some(Err(error)) if error.is_end() => {
                let path = || self.path.display().to_string();
                self.stated.warning = self.stated.end.is_some().then(|| CaptureWarning::NoIndex { path: path() });
                return Ok(Entry::Nothing);
            }
            Some(Err(error)) => return Err(broken(&self.path, "its messages", error)),
            Some(Ok(message)) => message,
        };
        match message.channel.topic.as_str() {
            SAMPLES if rows == MAX_ROWS => Err(self.damaged("a check is missing among its rows")),
            SAMPLES => {
                let row = decode(&self.layout, &message.data);
                let row = row.ok_or_else(|| self.damaged("a message is not a row of this capture"))?;
                self.rows.push(&row);
                Ok(Entry::Row)
            }
            CHECKS => statement(&message.data).ok_or_else(|| self.damaged("what it states is malformed")),
            _ => Ok(Entry::Other),
        }
    }

    fn damaged(&self, what: &str) -> CaptureError {
        CaptureError::damaged(&self.path, "messages of the capture", what)
    }

    fn torn(&mut self, rows: usize) -> Result<(), CaptureError> {
        if self.is_closed {
            return Err(self.damaged("it was closed, and some of them are missing or cannot be read"));
        }
        self.stated.torn = true;
        self.stated.warning = Some(cut_off(&self.path, rows));
        Ok(())
    }
}

impl BatchSource for McapReader {
    fn form(&self) -> &'static str {
        "MCAP"
    }

    fn stated(&self) -> &Stated {
        &self.stated
    }

    fn stated_mut(&mut self) -> &mut Stated {
        &mut self.stated
    }

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, CaptureError> {
        let mut rows = 0;
        self.stated.check = None;
        while !self.stated.ended && self.stated.check.is_none() {
            match self.read_entry(rows)? {
                Entry::Row if self.stated.end.is_some() => return Err(self.damaged("rows follow behind its end")),
                Entry::Row => rows += 1,
                Entry::Check(_) if rows == 0 => return Err(self.damaged("a check without rows")),
                Entry::Check(check) => self.stated.check = Some(check),
                Entry::End(_) if rows > 0 => return Err(self.damaged("the check of its last rows is missing")),
                Entry::End(end) => self.stated.end = Some(end),
                Entry::Other => {}
                Entry::Nothing => self.stated.ended = true,
            }
        }
        if self.stated.ended && self.stated.end.is_none() {
            self.torn(rows)?;
            return Ok(None);
        }
        if rows == 0 {
            return Ok(None);
        }
        let batch = self.rows.close().and_then(|columns| RecordBatch::try_new(self.stated.schema.clone(), columns));
        batch.map(Some).map_err(|error| CaptureError::arrow("read", &self.path, error))
    }

    fn may_be_stripped(&self) -> bool {
        false
    }
}

/// Whether it ends with what stands at the end of every MCAP file; leaves it at its start.
fn is_closed(input: &mut Input) -> io::Result<bool> {
    let mut end = Vec::new();
    if input.length()? >= MCAP_MARK.len() as u64 {
        input.seek(SeekFrom::End(-(MCAP_MARK.len() as i64)))?;
        input.read_to_end(&mut end)?;
    }
    input.rewind()?;
    Ok(end == MCAP_MARK)
}

fn is_capture(message: &Message<'_>) -> bool {
    matches!(message.channel.topic.as_str(), SAMPLES | CHECKS)
}

/// The statement in a text; none if the text is malformed.
fn statement(message: &[u8]) -> Option<Entry> {
    match Fields::of(message)?.text()?.split_once(" = ")? {
        (chain::BATCH, check) => Some(Entry::Check(check.to_owned())),
        (chain::END, end) => End::parse(end).map(Entry::End),
        _ => Some(Entry::Other),
    }
}

fn broken(path: &Path, place: &str, error: Torn) -> CaptureError {
    match error {
        Torn::NoRoom(why) => CaptureError::no_room(path, why),
        error => CaptureError::damaged(path, place, error.to_string()),
    }
}
