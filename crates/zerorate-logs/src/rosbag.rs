//! Reads bags of ROS 1, version 2.0 (<https://wiki.ros.org/Bags/Format/2.0>): records with a header of named fields,
//! most of them in chunks that may be packed. No library reads bags without mapping the file into memory.

use super::imu_messages::{Collector, Quantities, Sources, without_imu};
use super::message::Encoding;
use super::open::{BUFFER, Log, ROS_BAG};
use super::topics::Survey;
use crate::error::Result;
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
use std::collections::BTreeMap;
use std::io::{self, BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use zerorate_input::catch_panic::catch_panic;
use zerorate_input::limits::{MemoryBudget, OverBudget};
use zerorate_input::{Input, InputError, InputWarning};

/// Longest header of a record in bytes: a connection names a topic and a type.
const MAX_HEAD: u32 = 1 << 16;

const MESSAGE: u8 = 2;
const CHUNK: u8 = 5;
const CHUNK_INFO: u8 = 6;
const CONNECTION: u8 = 7;

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let (path, room) = (log.path, log.room);
    let mut file = BufReader::with_capacity(BUFFER, log.input);
    let (topics, others) = topics(path, &mut file, room)?;
    let mut sources = Sources::default();
    topics.values().for_each(|topic| sources.extend(topic.sources.clone()));
    if !sources.has_imu() {
        return Err(without_imu(path, &others));
    }
    let seen = || survey(&mut Records { path, file: &mut file, room, bytes: 0 }, &topics);
    let wanted = Quantities::choose(path, &sources, asked, seen)?;
    let topic = wanted.source.topic.clone();
    let mut collector = Collector::new(path, wanted, room, asked.args);
    let mut records = Records { path, file: &mut file, room, bytes: 0 };
    let mut stated = None;
    let torn = records.each(false, |record| {
        let is_wanted = |conn: u32| topics.get(&conn).is_some_and(|one| one.name == topic);
        match record.op() {
            Some(MESSAGE) if record.number(b"conn").is_some_and(is_wanted) => {
                collector.push(Encoding::Ros1, &record.data, record.time_ns())?;
            }
            Some(CHUNK_INFO) => {
                let here = record.counts().filter(|(conn, _)| is_wanted(*conn)).map(|(_, count)| u64::from(count));
                stated = Some(stated.unwrap_or(0) + here.sum::<u64>());
            }
            _ => {}
        }
        Ok(())
    })?;
    Ok(collector.finish(torn, stated))
}

struct Topic {
    name: String,
    kind: String,
    sources: Sources,
}

/// The topics with an IMU or a temperature by the number of their connection, and the types of topics without an IMU.
/// A bag that was closed lists its connections behind its chunks. In other bags the connections are in the chunks.
fn topics(path: &Path, file: &mut BufReader<Input>, room: MemoryBudget) -> Result<Topics> {
    let (mut connections, mut others) = (BTreeMap::new(), BTreeMap::new());
    for skip_chunks in [true, false] {
        let torn = Records { path, file, room, bytes: 0 }.each(skip_chunks, |record| {
            let Some((at, topic)) = record.connection() else { return Ok(()) };
            if !topic.sources.has_imu() {
                others.insert(topic.name.clone(), topic.kind.clone());
            }
            if !topic.sources.is_empty() {
                connections.insert(at, topic);
            }
            Ok(())
        })?;
        if torn.is_none() && !(connections.is_empty() && others.is_empty()) {
            break;
        }
    }
    Ok((connections, others))
}

/// Topics by the number of their connection, and types by the name of their topic.
type Topics = (BTreeMap<u32, Topic>, BTreeMap<String, String>);

/// Counts the messages of each IMU in the undamaged part of the file.
fn survey(records: &mut Records<'_>, topics: &BTreeMap<u32, Topic>) -> Survey {
    let mut survey = Survey::default();
    topics.values().for_each(|topic| topic.sources.imus().for_each(|(name, _)| survey.topic(name, &topic.kind)));
    let seen = records.each(false, |record| {
        let topic = record.number(b"conn").and_then(|conn| topics.get(&conn));
        let topic = topic.filter(|_| record.op() == Some(MESSAGE));
        for (topic, (name, source)) in
            topic.into_iter().flat_map(|topic| topic.sources.imus().map(move |imu| (topic, imu)))
        {
            survey.message((name, source), &topic.kind, Some(Encoding::Ros1), &record.data);
        }
        Ok(())
    });
    drop(seen);
    survey
}

struct Record {
    head: Vec<u8>,
    data: Vec<u8>,
}

impl Record {
    fn op(&self) -> Option<u8> {
        field(&self.head, b"op")?.first().copied()
    }

