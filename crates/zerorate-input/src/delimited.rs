//! Reads lines and cells of delimited text, with line numbers for error messages.

use super::InputError;
use crate::Input;
use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};

const READ_BUFFER: usize = 1 << 18;

/// A line of this many bytes or more is refused. This bounds the memory if a file is not text.
const MAX_LINE: u64 = 1 << 20;

/// Reads a text file line by line.
pub struct Lines {
    path: PathBuf,
    reader: BufReader<Input>,
    bytes: Vec<u8>,
    number: u64,
    position: u64,
}

/// One line of a text file.
#[derive(Clone, Copy)]
pub struct Line<'a> {
    /// Line number, from 1.
    pub number: u64,
    /// The text, without the line feed and the blanks around it.
    pub text: &'a str,
    /// True if a line feed ends the line. The last line of a file may lack it.
    pub ended: bool,
}

impl Lines {
    /// Reads the lines of `input`. `path` names the file in messages.
    pub fn new(path: &Path, input: Input) -> Self {
        Self {
            path: path.to_owned(),
            reader: BufReader::with_capacity(READ_BUFFER, input),
            bytes: Vec::new(),
            number: 0,
            position: 0,
        }
    }

    /// Offset of the next line, bytes.
    pub fn position(&self) -> u64 {
        self.position
    }

    /// The number of the line read last, from 1. At the end of the text, the number of lines plus 1.
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The next line that is not blank; `None` at the end of the text.
    pub fn next_line(&mut self) -> Result<Option<Line<'_>>, InputError> {
        while self.read()? {
            if !self.text()?.is_empty() {
                let ended = self.bytes.ends_with(b"\n");
                return Ok(Some(Line { number: self.number, text: self.text()?, ended }));
            }
        }
        Ok(None)
    }

    fn read(&mut self) -> Result<bool, InputError> {
        self.bytes.clear();
        self.number += 1;
        let mut bounded = std::io::Read::take(&mut self.reader, MAX_LINE);
        let read =
            bounded.read_until(b'\n', &mut self.bytes).map_err(|error| InputError::io("read", &self.path, error))?;
        self.position += read as u64;
        if read as u64 == MAX_LINE {
            return Err(self.wrong("the line is longer than 1 MB: is this a text file?"));
        }
        Ok(read > 0)
    }

    fn text(&self) -> Result<&str, InputError> {
        let text = std::str::from_utf8(&self.bytes)
            .map_err(|_| self.wrong("not UTF-8 text: columns of raw numbers need their type"))?;
        Ok(text.strip_prefix('\u{FEFF}').unwrap_or(text).trim_ascii())
    }

    fn wrong(&self, what: &str) -> InputError {
        InputError::damaged(&self.path, format!("line {}", self.number), what)
    }
}

/// True if a text looks like a table: one of its first 100 lines has several cells, at least one of them a number.
/// Lines that are delimited by blanks, or contain `=` or `[`, do not count.
pub fn is_table(text: &str) -> bool {
    let has_numbers = |line: &str| {
        let delimiter = Delimiter::detect(line);
        let is_cut = delimiter != Delimiter::Blanks && !line.contains(['=', '[']);
        is_cut && delimiter.cells(line).count() > 1 && delimiter.cells(line).any(|cell| cell.parse::<f64>().is_ok())
    };
    text.lines().take(100).any(has_numbers)
}

/// The separator between the cells of a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Delimiter {
    /// `,`
    #[default]
    Comma,
    /// `;`
    Semicolon,
    /// The tab character.
    Tab,
    /// `|`
    Bar,
    /// One or more blanks.
    Blanks,
}

impl Delimiter {
    /// The delimiter of a line of data: the first of tab, semicolon, bar, comma, blank that the line contains. It is
    /// the comma if the line contains none of them.
    pub fn detect(line: &str) -> Self {
        match line {
            line if line.contains('\t') => Self::Tab,
            line if line.contains(';') => Self::Semicolon,
            line if line.contains('|') => Self::Bar,
            line if line.contains(',') => Self::Comma,
            line if line.contains(' ') => Self::Blanks,
            _ => Self::Comma,
        }
    }

    /// The cells of a line, without quotes and blanks around them.
    pub fn cells(self, line: &str) -> Cells<'_> {
        Cells { rest: Some(line), delimiter: self }
    }

    /// The byte that separates cells; `None` for a run of blanks.
    pub fn byte(self) -> Option<u8> {
        match self {
            Self::Comma => Some(b','),
            Self::Semicolon => Some(b';'),
            Self::Tab => Some(b'\t'),
            Self::Bar => Some(b'|'),
            Self::Blanks => None,
        }
    }

    fn split(self, line: &str) -> Option<(&str, &str)> {
        match self.byte() {
            Some(byte) => line.split_once(char::from(byte)),
            None => line.split_once([' ', '\t']).map(|(before, after)| (before, after.trim_start())),
        }
    }
}

/// An iterator over the cells of a line.
pub struct Cells<'a> {
    rest: Option<&'a str>,
    delimiter: Delimiter,
}

impl<'a> Iterator for Cells<'a> {
    type Item = &'a str;

    fn next(&mut self) -> Option<&'a str> {
        let rest = self.rest?.trim_start_matches([' ', '\u{A0}']);
        let quoted = rest.strip_prefix('"').and_then(|inner| inner.split_once('"'));
        let (cell, tail) = quoted.map_or((None, rest), |(cell, tail)| (Some(cell), tail));
        let (before, after) = match self.delimiter.split(tail) {
            Some((before, after)) => (before, Some(after)),
            None => (tail, None),
        };
        self.rest = after;
        Some(cell.unwrap_or(before).trim())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_of_every_delimiter() {
        let lines = ["1, 2 ,x", "1;2;x", "1 | 2|x", "1\t2\tx", "  1   2 x", "\"1\",\"2\",\"x\"", "\"1\" 2 \"x\""];
        for line in lines {
            let cells: Vec<_> = Delimiter::detect(line).cells(line.trim()).collect();
            assert_eq!(cells, ["1", "2", "x"], "{line:?}");
        }
    }

    #[test]
    fn a_table_is_told_from_other_text() {
        for table in ["t,x\n0,1.5\n", "# log\nt;x\n0;1,5\n", "0\t1\n"] {
            assert!(is_table(table), "{table:?}");
        }
        for other in ["", "t,x\n", "[correction]\nt3_c = 24.5 # a, 1\n", "seen 1, then 2\n"] {
            assert!(!is_table(other), "{other:?}");
        }
    }

    #[test]
    fn empty_and_quoted_cells_keep_their_place() {
        let cells: Vec<_> = Delimiter::Comma.cells("a,,\"b, c\",").collect();
        assert_eq!(cells, ["a", "", "b, c", ""]);
        let cells: Vec<_> = Delimiter::Tab.cells("a\t\tb").collect();
        assert_eq!(cells, ["a", "", "b"]);
    }
}
