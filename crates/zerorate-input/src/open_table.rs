//! Recognises and opens Arrow streams and Parquet files.

use crate::table::BatchSource;
use crate::{Input, InputError, arrows};
use std::path::Path;

/// The result of [`open_table`].
pub enum Opened {
    /// Columns with names and types.
    Table(Box<dyn BatchSource>),
    /// A file of any other format, positioned at its first byte.
    Other(Input),
}

/// Opens an Arrow stream or a Parquet file, recognised by its first bytes. `path` names the file in messages.
///
/// # Errors
/// Returns an error if the file cannot be read, is damaged, or is Parquet and this build lacks Parquet.
pub fn open_table(path: &Path, mut input: Input) -> Result<Opened, InputError> {
    let start = input.start(4).map_err(|error| InputError::io("read", path, error))?;
    match start.as_slice() {
        [0xFF, 0xFF, 0xFF, 0xFF] => Ok(Opened::Table(Box::new(arrows::StreamReader::open(path, input)?))),
        #[cfg(feature = "parquet")]
        b"PAR1" => Ok(Opened::Table(Box::new(crate::parquet::ParquetReader::open(path, input)?))),
        #[cfg(not(feature = "parquet"))]
        b"PAR1" => Err(InputError::not_built_in(path, crate::NotBuiltIn::PARQUET)),
        _ => Ok(Opened::Other(input)),
    }
}
