//! Where a TOML file is wrong, and why, in one line.

use alloc::format;
use alloc::string::String;

/// Letters of a line that are shown of it.
const SHOWN: usize = 80;

/// ``line 4, `noise = "x"`: invalid type …``.
pub fn syntax(text: &str, error: &toml::de::Error) -> String {
    let number = line_of(text, error.span().map_or(0, |span| span.start));
    let line: String = text.lines().nth(number - 1).unwrap_or_default().trim().chars().take(SHOWN).collect();
    format!("line {number}, `{line}`: {}", error.message())
}

/// The line of a byte, from 1.
pub fn line_of(text: &str, byte: usize) -> usize {
    text.as_bytes()[..byte.min(text.len())].iter().filter(|byte| **byte == b'\n').count() + 1
}
