//! Captures: raw codes on disk, as docs/formats/capture.md specifies them.
//!
//! [`CaptureWriter`] and [`CaptureReader`] move samples, in any of three forms, in constant memory. A capture is the
//! truth: whatever is computed from a live part comes out the same from its capture.

pub mod admission;
pub(crate) mod arrows;
pub(crate) mod chain;
mod checked;
pub mod columns;
mod csv;
#[cfg(test)]
mod damage;
pub(crate) mod delimited;
mod error;
mod hash;
pub(crate) mod info;
pub(crate) mod messages;
pub(crate) mod parquet;
pub mod succession;
pub mod table;
#[cfg(test)]
pub(crate) mod tests;

pub use checked::Checked;
pub use error::CaptureError;
pub use hash::SampleHash;
pub use info::{CALIBRATION_ID, CaptureInfo, SCHEMA_VERSION};
pub use table::Format;

use crate::Input;
use adis16130::Sample;
use arrow_array::RecordBatch;
use arrow_schema::SchemaRef;
use columns::{CORRECTED, OpenBatch, Rows};
use std::path::{Path, PathBuf};
use table::{BatchSource, Opened, Out};

/// Records samples. Dropping it closes the file as well, but only [`CaptureWriter::finish`] tells whether that worked.
pub struct CaptureWriter {
    path: PathBuf,
    schema: SchemaRef,
    sink: Option<table::Sink>,
    open: OpenBatch,
    summary: CaptureSummary,
}

/// What was recorded.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CaptureSummary {
    /// Rows written.
    pub samples: u64,
    /// Sum of their lost-sample counters.
    pub lost: u64,
}

impl CaptureWriter {
    /// Starts a capture; `path` names it in messages.
    pub fn create(path: &Path, out: Out, format: Format, info: &CaptureInfo) -> Result<Self, CaptureError> {
        let schema = columns::schema(columns::raw_fields(), info.to_metadata());
        let sink = table::create(path, out, format, &schema)?;
        Ok(Self {
            path: path.to_owned(),
            schema,
            sink: Some(sink),
            open: OpenBatch::new(),
            summary: CaptureSummary::default(),
        })
    }

    /// Records a sample. Whole batches go to the system at once.
    pub fn push(&mut self, sample: &Sample) -> Result<(), CaptureError> {
        if self.open.is_full_for(sample.t_ns) {
            self.write_open()?;
        }
        self.open.push(sample);
        self.summary.samples += 1;
        self.summary.lost += u64::from(sample.lost);
        Ok(())
    }

    /// Writes the open batch and the end.
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
        let batch = RecordBatch::try_new(self.schema.clone(), self.open.close());
        sink.write(&batch.map_err(|error| CaptureError::arrow("write", &self.path, error))?)
    }
}

impl Drop for CaptureWriter {
    fn drop(&mut self) {
        // the error that led here is the one to report
        let _ = self.close();
    }
}

/// Reads the samples of a capture, in any form, corrected or not. Each block is checked before its rows are given out.
pub struct CaptureReader {
    calibration_id: Option<String>,
    table: Checked,
    rows: Option<Rows>,
    next_row: usize,
}

impl CaptureReader {
    /// Reads a capture by what it contains, whatever its name: `path` names it in messages.
    pub fn open(path: &Path, input: Input) -> Result<Self, CaptureError> {
        match table::recognise(path, input)? {
            Opened::Table(source) => Self::from_source(path, source),
            Opened::Text(_) => Err(CaptureError::not_a_capture(
                path,
                "it does not start as one (a CSV capture begins with lines `# zerorate.…`)",
            )),
        }
    }

    /// Reads a capture out of a table that is open already.
    pub fn from_source(path: &Path, source: Box<dyn BatchSource>) -> Result<Self, CaptureError> {
        let schema = source.stated().schema.clone();
        let table = Checked::new(path, source)?;
        let unnamed = || schema.column_with_name(CORRECTED).map(|_| "unknown".to_owned());
        let calibration_id = schema.metadata().get(CALIBRATION_ID).cloned().or_else(unnamed);
        Ok(Self { calibration_id, table, rows: None, next_row: 0 })
    }

    /// How the capture was taken.
    pub fn info(&self) -> &CaptureInfo {
        self.table.info()
    }

    /// The calibration that was applied, if the capture is a corrected one. Its raw columns are untouched all the
    /// same.
    pub fn calibration_id(&self) -> Option<&str> {
        self.calibration_id.as_deref()
    }

    /// What is to be said once all samples were read: a tail that was torn off, a file that nothing checks.
    pub fn warnings(&self) -> Vec<String> {
        self.table.warnings()
    }

    /// The next batch of rows.
    pub fn next_rows(&mut self) -> Result<Option<Rows>, CaptureError> {
        Ok(self.table.next_rows()?.map(|(_, rows)| rows))
    }

    fn next_sample(&mut self) -> Result<Option<Sample>, CaptureError> {
        loop {
            if let Some(rows) = self.rows.as_ref().filter(|rows| self.next_row < rows.len()) {
                self.next_row += 1;
                return Ok(Some(rows.sample(self.next_row - 1)));
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
    type Item = Result<Sample, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_sample().transpose()
    }
}
