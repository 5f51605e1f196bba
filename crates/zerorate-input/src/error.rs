//! Errors of inputs. The messages name the file and what is wrong with it.

use crate::NotBuiltIn;
use crate::limits::OverBudget;
use arrow_schema::ArrowError;
#[cfg(feature = "parquet")]
use parquet::errors::ParquetError;
use std::io;
use std::path::{Path, PathBuf};

/// The reason why a file cannot be read or written.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the fields are the words of the message")]
pub enum InputError {
    /// Reading or writing returned an I/O error.
    #[error("cannot {action} {}", path.display())]
    Io { action: &'static str, path: PathBuf, source: io::Error },

    /// The file is not in a supported format.
    #[error("{} cannot be read as a log: {why}", path.display())]
    NotALog { path: PathBuf, why: String },

    /// The format of the file needs a Cargo feature that this build lacks.
    #[error("{}: {missing}", path.display())]
    NotBuiltIn { path: PathBuf, missing: NotBuiltIn },

    /// The content exceeds the memory budget of the file.
    #[error("{}: {why}", path.display())]
    OverBudget { path: PathBuf, why: OverBudget },

    /// The content is wrong. `place` says where in the file, and `what` says how.
    #[error("{}, {place}: {what}", path.display())]
    Damaged { path: PathBuf, place: String, what: String },

    /// The Arrow or Parquet library returned an error that is not an I/O error.
    #[error("cannot {action} {}: {what}", path.display())]
    Table { action: &'static str, path: PathBuf, what: String },

    /// The reader of a [`DescribedTable`](crate::table::DescribedTable) failed.
    #[error(transparent)]
    Described(Box<dyn std::error::Error + Send + Sync>),
}

impl InputError {
    /// The error of an `action` that failed, such as `read`, on the file at `path`.
    pub fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }

    /// The error for a file that is not a log in any supported format.
    pub fn not_a_log(path: &Path, why: impl Into<String>) -> Self {
        Self::NotALog { path: path.to_owned(), why: why.into() }
    }

    /// The error for a file format that this build does not support.
    pub fn not_built_in(path: &Path, missing: NotBuiltIn) -> Self {
        Self::NotBuiltIn { path: path.to_owned(), missing }
    }

    /// The error for a file that takes more memory than allowed.
    pub fn over_budget(path: &Path, why: OverBudget) -> Self {
        Self::OverBudget { path: path.to_owned(), why }
    }

    /// The error for wrong content at `place`.
    pub fn damaged(path: &Path, place: impl Into<String>, what: impl Into<String>) -> Self {
        Self::Damaged { path: path.to_owned(), place: place.into(), what: what.into() }
    }

    /// An error of the Arrow library. An I/O error inside it stays an I/O error.
    pub fn arrow(action: &'static str, path: &Path, error: ArrowError) -> Self {
        match error {
            ArrowError::IoError(_, source) => Self::io(action, path, source),
            other => Self::Table { action, path: path.to_owned(), what: other.to_string() },
        }
    }

    /// An error of the Parquet library. An I/O error inside it stays an I/O error.
    #[cfg(feature = "parquet")]
    pub fn parquet(action: &'static str, path: &Path, error: ParquetError) -> Self {
        let table = Self::Table { action, path: path.to_owned(), what: error.to_string() };
        match error {
            ParquetError::External(source) => {
                source.downcast::<io::Error>().map_or(table, |source| Self::io(action, path, *source))
            }
            _ => table,
        }
    }
}
