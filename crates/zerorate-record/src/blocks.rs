//! The common parts of all forms of a capture: blocks of rows, written and read.

use crate::chain::End;
use crate::warning::CaptureWarning;
use crate::{CaptureError, Input};
use arrow_array::RecordBatch;
use arrow_schema::SchemaRef;
use std::io::Write;
use std::path::Path;

/// The destination of a capture.
pub type Out = Box<dyn Write + Send>;

/// Takes blocks of rows in one of the forms.
pub trait BlockSink {
    /// Writes rows, as far as the form allows out of the program's hands. `check` ends the block.
    fn write(&mut self, rows: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError>;

    /// Ends the block of the rows before, if `check` is given, and writes what the form has at its end.
    fn finish(self: Box<Self>, check: Option<&str>, end: &End) -> Result<(), CaptureError>;
}

/// The statements of a source so far, beside its rows.
pub struct Stated {
    /// Columns and metadata.
    pub schema: SchemaRef,
    /// The check of the batch given last.
    pub check: Option<String>,
    /// The end, once all batches were read.
    pub end: Option<End>,
    /// No batch follows.
    pub ended: bool,
    /// The file ended where no end should be.
    pub torn: bool,
    /// The warning after the last batch: a tail that was torn off.
    pub warning: Option<CaptureWarning>,
}

impl Stated {
    /// Nothing but the schema, as before the first batch.
    pub fn new(schema: SchemaRef) -> Self {
        Self { schema, check: None, end: None, ended: false, torn: false, warning: None }
    }
}

/// The warning about a capture that lacks its end, with the number of rows without a check.
pub fn cut_off(path: &Path, rows: usize) -> CaptureWarning {
    let path = path.display();
    CaptureWarning::Torn(format!("{path} was not closed; {rows} rows after its last whole block are dropped"))
}

/// Gives batches.
pub trait BatchSource {
    /// Name of the form.
    fn form(&self) -> &'static str {
        "table"
    }

    /// The statements so far.
    fn stated(&self) -> &Stated;

    /// The same, to be added to.
    fn stated_mut(&mut self) -> &mut Stated;

    /// The next batch of the form, if there is one. It is not called again behind the end or an error.
    fn read_batch(&mut self) -> Result<Option<RecordBatch>, CaptureError>;

    /// Whether common software keeps the description when it writes such a file, and drops the checks of the rows.
    fn may_be_stripped(&self) -> bool {
        true
    }

    /// The next batch; none behind the last one, and behind an error.
    fn next_batch(&mut self) -> Result<Option<RecordBatch>, CaptureError> {
        if self.stated().ended {
            return Ok(None);
        }
        let batch = self.read_batch();
        self.stated_mut().ended |= !matches!(batch, Ok(Some(_)));
        batch
    }
}

/// The content of a file.
pub enum Opened {
    /// Columns with names and types.
    Table(Box<dyn BatchSource>),
    /// Text that is not a capture: perhaps the log of some other gyroscope.
    Text(Input),
}
