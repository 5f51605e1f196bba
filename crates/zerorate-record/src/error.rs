//! Errors of captures: each message names the file and says what to do.

use arrow_schema::ArrowError;
#[cfg(feature = "parquet")]
use parquet::errors::ParquetError;
use std::io;
use std::path::{Path, PathBuf};
use zerorate_input::{InputError, NotBuiltIn};

/// Why a capture could not be written or read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the fields are the words of the message")]
pub enum CaptureError {
    /// The file cannot be read or written, or is damaged.
    #[error(transparent)]
    Input(#[from] InputError),

    /// Some other file.
    #[error("{} is not a capture of zerorate: {why}", path.display())]
    NotACapture { path: PathBuf, why: String },

    /// A name for a new capture that does not say which form it is to have.
    #[error("{} has no ending of a capture: name it .arrows, .parquet or .csv", path.display())]
    UnknownEnding { path: PathBuf },

    /// Written by a later version of the format.
    #[error("{} is a capture of version {found}, this program reads version {}: use a newer \
        zerorate", path.display(), reads)]
    Newer { path: PathBuf, found: u32, reads: u32 },

    /// A capture of something that this version of the program does not know.
    #[error("{} holds the axis `{axis}` in `{unit}`, which is not a unit of angular rate that this program knows; use \
        a newer zerorate", path.display())]
    OtherQuantity { path: PathBuf, axis: String, unit: String },
}

impl CaptureError {
    /// An I/O error, with what was being done to which file.
    pub fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        InputError::io(action, path, source).into()
    }

    /// The file is of another kind.
    pub fn not_a_capture(path: &Path, why: impl Into<String>) -> Self {
        Self::NotACapture { path: path.to_owned(), why: why.into() }
    }

    /// The form of the file is missing in this build.
    pub fn not_built_in(path: &Path, missing: NotBuiltIn) -> Self {
        InputError::not_built_in(path, missing).into()
    }

    /// The content of the file is wrong at `place`.
    pub fn damaged(path: &Path, place: impl Into<String>, what: impl Into<String>) -> Self {
        InputError::damaged(path, place, what).into()
    }

    /// An error of the Arrow library; what lies below it as an I/O error is kept as one.
    pub fn arrow(action: &'static str, path: &Path, error: ArrowError) -> Self {
        InputError::arrow(action, path, error).into()
    }

    /// An error of the Parquet library, likewise.
    #[cfg(feature = "parquet")]
    pub fn parquet(action: &'static str, path: &Path, error: ParquetError) -> Self {
        InputError::parquet(action, path, error).into()
    }
}

/// As an error of the reader of a described table.
impl From<CaptureError> for InputError {
    fn from(error: CaptureError) -> Self {
        match error {
            CaptureError::Input(error) => error,
            other => Self::Described(Box::new(other)),
        }
    }
}
