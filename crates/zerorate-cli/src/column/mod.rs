//! One column of numbers out of any log: a capture, Parquet, an Arrow stream, CSV, or raw binary numbers.

mod raw;
mod tabular;
mod text;

pub use raw::RawType;

use crate::capture::table::{self, Opened};
use crate::exit::Usage;
use anyhow::Result;
use std::path::Path;

/// A column, and what its file says about it.
#[derive(Debug, PartialEq)]
pub struct Column {
    /// Its name, or its number where columns have no names.
    pub name: String,
    /// The numbers in order.
    pub series: Series,
    /// Physical unit per step of the numbers: 1 unless the file is a capture.
    pub scale: f64,
    /// What a capture tells beyond its numbers.
    pub timing: Option<Timing>,
    /// What is to be said about the file: a tail that was torn off.
    pub warning: Option<String>,
}

/// Numbers, as exact as the file has them.
#[derive(Debug, PartialEq)]
pub enum Series {
    /// Integers.
    Codes(Vec<i32>),
    /// Anything else; all finite.
    Numbers(Vec<f64>),
}

impl Series {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Self::Codes(codes) => codes.len(),
            Self::Numbers(numbers) => numbers.len(),
        }
    }
}

/// Time in a capture.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Timing {
    /// Mean rate of the samples, those that were lost included.
    pub rate_hz: Option<f64>,
    /// Samples lost between the first row and the last.
    pub lost: u64,
}

/// Reads a column of the file at `path`: by name, or by its number counted from 0; without either, the one there can be no doubt about.
pub fn read(path: &Path, wanted: Option<&str>, raw: Option<RawType>) -> Result<Column> {
    if let Some(raw) = raw {
        return raw::read(path, raw);
    }
    match table::open(path)? {
        Opened::Table(source) => tabular::read(path, source, wanted),
        Opened::Text(file) => text::read(path, file, wanted),
    }
}

/// The position of the wanted column among `names`. A name goes before a number.
fn position(path: &Path, names: &[&str], wanted: &str) -> Result<usize> {
    let by_name = names.iter().position(|name| *name == wanted);
    let by_number = || wanted.parse().ok().filter(|number| *number < names.len());
    by_name.or_else(by_number).ok_or_else(|| ambiguous(path, &format!("has no column `{wanted}`"), names))
}

/// Says which columns there are to choose from.
fn ambiguous(path: &Path, why: &str, names: &[&str]) -> anyhow::Error {
    let listed: Vec<String> = names.iter().enumerate().map(|(number, name)| format!("{number} `{name}`")).collect();
    Usage(format!("{} {why}; choose with --column one of: {}", path.display(), listed.join(", "))).into()
}