    fn number(&self, name: &[u8]) -> Option<u32> {
        Some(u32::from_le_bytes(*field(&self.head, name)?.first_chunk()?))
    }

    /// The time at which a message was recorded, in ns; 0 if it is not there.
    fn time_ns(&self) -> i64 {
        let time = field(&self.head, b"time").and_then(|time| time.first_chunk::<8>());
        let [s, ns] = time
            .map_or([0; 2], |time| [0, 4].map(|at| time[at..].first_chunk().map_or(0, |n| u32::from_le_bytes(*n))));
        i64::from(s) * 1_000_000_000 + i64::from(ns)
    }

    /// The number of messages of each connection in a chunk, from the index at the end of the bag.
    fn counts(&self) -> impl Iterator<Item = (u32, u32)> {
        let number = |bytes: &[u8; 4]| u32::from_le_bytes(*bytes);
        self.data.as_chunks::<4>().0.as_chunks::<2>().0.iter().map(move |[conn, count]| (number(conn), number(count)))
    }

    /// The number and the topic of a connection; `None` for any other record.
    fn connection(&self) -> Option<(u32, Topic)> {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let conn = self.number(b"conn").filter(|_| self.op() == Some(CONNECTION))?;
        let (name, kind) = (text(field(&self.head, b"topic")?), text(field(&self.data, b"type")?));
        let definition = text(field(&self.data, b"message_definition").unwrap_or_default());
        let sources = Sources::of(&name, &kind, &definition);
        Some((conn, Topic { name, kind, sources }))
    }
}

/// The value of the `wanted` field in a list of `length name=value`.
fn field<'a>(mut fields: &'a [u8], wanted: &[u8]) -> Option<&'a [u8]> {
    loop {
        let (length, rest) = fields.split_first_chunk()?;
        let (field, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        match field.strip_prefix(wanted).and_then(|rest| rest.strip_prefix(b"=")) {
            Some(value) => return Some(value),
            None => fields = rest,
        }
    }
}

struct Records<'a> {
    path: &'a Path,
    file: &'a mut BufReader<Input>,
    room: MemoryBudget,
    /// Number of bytes that were unpacked from chunks so far.
    bytes: u64,
}

/// The reason why there are no more records.
enum Stop {
    /// The file is torn or damaged, as the text says.
    Torn(String),
    /// Another bag of this many bytes follows.
    AnotherBag(u64),
    Failed(InputError),
}

impl From<io::Error> for Stop {
    fn from(error: io::Error) -> Self {
        Self::Torn(match error.kind() {
            io::ErrorKind::UnexpectedEof => "it ends inside a record".to_owned(),
            _ => error.to_string(),
        })
    }
}

