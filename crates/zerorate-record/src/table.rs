//! Tables in any format: recognises the format of a file, and reads and writes batches.

use crate::blocks::{BlockSink, Out};
use crate::chain::Chain;
use crate::columns::{MAX_ROWS, Rows};
use crate::layout::Layout;
#[cfg(feature = "parquet")]
use crate::parquet;
use crate::{CaptureError, CaptureInfo, arrows, csv};
use arrow_array::RecordBatch;
use arrow_schema::SchemaRef;
use std::path::{Path, PathBuf};
use zerorate_input::{Input, InputError, NotBuiltIn, Opened, open_table};

/// The format of a capture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "clap", derive(clap::ValueEnum))]
pub enum Format {
    /// Arrow IPC stream. A power cut leaves all complete blocks readable.
    Arrows,
    /// Parquet, the smallest format.
    Parquet,
    /// CSV with the description as comments.
    Csv,
}

impl Format {
    /// The requested format, or else the format of the file name's ending. A name without an ending means a stream.
    ///
    /// # Errors
    /// Returns an error if the ending is not that of a capture, or if the format is not in this build.
    pub fn choose(asked: Option<Self>, path: &Path) -> Result<Self, CaptureError> {
        let format = asked.map_or_else(|| Self::by_name(path), Ok)?;
        if cfg!(not(feature = "parquet")) && format == Self::Parquet {
            return Err(InputError::not_built_in(path, NotBuiltIn::PARQUET).into());
        }
        Ok(format)
    }

    fn by_name(path: &Path) -> Result<Self, CaptureError> {
        let Some(ending) = path.extension() else { return Ok(Self::Arrows) };
        match ending.to_string_lossy().to_ascii_lowercase().as_str() {
            "arrows" => Ok(Self::Arrows),
            "parquet" => Ok(Self::Parquet),
            "csv" => Ok(Self::Csv),
            _ => Err(CaptureError::UnknownEnding { path: path.to_owned() }),
        }
    }
}

/// Writes a capture with its checks.
pub struct CheckedSink {
    path: PathBuf,
    form: Box<dyn BlockSink>,
    chain: Chain,
    /// Largest number of rows in a block.
    block_rows: usize,
    /// True if a block ends with each batch, even with fewer rows.
    ends_with_batch: bool,
    /// Number of rows in the open block.
    open: usize,
    layout: Layout,
}

/// Starts a capture; `path` names it in messages.
pub fn create(path: &Path, out: Out, format: Format, schema: &SchemaRef) -> Result<CheckedSink, CaptureError> {
    let layout = CaptureInfo::from_metadata(path, schema.metadata())?.layout;
    let (form, block_rows): (Box<dyn BlockSink>, usize) = match format {
        Format::Arrows => (Box::new(arrows::StreamSink::create(path, out, schema)?), MAX_ROWS),
        #[cfg(feature = "parquet")]
        Format::Parquet => (Box::new(parquet::ParquetSink::create(path, out, schema)?), parquet::BLOCK),
        #[cfg(not(feature = "parquet"))]
        Format::Parquet => return Err(InputError::not_built_in(path, NotBuiltIn::PARQUET).into()),
        Format::Csv => (Box::new(csv::CsvSink::create(path, out, schema)?), MAX_ROWS),
    };
    let (chain, ends_with_batch) = (Chain::new(schema, &layout), format != Format::Parquet);
    Ok(CheckedSink { path: path.to_owned(), form, chain, block_rows, ends_with_batch, open: 0, layout })
}

impl CheckedSink {
    /// Writes the rows of a batch, cut at the ends of blocks.
    pub fn write(&mut self, batch: &RecordBatch) -> Result<(), CaptureError> {
        let mut first = 0;
        while first < batch.num_rows() {
            let room = self.block_rows - self.open;
            let piece = batch.slice(first, room.min(batch.num_rows() - first));
            first += piece.num_rows();
            self.write_piece(&piece)?;
        }
        Ok(())
    }

    fn write_piece(&mut self, piece: &RecordBatch) -> Result<(), CaptureError> {
        let rows = Rows::from_batch(&self.path, "rows to be written", piece, &self.layout)?;
        self.chain.take(&rows, piece);
        self.open = if self.ends_with_batch { 0 } else { (self.open + piece.num_rows()) % self.block_rows };
        let check = (self.open == 0).then(|| self.chain.seal());
        self.form.write(piece, check.as_deref())
    }

    /// Ends the open block and the file.
    pub fn finish(mut self) -> Result<(), CaptureError> {
        let check = (self.open > 0).then(|| self.chain.seal());
        self.form.finish(check.as_deref(), &self.chain.end())
    }
}

/// Recognises the format of a file by its content, and opens it; `path` names it in messages.
pub fn recognise(path: &Path, mut input: Input) -> Result<Opened, CaptureError> {
    let failed = |error| CaptureError::io("read", path, error);
    if input.is_directory().map_err(failed)? {
        return Err(CaptureError::not_a_capture(path, "it is a directory; name the file"));
    }
    let start = input.start(csv::PREAMBLE.len() as u64).map_err(failed)?;
    match start.as_slice() {
        [] => Err(CaptureError::not_a_capture(path, "it is empty")),
        [b'A', b'R', b'R', b'O', b'W', b'1', ..] => Err(CaptureError::not_a_capture(
            path,
            "it is an Arrow file; convert it to an Arrow stream, to Parquet or to CSV",
        )),
        text if text == csv::PREAMBLE.as_bytes() => Ok(Opened::Table(Box::new(csv::CsvReader::open(path, input)?))),
        _ => open_table(path, input).map_err(|error| match error {
            InputError::NotALog { path, why } => CaptureError::NotACapture { path, why },
            other => other.into(),
        }),
    }
}
