//! Prints data and text for people to stdout, and warnings to stderr.

use super::{CANNOT_WRITE, Stdout, say};
use anyhow::{Context, Result};
use serde::Serialize;
use std::fmt::Display;
use std::io::Write;
use zerorate_input::plain;

/// A closed pipe is returned as an error and does not panic.
pub fn print(text: &str) -> Result<()> {
    let mut stdout = Stdout::lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).context(CANNOT_WRITE)
}

/// Prints lines for people to stdout, without control characters.
pub fn print_lines(text: &str) -> Result<()> {
    print(&plain::lines(text))
}

pub fn print_json(value: &impl Serialize) -> Result<()> {
    print(&(serde_json::to_string_pretty(value)? + "\n"))
}

pub fn warn<T: Display>(warnings: &[T]) {
    for warning in warnings {
        say(format_args!("warning: {warning}"));
    }
}

/// The name `zerorate` and the arguments of this process, joined by spaces, for a page. Quotes are lost.
pub fn command_line() -> String {
    std::iter::once("zerorate".to_owned()).chain(std::env::args().skip(1)).collect::<Vec<_>>().join(" ")
}
