//! What the Python package takes from the command line beside [`main`](crate::main).

pub use crate::commands::allan::temperature::{NAMES as TEMPERATURES, Settled, Settling, heed, widened};

use crate::column;
use crate::commands::allan::temperature;
use std::path::Path;
use zerorate_logs::{Column, ColumnOptions};

/// The temperature of the log at `path`: the column `name`, or one by the usual names; none where there is none.
#[must_use]
pub fn temperature(path: &Path, name: Option<&str>, options: &ColumnOptions) -> Option<Column> {
    let read = |names: &[&str]| column::temperature(path, names, options);
    match name {
        Some(name) => read(&[name]),
        None => temperature::usual(path, read),
    }
}