impl Records<'_> {
    /// Calls `take` with each record, and with the records in chunks unless `skip_chunks` is set. Returns the warning
    /// about an early end, or about another bag that follows.
    fn each(
        &mut self,
        skip_chunks: bool,
        mut take: impl FnMut(&Record) -> Result<(), InputError>,
    ) -> Result<Option<InputWarning>, InputError> {
        let failed = |error| InputError::io("read", self.path, error);
        self.file.seek(SeekFrom::Start(ROS_BAG.len() as u64)).map_err(failed)?;
        let length = self.file.get_ref().length().map_err(failed)?;
        let stop = loop {
            match self.next(length, skip_chunks, &mut take) {
                Ok(true) => {}
                Ok(false) => return Ok(None),
                Err(stop) => break stop,
            }
        };
        let path = self.path.display();
        match stop {
            Stop::Torn(why) => {
                let text = format!("{path} was not closed or is damaged ({why}); the rest is dropped");
                Ok(Some(InputWarning::Torn(text)))
            }
            Stop::AnotherBag(bytes) => Ok(Some(InputWarning::BytesBehindEnd { path: path.to_string(), bytes })),
            Stop::Failed(error) => Err(error),
        }
    }

    fn next(
        &mut self,
        length: u64,
        skip_chunks: bool,
        take: &mut impl FnMut(&Record) -> Result<(), InputError>,
    ) -> Result<bool, Stop> {
        let here = self.file.stream_position()?;
        if here >= length {
            return Ok(false);
        }
        let head = self.piece(length, Some(MAX_HEAD)).map_err(|why| self.another_bag(here, length).unwrap_or(why))?;
        let mut record = Record { head, data: Vec::new() };
        let op = record.op();
        if !matches!(op, Some(MESSAGE | CONNECTION | CHUNK_INFO)) && (op != Some(CHUNK) || skip_chunks) {
            let length = self.length(length, None)?;
            self.file.seek_relative(length.into())?;
            return Ok(true);
        }
        record.data = self.piece(length, None)?;
        if op == Some(CHUNK) {
            let chunk = self.unpacked(&record)?;
            in_chunk(&chunk, take)?;
        } else {
            take(&record).map_err(Stop::Failed)?;
        }
        Ok(true)
    }

    /// The reason to stop reading, if another bag starts at offset `here`.
    fn another_bag(&self, here: u64, length: u64) -> Option<Stop> {
        let start = self.file.get_ref().bytes_at(here, ROS_BAG.len()).ok()?;
        (&start[..] == ROS_BAG).then_some(Stop::AnotherBag(length - here))
    }

    /// Reads a length, and then that many bytes.
    fn piece(&mut self, end: u64, most: Option<u32>) -> Result<Vec<u8>, Stop> {
        let mut bytes = vec![0; self.length(end, most)? as usize];
        self.file.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    /// Reads a length. Returns an error if it is above `most`, or if fewer bytes follow.
    fn length(&mut self, end: u64, most: Option<u32>) -> Result<u32, Stop> {
        let mut length = [0; 4];
        self.file.read_exact(&mut length)?;
        let length = u32::from_le_bytes(length);
        let left = end.saturating_sub(self.file.stream_position()?);
        if u64::from(length) > left || most.is_some_and(|most| length > most) {
            return Err(Stop::Torn(format!("a record states {length} bytes")));
        }
        Ok(length)
    }

    fn unpacked(&mut self, chunk: &Record) -> Result<Vec<u8>, Stop> {
        let size = chunk.number(b"size").ok_or_else(|| Stop::Torn("a chunk does not state its size".to_owned()))?;
        self.bytes = self.bytes.saturating_add(size.into());
        let no_room = |why: OverBudget| Stop::Failed(InputError::over_budget(self.path, why));
        self.room.check(size.into()).map_err(no_room)?;
        self.room.check_on_disk(self.bytes).map_err(no_room)?;
        let packed = chunk.data.as_slice();
        let mut bytes = Vec::new();
        // one byte more than stated, so that the checksum behind the last byte is read
        let mut unpack = |from: &mut dyn Read| from.take(u64::from(size) + 1).read_to_end(&mut bytes);
        let done = match field(&chunk.head, b"compression") {
            Some(b"none") => return Ok(chunk.data.clone()),
            Some(b"bz2") => catch_panic(|| unpack(&mut bzip2::read::BzDecoder::new(packed))),
            Some(b"lz4") => catch_panic(|| unpack(&mut lz4_flex::frame::FrameDecoder::new(packed))),
            other => {
                let name = String::from_utf8_lossy(other.unwrap_or_default()).into_owned();
                return Err(Stop::Torn(format!("a chunk is packed by `{}`", name.escape_debug())));
            }
        };
        match done {
            Some(Ok(unpacked)) if unpacked == size as usize => Ok(bytes),
            Some(Ok(_)) => Err(Stop::Torn("a chunk does not have the size that it states".to_owned())),
            Some(Err(error)) => Err(Stop::Torn(format!("a chunk cannot be unpacked: {error}"))),
            None => Err(Stop::Torn("a chunk makes no sense".to_owned())),
        }
    }
}

fn in_chunk(mut chunk: &[u8], take: &mut impl FnMut(&Record) -> Result<(), InputError>) -> Result<(), Stop> {
    if chunk.is_empty() {
        return Ok(());
    }
    let mut piece = || {
        let (length, rest) = chunk.split_first_chunk()?;
        let (bytes, rest) = rest.split_at_checked(u32::from_le_bytes(*length) as usize)?;
        chunk = rest;
        Some((bytes.to_vec(), rest.is_empty()))
    };
    loop {
        let torn = || Stop::Torn("a chunk ends inside a record".to_owned());
        let (head, _) = piece().ok_or_else(torn)?;
        let (data, is_last) = piece().ok_or_else(torn)?;
        take(&Record { head, data }).map_err(Stop::Failed)?;
        if is_last {
            return Ok(());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_end_of_a_record_ends_a_chunk() {
        let record = [&2u32.to_le_bytes()[..], b"ab", &1u32.to_le_bytes()[..], b"c"].concat();
        let mut records = 0;
        let mut read = |chunk: &[u8]| {
            in_chunk(chunk, &mut |_| {
                records += 1;
                Ok(())
            })
        };
        assert!(read(&[]).is_ok() && read(&[&record[..], &record].concat()).is_ok());
        let damaged = [&record[..], &u32::MAX.to_le_bytes(), b"more"].concat();
        assert!(matches!(read(&damaged), Err(Stop::Torn(_))) && matches!(read(&record[..7]), Err(Stop::Torn(_))));
        assert_eq!(records, 3);
    }
}
