//! Writes a capture to disk while it is recorded.

use crate::output::Recording;
use std::io;
use zerorate_record::{CaptureError, CaptureInfo, CaptureSummary, CaptureWriter, Format, Row};

/// Records samples into a file and syncs the file to the disk. Dropping the recorder also closes the file, but only
/// [`Recorder::finish`] reports errors.
pub struct Recorder {
    writer: CaptureWriter,
    file: Recording,
}

impl Recorder {
    /// Starts a capture in an empty file.
    pub fn create(file: Recording, format: Format, info: &CaptureInfo) -> Result<Self, CaptureError> {
        let out = Box::new(file.writer().map_err(|error| CaptureError::io("write", file.path(), error))?);
        let writer = CaptureWriter::create(file.path(), out, format, info)?;
        Ok(Self { writer, file })
    }

    /// Records a sample. Complete batches are written at once, except in Parquet. A call fails at most a second after
    /// the file was removed, replaced or cut short.
    #[inline]
    pub fn push(&mut self, row: &Row) -> Result<(), CaptureError> {
        self.file.check().map_err(|error| CaptureError::io("record into", self.file.path(), error))?;
        self.writer.push(row)
    }

    /// Writes the remaining samples and syncs the file to the disk.
    pub fn finish(self) -> Result<CaptureSummary, CaptureError> {
        let path = self.file.path().to_owned();
        let put = |error: io::Error| CaptureError::io("record into", &path, error);
        let summary = self.writer.finish();
        let synced = self.file.finish().map_err(put);
        let summary = summary?;
        synced.map(|()| summary)
    }
}
