//! Warnings about the end of a file.

use crate::{Input, InputError};
use std::fmt;
use std::path::Path;

/// A warning about the end of a file. The content before it is valid.
#[derive(Clone, Debug, PartialEq)]
pub enum InputWarning {
    /// The file lacks its end, or a part of it cannot be read. The text says what is dropped.
    Torn(String),
    /// Bytes other than zeros follow the end of the content.
    BytesBehindEnd {
        /// The name of the file.
        path: String,
        /// The number of bytes behind the end of the content.
        bytes: u64,
    },
}

impl InputWarning {
    /// The codes of all warnings.
    pub fn codes() -> [&'static str; 2] {
        [Self::Torn(String::new()), Self::BytesBehindEnd { path: String::new(), bytes: 0 }]
            .map(|warning| warning.code())
    }

    /// Short stable name, for scripts.
    #[must_use]
    pub const fn code(&self) -> &'static str {
        match self {
            Self::Torn(_) => "torn-tail",
            Self::BytesBehindEnd { .. } => "bytes-behind-end",
        }
    }

    /// The warning if bytes other than zeros follow `end`, the offset at which the content ends; `None` otherwise.
    ///
    /// # Errors
    /// Returns an error if the bytes cannot be read.
    pub fn behind_end(path: &Path, input: &Input, end: u64) -> Result<Option<Self>, InputError> {
        let bytes = input.bytes_behind(end).map_err(|error| InputError::io("read", path, error))?;
        Ok((bytes > 0).then(|| Self::BytesBehindEnd { path: path.display().to_string(), bytes }))
    }
}

impl fmt::Display for InputWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Torn(text) => f.write_str(text),
            Self::BytesBehindEnd { path, bytes } => {
                write!(f, "{path}: {bytes} bytes after its end are ignored; were two files joined?")
            }
        }
    }
}
