//! Reads rows of samples from a recording in any supported format.

use crate::PartLog;
use crate::warning::of_capture;
use std::io::Seek;
use std::path::{Path, PathBuf};
use zerorate::Part;
use zerorate_input::{Input, InputError};
use zerorate_logs::{ColumnOptions, LogError, LogWarning};
use zerorate_record::{CaptureError, CaptureInfo, CaptureReader, Row};

/// A reader of rows, from a capture or from a part's log.
pub enum RowReader {
    /// A capture, which describes its part.
    Capture(Box<CaptureReader>),
    /// A log of a part that the user described.
    Log(Box<PartLog>),
}

impl RowReader {
    /// Opens a capture, or else a log of `part`. `path` names the file in messages. `args` are for logs only.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or is damaged, or if it is not a capture and `part` is not given or
    /// is the ADIS16130.
    pub fn open(path: &Path, mut input: Input, part: Option<&Part>, args: &ColumnOptions) -> Result<Self, LogError> {
        let failed = |error| InputError::io("read", path, error);
        let again = input.try_clone().map_err(failed)?;
        let part = part.filter(|part| part.name != Part::ADIS16130.name);
        match (CaptureReader::open(path, again), part) {
            (Ok(capture), _) => Ok(Self::Capture(Box::new(capture))),
            (Err(CaptureError::NotACapture { .. }), Some(part)) => {
                input.rewind().map_err(failed)?;
                Ok(Self::Log(Box::new(PartLog::open(path, input, part, args)?)))
            }
            (Err(CaptureError::NotACapture { path, why }), None) => {
                let kind = input.rewind().map_err(failed).and_then(|()| zerorate_logs::kind(&path, input));
                Err(not_a_capture(path, why, kind).into())
            }
            (Err(error), _) => Err(InputError::from(error).into()),
        }
    }

    /// The description of the rows.
    #[must_use]
    pub fn info(&self) -> &CaptureInfo {
        match self {
            Self::Capture(capture) => capture.info(),
            Self::Log(log) => log.info(),
        }
    }

    /// The warnings, complete after all rows were read.
    #[must_use]
    pub fn warnings(&self) -> Vec<LogWarning> {
        match self {
            Self::Capture(capture) => capture.warnings().iter().map(of_capture).collect(),
            Self::Log(log) => log.warnings().to_vec(),
        }
    }
}

/// The error for a file that is not a capture if no part is given. `kind` is the format of the file in words.
fn not_a_capture(path: PathBuf, why: String, kind: Result<String, InputError>) -> InputError {
    let why = match kind {
        Err(known @ InputError::NotALog { .. }) => return known,
        // a folder
        Err(_) => why,
        Ok(_) => format!("{why}; for a log of other software name its part, as docs/formats/part.md says"),
    };
    CaptureError::NotACapture { path, why }.into()
}

impl Iterator for RowReader {
    type Item = Result<Row, CaptureError>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        match self {
            Self::Capture(capture) => capture.next(),
            Self::Log(log) => log.next().map(Ok),
        }
    }
}
