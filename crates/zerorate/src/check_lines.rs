//! The two check lines of a file: a digest of all other lines, and two bytes of the digest of each such line, so that
//! a changed line can be named.

use alloc::format;
use alloc::string::String;
use alloc::vec::Vec;
use core::fmt::{self, Write};
use serde::Serialize;
use sha2::{Digest, Sha256};

const CHECKSUM: &str = "checksum = \"sha256:";
const LINE_CHECKS: &str = "line_checks = \"";
/// Number of hexadecimal digits for each line.
const DIGITS: usize = 4;

/// The damage that the check lines of a file show. Lines count from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs, reason = "the field is the number of a line")]
pub enum Damage {
    /// This line was edited or added, or a line next to it was removed.
    Changed { line: usize },
    /// The file ends after this line, although more lines were written.
    EndsEarly { line: usize },
}

impl fmt::Display for Damage {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Changed { line } => write!(f, "line {line} is not what was written: it was edited or damaged"),
            Self::EndsEarly { line } => write!(f, "it ends at line {line}, but more was written"),
        }
    }
}

/// The error text for a file that must have check lines and has none.
pub(crate) const UNCHECKED: &str = "it has no check lines, so nothing shows whether it is whole";

pub(crate) fn file(header: &str, fields: &impl Serialize) -> String {
    // a struct of numbers, strings, arrays and tables always has a TOML form
    with_checks(header, &toml::to_string(fields).unwrap_or_default())
}

/// Returns the text of a file: its header, the check lines, and the fields, which are TOML text.
pub(crate) fn with_checks(header: &str, fields: &str) -> String {
    [header, &lines_for(&[header, fields].concat()), fields].concat()
}

/// Returns the two check lines of a text, each with its line end.
fn lines_for(body: &str) -> String {
    let lines: Vec<&str> = normal(body).map(|(_, line)| line).collect();
    let checks: String = lines.iter().map(|line| short(line)).collect();
    format!("{CHECKSUM}{}\"\n{LINE_CHECKS}{checks}\"\n", digest(&checks, &lines))
}

/// Returns whether the file has check lines. `Err` if they do not match the other lines.
pub(crate) fn verify(text: &str) -> Result<bool, Damage> {
    let checksum = value_of(text, CHECKSUM);
    let line_checks = value_of(text, LINE_CHECKS);
    let ((checksum_line, checksum), line_checks) = match (checksum, line_checks) {
        (None, None) => return Ok(false),
        (Some(checksum), Some((_, line_checks))) => (checksum, line_checks),
        (Some((line, _)), None) | (None, Some((line, _))) => return Err(Damage::Changed { line }),
    };
    let body: Vec<(usize, &str)> = normal(text).filter(|(_, line)| !is_check(line)).collect();
    let lines: Vec<&str> = body.iter().map(|(_, line)| *line).collect();
    if digest(line_checks, &lines) == checksum {
        return Ok(true);
    }
    Err(locate(&body, line_checks).unwrap_or(Damage::Changed { line: checksum_line }))
}

/// The text with its check lines left empty, so that every other line keeps its number.
pub(crate) fn without_checks(text: &str) -> String {
    text.lines().map(|line| if is_check(line) { "" } else { line }).collect::<Vec<_>>().join("\n")
}

pub(crate) fn sha256_hex(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().fold(String::new(), |mut hex, byte| {
        // writing into a String cannot fail
        let _ = write!(hex, "{byte:02x}");
        hex
    })
}

/// Finds the first changed line. `None` if a check line itself must have changed.
fn locate(body: &[(usize, &str)], line_checks: &str) -> Option<Damage> {
    let mut expected = line_checks.as_bytes().chunks(DIGITS);
    for (line, text) in body {
        match expected.next() {
            Some(check) if check == short(text).as_bytes() => {}
            _ => return Some(Damage::Changed { line: *line }),
        }
    }
    let line = body.last().map_or(0, |(line, _)| *line);
    expected.next().map(|_| Damage::EndsEarly { line })
}

/// Returns the lines that the check covers, with their numbers. Line ends, trailing blanks and blank lines do not
/// count, because editors and checkouts change them.
fn normal(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(index, line)| (index + 1, line.trim_end())).filter(|(_, line)| !line.is_empty())
}

fn is_check(line: &str) -> bool {
    line.starts_with(CHECKSUM) || line.starts_with(LINE_CHECKS)
}

fn value_of<'a>(text: &'a str, key: &str) -> Option<(usize, &'a str)> {
    normal(text).find_map(|(line, text)| Some((line, text.strip_prefix(key)?.trim_end_matches('"'))))
}

fn digest(line_checks: &str, lines: &[&str]) -> String {
    sha256_hex(&format!("{line_checks}\n{}", lines.join("\n")))
}

fn short(line: &str) -> String {
    sha256_hex(line)[..DIGITS].into()
}
