//! Errors of captures. Each message names the file.

use std::io;
use std::path::{Path, PathBuf};
use zerorate_input::InputError;

/// The reasons why a capture cannot be written or read.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the fields are the words of the message")]
pub enum CaptureError {
    /// The file cannot be read or written, or is damaged.
    #[error(transparent)]
    Input(#[from] InputError),

    /// The file is not a capture.
    #[error("{} is not a capture of zerorate: {why}", path.display())]
    NotACapture { path: PathBuf, why: String },

    /// The file name's ending does not state the format of a new capture.
    #[error("{} has no ending of a capture: name it .arrows, .parquet or .csv", path.display())]
    UnknownEnding { path: PathBuf },

    /// The file has a later version of the format.
    #[error("{} is a capture of version {found}, this program reads version {}: use a newer \
        zerorate", path.display(), reads)]
    Newer { path: PathBuf, found: u32, reads: u32 },

    /// The capture has an axis in a unit that this version of the program does not know.
    #[error("{} holds the axis `{axis}` in `{unit}`, which is not a unit of angular rate that this program knows; use \
        a newer zerorate", path.display())]
    OtherQuantity { path: PathBuf, axis: String, unit: String },
}

impl CaptureError {
    /// Makes an I/O error with the action and the file.
    pub fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        InputError::io(action, path, source).into()
    }

    /// Makes the error for a file that is not a capture.
    pub fn not_a_capture(path: &Path, why: impl Into<String>) -> Self {
        Self::NotACapture { path: path.to_owned(), why: why.into() }
    }

    /// Makes the error for invalid content at `place`.
    pub fn damaged(path: &Path, place: impl Into<String>, what: impl Into<String>) -> Self {
        InputError::damaged(path, place, what).into()
    }
}

impl From<CaptureError> for InputError {
    fn from(error: CaptureError) -> Self {
        match error {
            CaptureError::Input(error) => error,
            other => Self::Described(Box::new(other)),
        }
    }
}
