//! Entries of a TOML file, with their line numbers, valid values and error texts.

use alloc::format;
use alloc::string::{String, ToString};
use alloc::vec::Vec;
use core::fmt;
use core::ops::RangeInclusive;
use serde::de::DeserializeOwned;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

/// The top-level tables and keys of a part file (`docs/formats/part.md`). [`crate::DataSheet`] reads the noise
/// figures, and the `zerorate` crate the rest.
pub const PART_KEYS: [&str; 14] = [
    "schema",
    "name",
    "maker",
    "source",
    "alternates",
    "axis",
    "rate",
    "temperature",
    "noise",
    "bias",
    "self_heating",
    "resonance",
    "gyroscope",
    "accelerometer",
];

/// Largest number of characters of a line that an error quotes.
const SHOWN: usize = 80;

/// A TOML file: its text and its tables. An error in a table of the list `axis` names that axis.
pub struct Document<'t> {
    text: &'t str,
    root: Spanned<DeValue<'t>>,
}

/// One entry of a document: its key, its value and its line.
#[derive(Clone, Copy)]
pub struct Entry<'d> {
    document: &'d Document<'d>,
    /// The value; `None` if the entry is missing.
    value: Option<&'d Spanned<DeValue<'d>>>,
    key: &'static str,
    /// Byte offset of the entry, or of the table that lacks it. `None` if the whole file lacks it.
    byte: Option<usize>,
}

/// An error in an entry. Lines count from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EntryError {
    /// The line; `None` if the error concerns the whole file.
    pub line: Option<usize>,
    /// Name of the axis that holds the line, or the number of the axis if it has no name. `None` outside the axes.
    pub axis: Option<String>,
    /// The key; `None` unless the error concerns the value of one key.
    pub key: Option<&'static str>,
    /// Text of the line, for an error in the syntax or in the fields.
    quoted: Option<String>,
    /// The problem, and the valid values.
    pub what: String,
}

/// The range of numbers that an entry may have.
pub enum Bounds {
    /// Above zero.
    Positive,
    /// Zero or above.
    NotNegative,
    /// Within these limits, in this unit.
    Within(RangeInclusive<f64>, &'static str),
}

impl<'t> Document<'t> {
    /// Parses a text into tables.
    ///
    /// # Errors
    /// Returns an error if the text is not TOML.
    pub fn parse(text: &'t str) -> Result<Self, EntryError> {
        let root = DeTable::parse(text).map_err(|error| EntryError::syntax(text, &error))?;
        Ok(Self { text, root: Spanned::new(root.span(), DeValue::Table(root.into_inner())) })
    }

    /// Deserialises the whole text.
    ///
    /// # Errors
    /// Returns an error if a field is unknown, missing or of another type.
    pub fn fields<T: DeserializeOwned>(&self) -> Result<T, EntryError> {
        toml::from_str(self.text).map_err(|error| {
            let axis = self.axis_at(start(&error));
            EntryError { axis, ..EntryError::syntax(self.text, &error) }
        })
    }

    /// The root table of the file. [`Entry::at`] finds the entries in it.
    #[must_use]
    pub fn root(&self) -> Entry<'_> {
        Entry { document: self, value: Some(&self.root), key: "", byte: None }
    }

    /// Calls `judge` with each key and value of the root table and of all nested tables.
    ///
    /// # Errors
    /// Returns the first error of `judge`, with its line.
    pub fn each(&self, judge: impl Fn(&str, &DeValue<'_>) -> Result<(), String>) -> Result<(), EntryError> {
        let mut tables: Vec<&DeTable<'_>> = self.root.get_ref().as_table().into_iter().collect();
        while let Some(table) = tables.pop() {
            for (name, value) in table {
                judge(name.get_ref(), value.get_ref()).map_err(|what| self.error(name.span().start, None, what))?;
                let elements = value.get_ref().as_array().into_iter().flatten().map(Spanned::get_ref);
                tables.extend(elements.chain([value.get_ref()]).filter_map(DeValue::as_table));
            }
        }
        Ok(())
    }

    fn error(&self, byte: usize, key: Option<&'static str>, what: String) -> EntryError {
        let line = Some(line_of(self.text, byte));
        EntryError { line, axis: self.axis_at(byte), key, quoted: None, what }
    }

    /// The axis that holds the byte: the last axis that begins before it, if no other table begins in between.
    fn axis_at(&self, byte: usize) -> Option<String> {
        let mut begins: Vec<(usize, Option<String>)> = Vec::new();
        for (name, value) in self.root.get_ref().as_table()? {
            match value.get_ref().as_array().filter(|_| name.get_ref() == "axis") {
                Some(axes) => begins.extend(axes.iter().enumerate().map(|(index, axis)| {
                    let name = axis.get_ref().get("name").and_then(|name| name.get_ref().as_str());
                    (axis.span().start, Some(name.map_or_else(|| (index + 1).to_string(), ToString::to_string)))
                })),
                None => begins.push((name.span().start.min(value.span().start), None)),
            }
        }
        begins.into_iter().filter(|(start, _)| *start <= byte).max_by_key(|(start, _)| *start)?.1
    }
}

impl<'d> Entry<'d> {
    /// The entry of this key in this table.
    #[must_use]
    pub fn at(self, key: &'static str) -> Self {
        let table = self.value.and_then(|value| value.get_ref().as_table());
        match table.and_then(|table| table.iter().find(|(name, _)| name.get_ref() == key)) {
            Some((name, value)) => Self { key, value: Some(value), byte: Some(name.span().start), ..self },
            None => Self { key, value: None, ..self },
        }
    }

