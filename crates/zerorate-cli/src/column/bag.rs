//! ROS bags: MCAP, and the SQLite databases of ROS 2 before Iron.

use super::imu::{Collector, Encoding, Wanted, is_imu};
use super::{ColumnArgs, Found};
use crate::capture::CaptureError;
use anyhow::Result;
use mcap::io::MessageReader;
use mcap::{Channel, McapError};
use rusqlite::{Connection, OpenFlags, types::ValueRef};
use std::collections::BTreeSet;
use std::fs::File;
use std::io::{BufReader, Seek};
use std::path::Path;

/// Bytes that a read asks the system for.
const BUFFER: usize = 1 << 18;

/// Reads a quantity of the IMU messages of an MCAP file.
pub fn read_mcap(path: &Path, mut file: File, args: &ColumnArgs) -> Result<Found> {
    let topics = mcap_topics(path, &file)?;
    let wanted = Wanted::choose(path, &topics, args.column.as_deref())?;
    let topic = wanted.topic.clone();
    file.rewind().map_err(|error| CaptureError::io("read", path, error))?;
    let mut collector = Collector::new(path, wanted, args);
    let mut warning = None;
    for message in MessageReader::new(BufReader::with_capacity(BUFFER, file)) {
        match message {
            Ok(message) if message.channel.topic == topic => {
                collector.push(encoding(path, &message.channel)?, &message.data)?;
            }
            Ok(_) => {}
            Err(error) => warning = Some(torn(path, &error)),
        }
    }
    Ok(collector.finish(warning))
}

/// The topics with an IMU. Their channels stand anywhere before their first message, so the file is read for them.
fn mcap_topics(path: &Path, file: &File) -> Result<BTreeSet<String>> {
    let mut topics = BTreeSet::new();
    let mut first = true;
    for message in MessageReader::new(BufReader::with_capacity(BUFFER, file)) {
        match message {
            Ok(message) => {
                let schema = message.channel.schema.as_ref();
                if schema.is_some_and(|schema| is_imu(&schema.name)) && !topics.contains(&message.channel.topic) {
                    topics.insert(message.channel.topic.clone());
                }
            }
            Err(error) if first => return Err(CaptureError::damaged(path, "as an MCAP file", error.to_string()).into()),
            // whatever is whole will be read
            Err(_) => {}
        }
        first = false;
    }
    Ok(topics)
}

fn encoding(path: &Path, channel: &Channel<'_>) -> Result<Encoding, CaptureError> {
    Encoding::of(&channel.message_encoding).ok_or_else(|| {
        let what = format!("its messages are encoded in `{}`; cdr and ros1 are read", channel.message_encoding);
        CaptureError::damaged(path, format!("topic {}", channel.topic), what)
    })
}

fn torn(path: &Path, error: &McapError) -> String {
    format!(
        "{} was not closed or is damaged ({error}): what stands before is read, the rest is dropped",
        path.display()
    )
}

/// Reads a quantity of the IMU messages of a SQLite bag, which stands in the file `at` and is called `path` in messages.
pub fn read_sqlite(path: &Path, at: &Path, args: &ColumnArgs) -> Result<Found> {
    let failed = |error: rusqlite::Error| {
        let remedy = "if it is a bag of ROS 2, `ros2 bag convert` or `ros2 bag reindex` may help";
        CaptureError::damaged(path, "as a ROS 2 bag in SQLite", format!("{error}; {remedy}"))
    };
    let bag = Connection::open_with_flags(at, OpenFlags::SQLITE_OPEN_READ_ONLY).map_err(failed)?;
    let topics = sqlite_topics(&bag).map_err(failed)?;
    let names: BTreeSet<String> = topics.iter().map(|(_, name, _)| name.clone()).collect();
    let wanted = Wanted::choose(path, &names, args.column.as_deref())?;
    let ids = topics.iter().filter(|(_, name, _)| *name == wanted.topic);
    let mut collector = Collector::new(path, wanted.clone(), args);
    for (id, topic, format) in ids {
        let encoding = Encoding::of(format).ok_or_else(|| {
            let what = format!("its messages are encoded in `{format}`; cdr is read");
            CaptureError::damaged(path, format!("topic {topic}"), what)
        })?;
        let mut query =
            bag.prepare("SELECT data FROM messages WHERE topic_id = ?1 ORDER BY timestamp, id").map_err(failed)?;
        let mut rows = query.query([id]).map_err(failed)?;
        while let Some(row) = rows.next().map_err(failed)? {
            match row.get_ref(0).map_err(failed)? {
                ValueRef::Blob(message) => collector.push(encoding, message)?,
                other => {
                    let what = format!("a message is of type {}", other.data_type());
                    return Err(CaptureError::damaged(path, format!("topic {topic}"), what).into());
                }
            }
        }
    }
    Ok(collector.finish(None))
}

/// Number, name and format of the topics with an IMU.
fn sqlite_topics(bag: &Connection) -> rusqlite::Result<Vec<(i64, String, String)>> {
    let mut query = bag.prepare("SELECT id, name, type, serialization_format FROM topics")?;
    let topics = query.query_map([], |row| {
        let type_name: String = row.get(2)?;
        Ok((is_imu(&type_name), (row.get(0)?, row.get(1)?, row.get(3)?)))
    })?;
    topics.filter_map(|topic| topic.map(|(is_imu, topic)| is_imu.then_some(topic)).transpose()).collect()
}
