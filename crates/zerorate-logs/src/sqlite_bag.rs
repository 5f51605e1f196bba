//! Reads ROS bags in SQLite, the default format of ROS 2 before Iron.

use super::imu_messages::{Collector, Quantities, Sources, without_imu};
use super::message::Encoding;
use super::open::Log;
use super::topics::Survey;
use crate::error::Result;
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
use rusqlite::config::DbConfig;
use rusqlite::limits::Limit;
use rusqlite::{Connection, OpenFlags, types::ValueRef};
use std::io::Seek;
use zerorate_input::{Input, InputError, InputWarning};

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let (path, room) = (log.path, log.room);
    let failed = |error: rusqlite::Error| {
        let remedy = "if it is a bag of ROS 2, `ros2 bag convert` or `ros2 bag reindex` may help";
        InputError::damaged(path, "as a ROS 2 bag in SQLite", format!("{error}; {remedy}"))
    };
    let behind = end(&log.input).map(|end| InputWarning::behind_end(path, &log.input, end)).transpose()?.flatten();
    let bag = open(log, failed)?;
    let topics = topics_of(&bag).map_err(failed)?;
    let mut sources = Sources::default();
    topics.iter().for_each(|topic| sources.extend(topic.sources.clone()));
    if !sources.has_imu() {
        return Err(without_imu(path, &topics.into_iter().map(|topic| (topic.name, topic.kind)).collect()));
    }
    let wanted = Quantities::choose(path, &sources, asked, || survey(&bag, &topics))?;
    let ids = topics.iter().filter(|topic| topic.name == wanted.source.topic);
    let mut collector = Collector::new(path, wanted.clone(), room, asked.args);
    for Topic { id, name: topic, format, .. } in ids {
        let encoding = Encoding::of(format).ok_or_else(|| {
            let what = format!("its messages are encoded in `{format}`; cdr is read");
            InputError::damaged(path, format!("topic {topic}"), what)
        })?;
        let mut query = bag
            .prepare("SELECT data, timestamp FROM messages WHERE topic_id = ?1 ORDER BY timestamp, id")
            .map_err(failed)?;
        let mut rows = query.query([id]).map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            match row.get_ref(0).map_err(failed)? {
                ValueRef::Blob(message) => collector.push(encoding, message, row.get(1).unwrap_or_default())?,
                other => {
                    let what = format!("a message is of type {}", other.data_type());
                    return Err(InputError::damaged(path, format!("topic {topic}"), what).into());
                }
            }
        }
    }
    Ok(collector.finish(behind, None))
}

/// The end of the database, from the number of pages in its header. `None` if the database was last written by an old
/// version of SQLite, which does not state the number.
fn end(input: &Input) -> Option<u64> {
    let head = input.bytes_at(0, 100).ok()?;
    let number = |at: usize| head[at..].first_chunk().map_or(0, |bytes| u32::from_be_bytes(*bytes));
    let page = match u64::from(u16::from_be_bytes([head[16], head[17]])) {
        1 => 1 << 16,
        page => page,
    };
    let (changes, valid_for) = (number(24), number(92));
    (changes == valid_for).then(|| u64::from(number(28)) * page).filter(|end| *end > 0)
}

/// Opens a bag as plain tables, because its schema is a program from an untrusted source.
fn open(log: Log<'_>, failed: impl Fn(rusqlite::Error) -> InputError) -> Result<Connection, InputError> {
    let bag = if !log.input.has_name() {
        // a database is opened by its name, and an unpacked one has none
        let length = log.input.length().map_err(|error| InputError::io("read", log.path, error))?;
        log.room.check(length).map_err(|why| InputError::over_budget(log.path, why))?;
        let mut bag = Connection::open_in_memory().map_err(&failed)?;
        let mut input = log.input;
        input.rewind().map_err(|error| InputError::io("read", log.path, error))?;
        bag.deserialize_read_exact("main", input, length as usize, true).map_err(&failed)?;
        bag
    } else {
        Connection::open_with_flags(log.path, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(&failed)?
    };
    // a view may compute without end, and a generated column may be as long as a blob can be
    bag.set_db_config(DbConfig::SQLITE_DBCONFIG_ENABLE_VIEW, false).map_err(&failed)?;
    bag.set_db_config(DbConfig::SQLITE_DBCONFIG_TRUSTED_SCHEMA, false).map_err(&failed)?;
    let longest = i32::try_from(log.room.bytes()).unwrap_or(i32::MAX);
    bag.set_limit(Limit::SQLITE_LIMIT_LENGTH, longest).map_err(&failed)?;
    Ok(bag)
}

struct Topic {
    id: i64,
    name: String,
    kind: String,
    format: String,
    sources: Sources,
}

fn topics_of(bag: &Connection) -> rusqlite::Result<Vec<Topic>> {
    let mut query = bag.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let topics = query.query_map([], |row| {
        let (name, kind): (String, String) = (row.get(1)?, row.get(2)?);
        let sources = Sources::of(&name, &kind, &definition(bag, &kind));
        Ok(Topic { id: row.get(0)?, name, kind, format: row.get(3)?, sources })
    })?;
    topics.collect()
}

/// The definition of a message type, which bags contain since Iron.
fn definition(bag: &Connection, kind: &str) -> String {
    let query = "SELECT encoded_message_definition FROM message_definitions WHERE topic_type = ?1";
    bag.query_row(query, [kind], |row| row.get(0)).unwrap_or_default()
}

/// Counts the messages of each IMU, as far as they can be read.
fn survey(bag: &Connection, topics: &[Topic]) -> Survey {
    let mut survey = Survey::default();
    for Topic { id, kind, format, sources, .. } in topics {
        sources.imus().for_each(|(name, _)| survey.topic(name, kind));
        let Ok(mut query) = bag.prepare("SELECT data FROM messages WHERE topic_id = ?1") else { continue };
        let Ok(mut rows) = query.query([id]) else { continue };
        while let Ok(Some(row)) = rows.next() {
            if let Ok(ValueRef::Blob(message)) = row.get_ref(0) {
                sources
                    .imus()
                    .for_each(|(name, imu)| survey.message((name, imu), kind, Encoding::of(format), message));
            }
        }
    }
    survey
}
