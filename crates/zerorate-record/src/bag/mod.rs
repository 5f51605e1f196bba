//! The MCAP form: a bag as ROS 2 reads it, with the rows of the capture beside (docs/formats/mcap.md).

mod cdr;
mod messages;
mod reader;
mod robot;
mod sink;
#[cfg(test)]
mod tests;

pub use reader::McapReader;
pub use sink::McapSink;

use crate::blocks::{BlockSink, MCAP_MARK, Opened, Out};
use crate::{CaptureError, Input, RobotLog};
use arrow_schema::SchemaRef;
use std::io::{self, Read, Seek};
use std::path::Path;

/// The rows of the capture.
pub const SAMPLES: &str = "/zerorate/samples";
/// Its checks.
pub const CHECKS: &str = "/zerorate/checks";
/// The rates as they were measured.
pub const MEASURED: &str = "/imu/data_raw";
/// The rates, corrected.
pub const CORRECTED: &str = "/imu/data";
/// The temperatures.
pub const TEMPERATURE: &str = "/imu/temperature";

/// The name of this software begins so in the head of such a file.
const LIBRARY: &str = "zerorate";

/// Bytes of a file that hold its head.
const HEAD: u64 = 512;

/// Starts such a file; `path` names it in messages.
pub fn sink(path: &Path, out: Out, schema: &SchemaRef, log: RobotLog) -> Result<Box<dyn BlockSink>, CaptureError> {
    Ok(Box::new(McapSink::create(path, out, schema, log)?))
}

/// Opens an MCAP file. A bag that others wrote is left to the readers of logs.
pub fn source(path: &Path, mut input: Input) -> Result<Opened, CaptureError> {
    match is_capture(&mut input).map_err(|error| CaptureError::io("read", path, error))? {
        true => Ok(Opened::Table(Box::new(McapReader::open(path, input)?))),
        false => Ok(Opened::Text(input)),
    }
}

/// Whether an MCAP file was written here; leaves the file at its start.
pub fn is_capture(input: &mut (impl Read + Seek)) -> io::Result<bool> {
    let mut head = Vec::new();
    input.take(HEAD).read_to_end(&mut head)?;
    input.rewind()?;
    Ok(library(&head).is_some_and(|library| library.starts_with(LIBRARY.as_bytes())))
}

/// The header record: its kind, its length, the profile, the library.
fn library(head: &[u8]) -> Option<&[u8]> {
    let record = head.strip_prefix(MCAP_MARK)?.strip_prefix(&[1])?.get(8..)?;
    let (_, rest) = text(record)?;
    text(rest).map(|(library, _)| library)
}

fn text(bytes: &[u8]) -> Option<(&[u8], &[u8])> {
    let (length, rest) = bytes.split_first_chunk()?;
    rest.split_at_checked(u32::from_le_bytes(*length) as usize)
}
