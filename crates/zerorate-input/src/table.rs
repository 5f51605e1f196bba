//! Tables: batches of rows whose columns have names and types.

use crate::{Input, InputError, InputWarning, Quantity};
use arrow_array::{ArrayRef, RecordBatch};
use arrow_schema::{Schema, SchemaRef};
use std::path::Path;

/// Prefix of the metadata keys by which a table describes its columns.
pub const DESCRIPTION: &str = "zerorate.";

/// True if the metadata of a table describe the meaning of its columns.
pub fn describes_itself(schema: &Schema) -> bool {
    schema.metadata().keys().any(|key| key.starts_with(DESCRIPTION))
}

/// Prefix of the metadata keys of checks: digests of the rows, which the writer adds.
pub const CHECKS: &str = "zerorate.check.";

/// Key of the check of one batch, in the metadata of its message in an Arrow stream or in a comment of CSV.
pub const BATCH_CHECK: &str = "zerorate.check.batch";

/// Key of the checks of all batches in the metadata of a Parquet file, in order and separated by blanks.
pub const BATCH_CHECKS: &str = "zerorate.check.batches";

/// Key of the end statement of a table: the number of rows, a digest of the samples, and a check of both.
pub const END: &str = "zerorate.check.end";

/// What a table has stated so far, besides its rows.
pub struct Stated {
    /// Columns and metadata.
    pub schema: SchemaRef,
    /// The check of the batch that was returned last; `None` before the first batch, and if the file has no checks.
    pub check: Option<String>,
    /// The end statement. An Arrow stream and CSV state it only after the last batch.
    pub end: Option<String>,
    /// True once the reader has met the end of the file. The reader of Parquet does not set it.
    pub ended: bool,
    /// True if the file is cut off before the end of its content.
    pub torn: bool,
    /// A warning about the end of the file, known after the last batch.
    pub warning: Option<InputWarning>,
}

impl Stated {
    /// The statements before the first batch: the schema only.
    pub fn new(schema: SchemaRef) -> Self {
        Self { schema, check: None, end: None, ended: false, torn: false, warning: None }
    }
}

/// A table that is read batch by batch.
pub trait BatchSource {
    /// Name of the file format.
    fn form(&self) -> &'static str {
        "table"
    }

    /// What the table has stated so far, besides its rows.
    fn stated(&self) -> &Stated;

    /// Reads the next batch; `None` at the end. It is not called again after the end or an error.
    fn read_batch(&mut self) -> Result<Option<RecordBatch>, InputError>;

    /// True if the file may have lost its checks: common software that rewrites such a file keeps only the
    /// description.
    fn may_be_stripped(&self) -> bool {
        true
    }
}

/// A table that states the meaning of its columns, which values are valid, and when its rows were recorded.
pub trait DescribedTable {
    /// Columns and metadata.
    fn schema(&self) -> SchemaRef;

    /// Indices of the columns that are read by default.
    fn default_columns(&self) -> Vec<usize>;

    /// Index of the temperature column, if there is one.
    fn temperature(&self) -> Option<usize>;

    /// The quantity of a column of sensor codes, and the size of one code step in the unit of results, such as °/s.
    /// `None` for other columns.
    fn step(&self, column: usize) -> Option<(Quantity, f64)>;

    /// Reads all rows and passes `columns` to `take` in batches. With `validates`, nulls invalid values and counts
    /// losses.
    ///
    /// # Errors
    /// Returns an error if the table cannot be read, or if its rows contradict its statements.
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
    /// Mean rate of the rows, Hz, lost rows included; `None` if it is not known.
    pub rate_hz: Option<f64>,
    /// Index of each row before which rows were lost, and the number of lost rows.
    pub lost: Vec<(usize, u64)>,
    /// Warnings about the table: code and text.
    pub warnings: Vec<(&'static str, String)>,
    /// Warnings about each column that was read: code and text.
    pub of_columns: Vec<Vec<(&'static str, String)>>,
    /// The reason why no result may be computed from the values: code and text.
    pub refused: Option<(&'static str, String)>,
}

/// A file or table that may be a described table.
pub enum Source {
    /// A file that was not examined.
    File(Input),
    /// A table whose schema was read.
    Table(Box<dyn BatchSource>),
}

/// Opens a described table; `None` if the file is not one. A [`Source::Table`] is passed only if it describes itself.
pub type OpenDescribed = fn(&Path, Source) -> Result<Option<Box<dyn DescribedTable>>, InputError>;