    /// Checks that this table has no keys but these.
    ///
    /// # Errors
    /// Returns an error that names the first unknown key.
    pub fn only(self, keys: &[&str]) -> Result<(), EntryError> {
        let table = self.value.and_then(|value| value.get_ref().as_table());
        match table.and_then(|table| table.iter().find(|(name, _)| !keys.contains(&&**name.get_ref()))) {
            None => Ok(()),
            Some((name, _)) => {
                let what = format!("{} is unknown; use {}", name.get_ref(), keys.join(", "));
                Err(self.document.error(name.span().start, None, what))
            }
        }
    }

    /// The element of this list at an index, from 0.
    #[must_use]
    pub fn item(self, index: usize) -> Self {
        let value = self.value.and_then(|value| value.get_ref().get(index));
        Self { value, byte: value.map_or(self.byte, |value| Some(value.span().start)), ..self }
    }

    /// The key of the entry, or of the list that holds the entry.
    #[must_use]
    pub fn key(self) -> &'static str {
        self.key
    }

    /// The line of the entry, or of the table that lacks it. `None` if the whole file lacks it.
    #[must_use]
    pub fn line(self) -> Option<usize> {
        self.byte.map(|byte| line_of(self.document.text, byte))
    }

    /// The value as written in the file; empty if missing.
    #[must_use]
    pub fn written(self) -> &'d str {
        self.value.and_then(|value| self.document.text.get(value.span())).unwrap_or_default()
    }

    /// Returns `value` if it is within `bounds`.
    ///
    /// # Errors
    /// Returns [`EntryError`] if the value is out of bounds.
    pub fn number(self, value: f64, bounds: &Bounds) -> Result<f64, EntryError> {
        self.require(bounds.hold(value), || format!("{} is {value}; {bounds}", self.key))?;
        Ok(value)
    }

    /// Returns the error `why` for this entry if `holds` is false.
    ///
    /// # Errors
    /// Returns [`EntryError`] if `holds` is false.
    pub fn require(self, holds: bool, why: impl FnOnce() -> String) -> Result<(), EntryError> {
        if holds { Ok(()) } else { Err(self.error(why())) }
    }

    /// An error about this entry, with its line and axis.
    #[must_use]
    pub fn error(self, what: impl fmt::Display) -> EntryError {
        let (key, what) = (Some(self.key), what.to_string());
        match self.byte {
            Some(byte) => self.document.error(byte, key, what),
            None => EntryError { line: None, axis: None, key, quoted: None, what },
        }
    }
}

impl Bounds {
    /// Whether a number is within the bounds.
    #[must_use]
    pub fn hold(&self, value: f64) -> bool {
        match self {
            Self::Positive => value > 0.0 && value.is_finite(),
            Self::NotNegative => value >= 0.0 && value.is_finite(),
            Self::Within(range, _) => range.contains(&value),
        }
    }
}

impl fmt::Display for Bounds {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Positive => f.write_str("it must be above zero"),
            Self::NotNegative => f.write_str("it must not be negative"),
            Self::Within(range, unit) => write!(f, "give a number from {} to {} {unit}", range.start(), range.end()),
        }
    }
}

impl EntryError {
    fn syntax(text: &str, error: &toml::de::Error) -> Self {
        let line = line_of(text, start(error));
        let quoted = text.lines().nth(line - 1).unwrap_or_default().trim().chars().take(SHOWN).collect();
        Self { line: Some(line), axis: None, key: None, quoted: Some(quoted), what: error.message().to_string() }
    }
}

impl fmt::Display for EntryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            let axis = self.axis.as_ref().map(|axis| format!(", axis {}", axis.escape_default())).unwrap_or_default();
            let quoted = self.quoted.as_ref().map(|line| format!(", `{line}`")).unwrap_or_default();
            write!(f, "line {line}{axis}{quoted}: ")?;
        }
        f.write_str(self.what.trim_end())
    }
}

impl core::error::Error for EntryError {}

fn start(error: &toml::de::Error) -> usize {
    error.span().map_or(0, |span| span.start)
}

/// Line number of a byte offset, from 1.
fn line_of(text: &str, byte: usize) -> usize {
    text.as_bytes()[..byte.min(text.len())].iter().filter(|byte| **byte == b'\n').count() + 1
}
