//! Writes the MCAP form.

use super::messages::{self, Definition, encode};
use super::robot::{Robot, RobotMessages};
use super::{CHECKS, CORRECTED, LIBRARY, MEASURED, SAMPLES, TEMPERATURE};
use crate::CaptureError;
use crate::blocks::{BlockSink, Out};
use crate::chain::{self, End};
use crate::columns::Rows;
use crate::info::{CALIBRATION_ID, CaptureInfo};
use crate::layout::Layout;
use crate::robot_log::RobotLog;
use crate::row::Row;
use arrow_array::RecordBatch;
use arrow_schema::SchemaRef;
use mcap::records::MessageHeader;
use mcap::write::NoSeek;
use mcap::{Compression, McapError, WriteOptions, Writer};
use std::collections::BTreeMap;
use std::io;
use std::path::{Path, PathBuf};

/// Writes an MCAP file: a chunk for each block of rows.
pub struct McapSink {
    path: PathBuf,
    layout: Layout,
    writer: Writer<NoSeek<Out>>,
    robot: Robot,
    channels: Channels,
    last_ns: u64,
}

/// The channels, and how many messages each has.
struct Channels {
    samples: Channel,
    checks: Channel,
    imu: Channel,
    temperature: Channel,
}

struct Channel {
    id: u16,
    sequence: u32,
}

type Metadata = BTreeMap<String, String>;

impl McapSink {
    /// Writes head and channels. Of captures it takes the raw columns: what is derived stands in the other messages.
    pub fn create(path: &Path, out: Out, schema: &SchemaRef, log: RobotLog) -> Result<Self, CaptureError> {
        let layout = CaptureInfo::from_metadata(path, schema.metadata())?.layout;
        if schema.metadata().contains_key(CALIBRATION_ID) || schema.fields().len() != layout.raw_fields().len() {
            return Err(CaptureError::Corrected { path: path.to_owned() });
        }
        let robot = Robot::new(path, &layout, log)?;
        let failed = |error| cannot("write", path, error);
        let mut writer = options().create(NoSeek::new(out)).map_err(failed)?;
        let channels = Channels::add(&mut writer, schema, &layout, &robot).map_err(failed)?;
        let mut sink = Self { path: path.to_owned(), layout, writer, robot, channels, last_ns: 0 };
        sink.flush()?;
        Ok(sink)
    }

    fn row(&mut self, row: &Row) -> Result<(), McapError> {
        self.last_ns = self.robot.stamp_ns(row.t_ns);
        self.channels.samples.write(&mut self.writer, self.last_ns, encode(row).bytes())?;
        let messages = self.robot.push(row);
        messages.map_or(Ok(()), |messages| self.robot_messages(&messages))
    }

    fn robot_messages(&mut self, messages: &RobotMessages) -> Result<(), McapError> {
        let RobotMessages { stamp_ns, imu, temperature } = messages;
        let both = [(&mut self.channels.imu, imu), (&mut self.channels.temperature, temperature)];
        for (channel, message) in both {
            if let Some(message) = message {
                channel.write(&mut self.writer, *stamp_ns, message.bytes())?;
            }
        }
        Ok(())
    }

    fn state(&mut self, key: &str, value: &str) -> Result<(), CaptureError> {
        let mut message = super::cdr::Cdr::new();
        message.text(&format!("{key} = {value}"));
        let written = self.channels.checks.write(&mut self.writer, self.last_ns, message.bytes());
        written.map_err(|error| cannot("write", &self.path, error))
    }

    /// Ends the chunk.
    fn flush(&mut self) -> Result<(), CaptureError> {
        self.writer.flush().map_err(|error| cannot("write", &self.path, error))
    }
}

impl Channels {
    /// The description of the capture stands with those that carry it.
    fn add(
        writer: &mut Writer<NoSeek<Out>>,
        schema: &SchemaRef,
        layout: &Layout,
        robot: &Robot,
    ) -> Result<Self, McapError> {
        let described = schema.metadata().iter().map(|(key, value)| (key.clone(), value.clone())).collect();
        let (topic, corrected) = match &robot.calibration_id {
            Some(id) => (CORRECTED, Metadata::from([(CALIBRATION_ID.to_owned(), id.clone())])),
            None => (MEASURED, Metadata::new()),
        };
        let mut add = |topic: &str, Definition { name, text }: Definition, metadata: &Metadata| {
            let schema = writer.add_schema(name, "ros2msg", text.as_bytes())?;
            let id = writer.add_channel(schema, topic, "cdr", metadata)?;
            Ok::<_, McapError>(Channel { id, sequence: 0 })
        };
        Ok(Self {
            samples: add(SAMPLES, messages::sample(layout), &described)?,
            checks: add(CHECKS, messages::string(), &described)?,
            imu: add(topic, messages::imu(), &corrected)?,
            temperature: add(TEMPERATURE, messages::temperature(), &Metadata::new())?,
        })
    }
}

impl Channel {
    fn write(&mut self, writer: &mut Writer<NoSeek<Out>>, ns: u64, message: &[u8]) -> Result<(), McapError> {
        let header = MessageHeader { channel_id: self.id, sequence: self.sequence, log_time: ns, publish_time: ns };
        self.sequence = self.sequence.wrapping_add(1);
        writer.write_to_known_channel(&header, message)
    }
}

impl BlockSink for McapSink {
    fn write(&mut self, batch: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError> {
        let rows = Rows::from_batch(&self.path, "rows to be written", batch, &self.layout)?;
        if let (Some(first), Some(last)) = (rows.iter().next(), rows.len().checked_sub(1)) {
            self.robot.note_times(&first, &rows.row(last));
        }
        for row in rows.iter() {
            self.row(&row).map_err(|error| cannot("write", &self.path, error))?;
        }
        check.map_or(Ok(()), |check| self.state(chain::BATCH, check))?;
        self.flush()
    }

    fn finish(mut self: Box<Self>, check: Option<&str>, end: &End) -> Result<(), CaptureError> {
        while let Some(messages) = self.robot.finish() {
            self.robot_messages(&messages).map_err(|error| cannot("write", &self.path, error))?;
        }
        check.map_or(Ok(()), |check| self.state(chain::BATCH, check))?;
        self.state(chain::END, &end.to_text())?;
        self.writer.finish().map(drop).map_err(|error| cannot("write", &self.path, error))
    }
}

/// Nothing seeks in the file, and its blocks end where the blocks of the capture end.
fn options() -> WriteOptions {
    WriteOptions::new()
        .profile("ros2")
        .library(format!("{LIBRARY} {}", env!("CARGO_PKG_VERSION")))
        .disable_seeking(true)
        .chunk_size(None)
        .compression(compression())
}

/// LZ4 takes a fifth of the time of Zstandard, and packs what repeats in these messages as well.
fn compression() -> Option<Compression> {
    #[cfg(feature = "lz4")]
    return Some(Compression::Lz4);
    #[cfg(not(feature = "lz4"))]
    return None;
}

fn cannot(action: &'static str, path: &Path, error: McapError) -> CaptureError {
    match error {
        McapError::Io(error) => CaptureError::io(action, path, error),
        error => CaptureError::io(action, path, io::Error::other(error)),
    }
}
