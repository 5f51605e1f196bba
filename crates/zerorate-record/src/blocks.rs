//! The writer of blocks that each format of a capture has.

use crate::CaptureError;
use crate::chain::End;
use arrow_array::RecordBatch;
use std::io::Write;

/// The destination of a capture.
pub type Out = Box<dyn Write + Send>;

/// Writes blocks of rows in one of the formats.
pub trait BlockSink {
    /// Writes rows, and passes them to the operating system if the format allows it. If `check` is given, a block
    /// ends after these rows, and `check` is its check.
    fn write(&mut self, rows: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError>;

    /// Ends the open block if `check` is given, and writes the end of the file.
    fn finish(self: Box<Self>, check: Option<&str>, end: &End) -> Result<(), CaptureError>;
}
