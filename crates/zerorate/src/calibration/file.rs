//! The calibration as a TOML file.

use super::check::{self, Damage};
use super::{Calibration, PART, SCHEMA};
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use serde::Deserialize;

const HEADER: &str = "# A zerorate calibration (docs/formats/calibration.md). To use other numbers, edit a copy and \
    delete its two check lines.\n";

/// Why a text is no calibration. Lines count from 1.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum FileError {
    /// Not TOML, or not the fields of a calibration.
    Syntax { line: usize, message: String },
    /// Written by newer software.
    Newer { line: usize, schema: u32 },
    /// No longer what was written.
    Edited { line: usize },
    /// The end is missing.
    Truncated { line: usize },
    /// Another part's, or a number that cannot be.
    Value { line: usize, name: &'static str, why: &'static str },
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Syntax { line, message } => write!(f, "line {line}: {message}"),
            Self::Newer { line, schema } => write!(
                f,
                "line {line}: schema {schema} was written by a newer zerorate; this one reads up to schema {SCHEMA}, \
                 so update it"
            ),
            Self::Edited { line } => write!(
                f,
                "line {line} is not what was written: the file was edited or damaged; take the original, or delete \
                 the lines `checksum` and `line_checks` to use it as a hand-written calibration"
            ),
            Self::Truncated { line } => {
                write!(f, "the file ends at line {line}, but more was written: it is truncated; take the original")
            }
            Self::Value { line, name, why } => write!(f, "line {line}: {name} {why}"),
        }
    }
}

impl core::error::Error for FileError {}

/// What there is to know of a calibration that was read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum FileWarning {
    /// It was written by hand, or its check lines were taken out.
    NoChecksum,
}

impl fmt::Display for FileWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoChecksum => f.write_str(
                "the calibration has no checksum: nothing shows whether its numbers are as they were measured",
            ),
        }
    }
}

impl Calibration {
    /// Reads a calibration file.
    ///
    /// # Errors
    /// What is wrong, with the line.
    ///
    /// ```
    /// use zerorate::calibration::{Calibration, FileWarning};
    /// let head = "schema = 1\npart = \"ADIS16130\"\n";
    /// let by_hand = format!("{head}[correction]\npbc_dps = -0.25\nbtc_dps_per_c = -0.04\nt3_c = 31.5\n");
    /// let (calibration, warnings) = Calibration::parse(&by_hand)?;
    /// assert_eq!(calibration.correction.pbc_dps, -0.25);
    /// assert_eq!(warnings, [FileWarning::NoChecksum]);
    /// # Ok::<(), zerorate::calibration::FileError>(())
    /// ```
    pub fn parse(text: &str) -> Result<(Self, Vec<FileWarning>), FileError> {
        refuse_newer(text)?;
        let checked = check::verify(text).map_err(|damage| match damage {
            Damage::Changed { line } => FileError::Edited { line },
            Damage::EndsEarly { line } => FileError::Truncated { line },
        })?;
        let fields = check::without_checks(text);
        let calibration: Self = toml::from_str(&fields).map_err(|error| syntax(text, &error))?;
        calibration.validate(text)?;
        validate_all(text, &toml::from_str(&fields).map_err(|error| syntax(text, &error))?)?;
        Ok((calibration, if checked { Vec::new() } else { [FileWarning::NoChecksum].into() }))
    }

    /// The file, with its check lines. Numbers come back bit for bit.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // a struct of numbers, strings and tables always has a TOML form
        let fields = toml::to_string(self).unwrap_or_default();
        let body = [HEADER, &fields].concat();
        [HEADER, &check::lines_for(&body), &fields].concat()
    }

    fn validate(&self, text: &str) -> Result<(), FileError> {
        let require = |name, holds, why| {
            if holds { Ok(()) } else { Err(FileError::Value { line: line_of(text, name), name, why }) }
        };
        let correction = &self.correction;
        require("part", self.part == PART, "is not ADIS16130: this calibration is another part's")?;
        require("schema", self.schema >= 1, "must be 1")?;
        require("pbc_dps", correction.pbc_dps.abs() <= 250.0, "must be a number within the range of ±250 °/s")?;
        require("btc_dps_per_c", correction.btc_dps_per_c.abs() <= 10.0, "must be a number within ±10 °/s/°C")?;
        require("t3_c", (-60.0..=150.0).contains(&correction.t3_c), "must be a temperature within −60 … 150 °C")?;
        let ordered = self.validity.is_none_or(|span| span.temp_min_c <= span.temp_max_c);
        require("temp_min_c", ordered, "must not lie above temp_max_c")?;
        for (name, temp_c) in
            self.validity.iter().flat_map(|s| [("temp_min_c", s.temp_min_c), ("temp_max_c", s.temp_max_c)])
        {
            let possible = (-100.0..=200.0).contains(&temp_c);
            require(name, possible, "must be a temperature within −100 … 200 °C")?;
        }
        for (name, share) in self.uncertainty.iter().map(|u| ("coverage", u.coverage)) {
            require(name, share > 0.0 && share < 1.0, "must be a probability between 0 and 1")?;
        }
        Ok(())
    }
}

/// No number of a calibration is larger, whatever its unit.
const LARGEST: f64 = 1e9;

/// What holds for every value, wherever it stands: numbers are such that one can compute with them, and texts are one
/// line each, because the check lines count lines.
fn validate_all(text: &str, table: &toml::Table) -> Result<(), FileError> {
    let refused = |name: &str, what: &str| {
        Err(FileError::Syntax { line: line_of(text, name), message: alloc::format!("`{name}` {what}") })
    };
    for (name, value) in table {
        let texts = match value {
            toml::Value::Array(texts) => texts.as_slice(),
            one => core::slice::from_ref(one),
        };
        match value {
            toml::Value::Table(inner) => validate_all(text, inner)?,
            toml::Value::Float(number) if number.is_nan() || number.abs() > LARGEST => {
                return refused(name, "is no number that a measurement can have");
            }
            _ if texts.iter().filter_map(toml::Value::as_str).any(|text| text.contains(char::is_control)) => {
                return refused(name, "holds control characters; it must be one line of plain text");
            }
            _ => {}
        }
    }
    Ok(())
}

/// All that is asked of a newer file before it is refused.
#[derive(Deserialize)]
struct Head {
    schema: Option<u32>,
}

fn refuse_newer(text: &str) -> Result<(), FileError> {
    let head: Head = toml::from_str(text).map_err(|error| syntax(text, &error))?;
    match head.schema {
        Some(schema) if schema > SCHEMA => Err(FileError::Newer { line: line_of(text, "schema"), schema }),
        _ => Ok(()),
    }
}

fn syntax(text: &str, error: &toml::de::Error) -> FileError {
    let start = error.span().map_or(0, |span| span.start).min(text.len());
    let line = text.as_bytes()[..start].iter().filter(|byte| **byte == b'\n').count() + 1;
    FileError::Syntax { line, message: error.message().to_string() }
}

fn line_of(text: &str, key: &str) -> usize {
    let is_key = |line: &str| line.split('=').next().is_some_and(|name| name.trim() == key);
    text.lines().position(is_key).map_or(1, |index| index + 1)
}
