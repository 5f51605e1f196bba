//! Captures: raw codes on disk, as docs/formats/capture.md specifies them.
//!
//! [`CaptureWriter`] and [`CaptureReader`] write and read rows of any number of axes, in any of three formats, in
//! constant memory. Every result computed from a live part can be computed again from its capture, and is the same.
//!
//! The format is recognised by content, not by file name. This crate never opens a file: the caller passes open
//! bytes as [`Input`], so the same readers serve a browser.

pub mod admission;
mod arrows;
#[cfg(test)]
mod axes;
mod blocks;
mod chain;
mod checked;
pub mod columns;
mod csv;
#[cfg(test)]
mod damage;
mod described;
mod error;
#[cfg(test)]
mod fuzz;
mod hash;
mod info;
mod layout;
#[cfg(feature = "parquet")]
mod parquet;
mod row;
pub mod succession;
pub mod table;
#[cfg(test)]
mod tests;
pub mod valid;
mod warning;

pub use chain::checked_schema;
pub use checked::Checked;
pub use described::open_described;
pub use error::CaptureError;
pub use hash::SampleHash;
pub use info::{CALIBRATION_ID, CaptureInfo, Converter, NotThePart, SCHEMA_VERSION};
pub use layout::{CodedAxis, Layout, LayoutError};
pub use row::Row;
pub use table::Format;
pub use warning::CaptureWarning;

use arrow_array::RecordBatch;
use arrow_schema::SchemaRef;
use blocks::Out;
use columns::{OpenBatch, Rows};
use std::path::{Path, PathBuf};
use zerorate_input::{Input, InputError, Opened};

/// Writes rows to a capture. A drop of the writer also closes the file, but only [`Self::finish`] reports errors.
pub struct CaptureWriter {
    path: PathBuf,
    schema: SchemaRef,
    layout: Layout,
    sink: Option<table::CheckedSink>,
    open: OpenBatch,
    summary: CaptureSummary,
}

/// Totals of a recording.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CaptureSummary {
    /// Number of rows written.
    pub samples: u64,
    /// Number of samples lost, the sum over all rows.
    pub lost: u64,
}

impl CaptureWriter {
    /// Starts a capture; `path` names it in messages.
    pub fn create(path: &Path, out: Out, format: Format, info: &CaptureInfo) -> Result<Self, CaptureError> {
        let schema = checked_schema(info.layout.raw_fields(), info.to_metadata());
        let sink = table::create(path, out, format, &schema)?;
        Ok(Self {
            path: path.to_owned(),
            schema,
            layout: info.layout.clone(),
            sink: Some(sink),
            open: OpenBatch::new(&info.layout),
            summary: CaptureSummary::default(),
        })
    }

    /// Adds a row. If the open batch is full, first passes the batch to the operating system, except in Parquet.
    pub fn push(&mut self, row: &Row) -> Result<(), CaptureError> {
        let misfit = |what| CaptureError::damaged(&self.path, "row to be written", what);
        self.layout.check_row(row).map_err(misfit)?;
        if self.open.is_full_for(row.t_ns) {
            self.write_open()?;
        }
        self.open.push(row);
        self.summary.samples += 1;
        self.summary.lost += u64::from(row.lost);
        Ok(())
    }

    /// Writes the open batch and the end of the file.
    pub fn finish(mut self) -> Result<CaptureSummary, CaptureError> {
        self.close()?;
        Ok(self.summary)
    }

    fn close(&mut self) -> Result<(), CaptureError> {
        self.write_open()?;
        self.sink.take().map_or(Ok(()), |sink| sink.finish())
    }

    fn write_open(&mut self) -> Result<(), CaptureError> {
        let Some(sink) = self.sink.as_mut().filter(|_| !self.open.is_empty()) else {
            return Ok(());
        };
        let batch = self.open.close().and_then(|columns| RecordBatch::try_new(self.schema.clone(), columns));
        sink.write(&batch.map_err(|error| InputError::arrow("write", &self.path, error))?)
    }
}

impl Drop for CaptureWriter {
    fn drop(&mut self) {
        // errors are not reported here; `finish` reports them
        let _ = self.close();
    }
}

/// Reads the rows of a capture in any format, corrected or not. Each block is checked before its rows are returned.
pub struct CaptureReader {
    calibration_id: Option<String>,
    table: Checked,
    rows: Option<Rows>,
    next_row: usize,
}

impl CaptureReader {
    /// Opens a capture. Its format is recognised by content; `path` names it in messages.
    pub fn open(path: &Path, input: Input) -> Result<Self, CaptureError> {
        let Opened::Table(source) = table::recognise(path, input)? else {
            return Err(CaptureError::not_a_capture(
                path,
                "it does not start as one (a CSV capture begins with lines `# zerorate.…`)",
            ));
        };
        let schema = source.stated().schema.clone();
        let table = Checked::new(path, source)?;
        let corrected = table.info().layout.axes().iter().map(CodedAxis::corrected_column);
        let is_there = |name: String| schema.column_with_name(&name).map(|_| "unknown".to_owned());
        let unnamed = || corrected.filter_map(is_there).next();
        let calibration_id = schema.metadata().get(CALIBRATION_ID).cloned().or_else(unnamed);
        Ok(Self { calibration_id, table, rows: None, next_row: 0 })
    }

    /// The description of the capture.
    pub fn info(&self) -> &CaptureInfo {
        self.table.info()
    }

    /// The id of the applied calibration, if the capture is corrected; `unknown` if the capture does not state it.
    /// The raw columns are unchanged even then.
    pub fn calibration_id(&self) -> Option<&str> {
        self.calibration_id.as_deref()
    }

    /// The warnings, such as those about a missing end or a file without checks. Complete once all rows were read.
    pub fn warnings(&self) -> Vec<CaptureWarning> {
        self.table.warnings()
    }

    /// Reads and checks the next batch of rows; `None` after the last one.
    pub fn next_rows(&mut self) -> Result<Option<Rows>, CaptureError> {
        Ok(self.table.next_rows()?.map(|(_, rows)| rows))
    }

    fn next_row(&mut self) -> Result<Option<Row>, CaptureError> {
        loop {
            if let Some(rows) = self.rows.as_ref().filter(|rows| self.next_row < rows.len()) {
                self.next_row += 1;
                return Ok(Some(rows.row(self.next_row - 1)));
            }
            self.rows = self.next_rows()?;
            self.next_row = 0;
            if self.rows.is_none() {
                return Ok(None);
            }
        }
    }
}

impl Iterator for CaptureReader {
    type Item = Result<Row, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_row().transpose()
    }
}
