//! The common parts of all forms of a capture: blocks of rows, written and read.

use crate::CaptureError;
use crate::chain::End;
use arrow_array::RecordBatch;
use std::io::Write;
use std::path::Path;
use zerorate_input::InputWarning;

/// The destination of a capture.
pub type Out = Box<dyn Write + Send>;

/// Takes blocks of rows in one of the forms.
pub trait BlockSink {
    /// Writes rows, and passes them to the operating system as far as the form allows. `check` ends the block.
    fn write(&mut self, rows: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError>;

    /// Ends the block of the rows before, if `check` is given, and writes the end of the file.
    fn finish(self: Box<Self>, check: Option<&str>, end: &End) -> Result<(), CaptureError>;
}

/// The warning about a capture that lacks its end, with the number of rows without a check.
pub fn cut_off(path: &Path, rows: usize) -> InputWarning {
    let path = path.display();
    InputWarning::Torn(format!("{path} was not closed; {rows} rows after its last whole block are dropped"))
}
