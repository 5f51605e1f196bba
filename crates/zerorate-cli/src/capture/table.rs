//! Tables in any of the three forms: which form a file has, and batches into and out of it.

use super::{CaptureError, arrows, csv, parquet};
use arrow::array::RecordBatch;
use arrow::datatypes::SchemaRef;
use std::fs::File;
use std::io::{Read, Seek};
use std::path::Path;

/// The form of a capture on disk.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Arrow IPC stream: survives a power cut.
    Arrows,
    /// Parquet: the smallest.
    Parquet,
    /// CSV with the description as comments.
    Csv,
}

impl Format {
    /// The form asked for, or else the one that the name of the file says, or else a stream.
    pub fn choose(asked: Option<Self>, path: &Path) -> Self {
        let by_name = || match path.extension()?.to_str()? {
            "parquet" => Some(Self::Parquet),
            "csv" => Some(Self::Csv),
            _ => None,
        };
        asked.or_else(by_name).unwrap_or(Self::Arrows)
    }
}

/// Takes batches.
pub trait BatchSink {
    /// Writes a batch, as far as the form allows out of the program's hands.
    fn write(&mut self, batch: &RecordBatch) -> Result<(), CaptureError>;

    /// Writes what the form has at its end.
    fn finish(self: Box<Self>) -> Result<(), CaptureError>;
}

/// Gives batches.
pub trait BatchSource: Iterator<Item = Result<RecordBatch, CaptureError>> {
    /// Columns and metadata.
    fn schema(&self) -> SchemaRef;

    /// What is to be said after the last batch: a tail that was torn off.
    fn warning(&self) -> Option<&str>;
}

/// Starts a table in an empty file; `path` names it in messages.
pub fn create(path: &Path, file: File, format: Format, schema: &SchemaRef) -> Result<Box<dyn BatchSink>, CaptureError> {
    Ok(match format {
        Format::Arrows => Box::new(arrows::Sink::create(path, file, schema)?),
        Format::Parquet => Box::new(parquet::Sink::create(path, file, schema)?),
        Format::Csv => Box::new(csv::Sink::create(path, file, schema)?),
    })
}

/// What a file turned out to be.
pub enum Opened {
    /// Columns with names and types.
    Table(Box<dyn BatchSource>),
    /// Text that is no capture: perhaps the log of some other gyroscope.
    Text(File),
}

/// Opens a file by what it contains, whatever its name.
pub fn open(path: &Path) -> Result<Opened, CaptureError> {
    let failed = |error| CaptureError::io("read", path, error);
    let file = File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.is_dir() {
        return Err(CaptureError::not_a_capture(path, "it is a directory; name the file"));
    }
    recognise(path, file)
}

/// The same, of a file that is open already: `path` names it in messages.
pub fn recognise(path: &Path, mut file: File) -> Result<Opened, CaptureError> {
    let failed = |error| CaptureError::io("read", path, error);
    let mut start = Vec::new();
    (&mut file).take(csv::PREAMBLE.len() as u64).read_to_end(&mut start).map_err(failed)?;
    file.rewind().map_err(failed)?;
    match start.as_slice() {
        [] => Err(CaptureError::not_a_capture(path, "it is empty")),
        [0xFF, 0xFF, 0xFF, 0xFF, ..] => Ok(Opened::Table(Box::new(arrows::Source::open(path, file)?))),
        [b'P', b'A', b'R', b'1', ..] => Ok(Opened::Table(Box::new(parquet::Source::open(path, file)?))),
        [b'A', b'R', b'R', b'O', b'W', b'1', ..] => Err(CaptureError::not_a_capture(
            path,
            "it is an Arrow file; convert it to an Arrow stream, to Parquet or to CSV",
        )),
        text if text == csv::PREAMBLE.as_bytes() => Ok(Opened::Table(Box::new(csv::Source::open(path, file)?))),
        _ => Ok(Opened::Text(file)),
    }
}
