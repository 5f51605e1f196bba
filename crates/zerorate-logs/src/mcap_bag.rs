//! Reads ROS bags in MCAP format.

mod messages;

use super::imu_messages::{Collector, Quantities, Sources, without_imu};
use super::message::Encoding;
use super::open::Log;
use super::topics::Survey;
use crate::error::Result;
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
use mcap::Channel;
use messages::{Messages, Torn};
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};
use std::io::Seek;
use std::path::Path;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{Input, InputError, InputWarning};

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let (path, mut file) = (log.path, log.input);
    let (topics, others) = topics(path, &mut file, log.room)?;
    if !topics.has_imu() {
        return Err(without_imu(path, &others));
    }
    let wanted = Quantities::choose(path, &topics, asked, || survey(&mut file, log.room, &topics))?;
    let topic = wanted.source.topic.clone();
    let behind = messages::end(&file).map_err(|error| InputError::io("read", path, error))?;
    let behind = behind.map(|end| InputWarning::behind_end(path, &file, end)).transpose()?.flatten();
    let stated = messages::stated(&mut file, log.room).get(&topic).copied();
    file.rewind().map_err(|error| InputError::io("read", path, error))?;
    let mut collector = Collector::new(path, wanted, log.room, asked.args);
    let mut cut = None;
    for message in Messages::new(&mut file, log.room) {
        match message {
            Ok(message) if message.channel.topic == topic => {
                let recorded_ns = message.log_time.cast_signed();
                collector.push(encoding(path, &message.channel)?, &message.data, recorded_ns)?;
            }
            Ok(_) => {}
            Err(Torn::OverBudget(why)) => return Err(InputError::over_budget(path, why).into()),
            Err(error) if error.is_changed() => {
                let what =
                    format!("{error}: bytes of it were changed; `mcap recover` saves the chunks that are whole");
                return Err(InputError::damaged(path, "as an MCAP file", what).into());
            }
            Err(error) => cut = Some(torn(path, &error)),
        }
    }
    Ok(collector.finish(cut.or(behind), stated))
}

/// The IMUs and temperatures of a file, and the types of the topics without an IMU. A channel may be declared anywhere
/// before its first message, so the whole file is read.
fn topics(path: &Path, file: &mut Input, room: MemoryBudget) -> Result<(Sources, BTreeMap<String, String>)> {
    let (mut all, mut others, mut seen) = (Sources::default(), BTreeMap::new(), BTreeSet::new());
    let mut first = true;
    for message in Messages::new(file, room) {
        match message {
            Ok(message) if seen.insert(message.channel.topic.clone()) => {
                let (topic, schema) = (&message.channel.topic, message.channel.schema.as_ref());
                let kind = schema.map_or("no type", |schema| &schema.name);
                let definition = schema.map_or(Cow::default(), |schema| String::from_utf8_lossy(&schema.data));
                let of_topic = Sources::of(topic, kind, &definition);
                if !of_topic.has_imu() {
                    others.insert(topic.clone(), kind.to_owned());
                }
                all.extend(of_topic);
            }
            Ok(_) => {}
            Err(error) if first => {
                return Err(InputError::damaged(path, "as an MCAP file", error.to_string()).into());
            }
            // the undamaged part of the file will be read
            Err(_) => {}
        }
        first = false;
    }
    Ok((all, others))
}

/// Counts the messages of each IMU in the undamaged part of the file.
fn survey(file: &mut Input, room: MemoryBudget, sources: &Sources) -> Survey {
    let mut survey = Survey::default();
    if file.rewind().is_err() {
        return survey;
    }
    for message in Messages::new(file, room).flatten() {
        let kind = message.channel.schema.as_ref().map_or("no type", |schema| &schema.name);
        let encoding = Encoding::of(&message.channel.message_encoding);
        for (name, source) in sources.imus().filter(|(_, source)| source.topic == message.channel.topic) {
            survey.message((name, source), kind, encoding, &message.data);
        }
    }
    survey
}

fn encoding(path: &Path, channel: &Channel<'_>) -> Result<Encoding, InputError> {
    Encoding::of(&channel.message_encoding).ok_or_else(|| {
        let what = format!("its messages are encoded in `{}`; cdr and ros1 are read", channel.message_encoding);
        InputError::damaged(path, format!("topic {}", channel.topic), what)
    })
}

fn torn(path: &Path, error: &Torn) -> InputWarning {
    InputWarning::Torn(format!("{} was not closed or is damaged ({error}); the rest is dropped", path.display()))
}
