//! Tables: batches of rows whose columns have names and types.

use crate::{Input, InputError, InputWarning, Quantity};
use arrow_array::{ArrayRef, RecordBatch};
use arrow_schema::{Schema, SchemaRef};
use std::path::Path;

/// The start of the metadata keys of a table that describes itself.
pub const DESCRIPTION: &str = "zerorate.";

/// Whether the metadata of a table describe what its columns mean.
pub fn describes_itself(schema: &Schema) -> bool {
    schema.metadata().keys().any(|key| key.starts_with(DESCRIPTION))
}

/// The start of the keys of checks that a writer puts beside the rows.
pub const CHECKS: &str = "zerorate.check.";

/// Key of the check of a batch.
pub const BATCH_CHECK: &str = "zerorate.check.batch";

/// In Parquet, whose index is in one place: key of the checks of all batches, in order, with blanks between.
pub const BATCH_CHECKS: &str = "zerorate.check.batches";

/// Key of the statement behind the last row.
pub const END: &str = "zerorate.check.end";

/// The statements of a source so far, beside its rows.
pub struct Stated {
    /// Columns and metadata.
    pub schema: SchemaRef,
    /// The check of the batch given last.
    pub check: Option<String>,
    /// The statement at the end, once all batches were read.
    pub end: Option<String>,
    /// No batch follows.
    pub ended: bool,
    /// The file ended where no end should be.
    pub torn: bool,
    /// The warning after the last batch: a tail that was torn off.
    pub warning: Option<InputWarning>,
}

impl Stated {
    /// Nothing but the schema, as before the first batch.
    pub fn new(schema: SchemaRef) -> Self {
        Self { schema, check: None, end: None, ended: false, torn: false, warning: None }
    }
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
    fn read_batch(&mut self) -> Result<Option<RecordBatch>, InputError>;

    /// Whether common software keeps the description when it writes such a file, and drops the checks of the rows.
    fn may_be_stripped(&self) -> bool {
        true
    }

    /// The next batch; none behind the last one, and behind an error.
    fn next_batch(&mut self) -> Result<Option<RecordBatch>, InputError> {
        if self.stated().ended {
            return Ok(None);
        }
        let batch = self.read_batch();
        self.stated_mut().ended |= !matches!(batch, Ok(Some(_)));
        batch
    }
}

/// A table that says what its columns mean, which of their values are valid, and when its rows were taken.
pub trait DescribedTable {
    /// Columns and metadata.
    fn schema(&self) -> SchemaRef;

    /// The columns that are read where none is asked for.
    fn default_columns(&self) -> Vec<usize>;

    /// The column of the temperature, if there is one.
    fn temperature(&self) -> Option<usize>;

    /// The quantity of a column of codes, and the size of a step in the unit of its results.
    fn step(&self, column: usize) -> Option<(Quantity, f64)>;

    /// Reads all rows, and hands on these columns of them, batch by batch. Where `validates` is set, values that are
    /// not valid are null.
    ///
    /// # Errors
    /// The table cannot be read, or its rows contradict what it states.
    fn read(
        self: Box<Self>,
        columns: &[usize],
        validates: bool,
        take: &mut (dyn FnMut(&[ArrayRef]) -> Result<(), InputError> + Send),
    ) -> Result<Described, InputError>;
}

/// The statements of a [`DescribedTable`], once all rows were read.
#[derive(Debug, Default)]
pub struct Described {
    /// Mean rate of the rows, lost ones included.
    pub rate_hz: Option<f64>,
    /// The rows before which others were lost, and how many.
    pub lost: Vec<(usize, u64)>,
    /// Warnings about the table: code and text.
    pub warnings: Vec<(&'static str, String)>,
    /// Warnings about each of the columns that were read.
    pub of_columns: Vec<Vec<(&'static str, String)>>,
    /// The reason why the values must not become a result: code and text.
    pub refused: Option<(&'static str, String)>,
}

/// What may be a described table.
pub enum Source {
    /// A file that was not looked into.
    File(Input),
    /// A table whose schema was read.
    Table(Box<dyn BatchSource>),
}

/// Opens a described table; none if the file is another one. A table comes only if it describes itself.
pub type OpenDescribed = fn(&Path, Source) -> Result<Option<Box<dyn DescribedTable>>, InputError>;
