//! Reads and writes a calibration as a TOML file.

use super::form::CalibrationForm;
use super::{Calibration, SCHEMA};
use crate::check_lines::{self, Damage};
use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt;
use serde::Deserialize;
use zerorate_allan::entry::{Document, EntryError};
use zerorate_allan::rows;

const HEADER: &str = "# A zerorate calibration (docs/formats/calibration.md). To use other numbers, edit a copy and \
    delete its two check lines.\n";

/// The reason why a text is not a calibration. Lines count from 1.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum FileError {
    /// The text is not TOML, or does not have the fields of a calibration.
    Syntax { line: usize, axis: Option<String>, message: String },
    /// Newer software wrote the file.
    Newer { line: usize, schema: u32 },
    /// The text has changed since it was written.
    Edited { line: usize },
    /// The end of the text is missing.
    Truncated { line: usize },
    /// A value is impossible, or does not belong to the part or the schema of the file.
    Value { line: usize, axis: Option<String>, name: &'static str, why: String },
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax { line, axis, message } => write!(f, "line {line}{}: {message}", of(axis.as_ref())),
            Self::Newer { line, schema } => write!(
                f,
                "line {line}: a newer zerorate wrote schema {schema}, and this one reads up to schema {SCHEMA}. \
                 Update zerorate"
            ),
            Self::Edited { line } => write!(
                f,
                "line {line} is not what was written: the file was edited or damaged. Take the original, or delete \
                 the lines `checksum` and `line_checks` to use it as a hand-written calibration"
            ),
            Self::Truncated { line } => {
                write!(f, "the file is truncated: it ends at line {line}, but more was written. Take the original")
            }
            Self::Value { line, axis, name, why } => write!(f, "line {line}{}: {name} {why}", of(axis.as_ref())),
        }
    }
}

/// Returns `, axis NAME`, which follows the number of a line that belongs to an axis.
fn of(axis: Option<&String>) -> String {
    axis.map_or_else(String::new, |axis| format!(", axis {}", axis.escape_default()))
}

impl core::error::Error for FileError {}

impl From<EntryError> for FileError {
    fn from(EntryError { line, axis, key, what, .. }: EntryError) -> Self {
        let line = line.unwrap_or(1);
        match key {
            Some(name) => Self::Value { line, axis, name, why: what },
            None => Self::Syntax { line, axis, message: what },
        }
    }
}

/// A warning about a calibration that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileWarning {
    /// The file was written by hand, or its check lines were taken out.
    NoChecksum,
}

rows!(match FileWarning as Display {
    Self::NoChecksum => Row {
        code: "no-checksum",
        text: format_args!("this calibration has no checksum, so changes go unseen; use the file as it was written"),
    },
});

impl Calibration {
    /// Whether a text begins as the calibrations that zerorate writes. The rest may be missing.
    #[must_use]
    pub fn is_begun_by(text: &str) -> bool {
        text.starts_with("# A zerorate calibration")
    }

    /// Reads a calibration file.
    ///
    /// # Errors
    /// Returns the first error that the checks find, with its line.
    ///
    /// ```
    /// use zerorate::calibration::{Calibration, FileWarning};
    /// let head = "schema = 1\npart = \"ADIS16130\"\n";
    /// let by_hand = format!("{head}[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n");
    /// let (calibration, warnings) = Calibration::parse(&by_hand)?;
    /// assert_eq!(calibration.axes[0].correction.pbc_dps, -0.25);
    /// assert_eq!(warnings, [FileWarning::NoChecksum]);
    /// # Ok::<(), zerorate::calibration::FileError>(())
    /// ```
    pub fn parse(text: &str) -> Result<(Self, Vec<FileWarning>), FileError> {
        refuse_newer(text)?;
        let checked = check_lines::verify(text).map_err(|damage| match damage {
            Damage::Changed { line } => FileError::Edited { line },
            Damage::EndsEarly { line } => FileError::Truncated { line },
        })?;
        let fields = check_lines::without_checks(text);
        let document = Document::parse(&fields)?;
        let form: CalibrationForm = document.fields()?;
        form.check(&document)?;
        Ok((form.into_calibration(), if checked { Vec::new() } else { [FileWarning::NoChecksum].into() }))
    }

    /// Writes the text of the file, with its check lines. [`Calibration::parse`] gives the same numbers bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        check_lines::file(HEADER, self)
    }
}

/// The only field that is read from a newer file before the file is refused.
#[derive(Deserialize)]
struct Head {
    schema: Option<u32>,
}

fn refuse_newer(text: &str) -> Result<(), FileError> {
    let document = Document::parse(text)?;
    match document.fields::<Head>()?.schema {
        Some(schema) if schema > SCHEMA => {
            let line = document.root().at("schema").line().unwrap_or(1);
            Err(FileError::Newer { line, schema })
        }
        _ => Ok(()),
    }
}
