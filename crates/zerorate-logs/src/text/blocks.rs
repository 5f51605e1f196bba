//! Reads a text in blocks of whole lines.

use super::marks::Marks;
use memchr::{memchr, memrchr};
use std::borrow::Cow;
use std::io::{ErrorKind, Read};
use std::path::Path;
use zerorate_input::{Input, InputError};

/// Size of a block in bytes, unless a line is longer.
#[cfg(not(test))]
const BLOCK: usize = 1 << 22;
/// A small size, so that small texts have several blocks.
#[cfg(test)]
const BLOCK: usize = 1 << 12;

/// Number of bytes at the start that tell whether a file is text.
const BINARY_START: usize = 4096;

/// Control characters are at most one in this many characters of a text.
const MOST_CONTROL: usize = 20;
/// Up to this many control characters count as broken text, even in a short file.
const FEWEST_CONTROL: usize = 20;

/// A line that is longer than this, in bytes, and than a block is refused. This bounds the memory if a file is not
/// text.
const MAX_LINE: usize = 1 << 20;

/// Bytes of whole lines. The last line of a text may lack its line feed.
pub struct Block {
    buffer: Vec<u8>,
    /// The end of the whole lines in the buffer.
    end: usize,
    pub is_last: bool,
}

impl Block {
    pub fn bytes(&self) -> &[u8] {
        &self.buffer[..self.end]
    }

    /// True if the start has more control characters than a text that a bad cable corrupted.
    pub fn is_binary(&self) -> bool {
        let start = &self.bytes()[..self.end.min(BINARY_START)];
        let is_control = |byte: &&u8| byte.is_ascii_control() && !byte.is_ascii_whitespace();
        start.iter().filter(is_control).count() > FEWEST_CONTROL.max(start.len() / MOST_CONTROL)
    }

    /// The text of the lines. Bytes that are not UTF-8 are replaced, so that a corrupted line stays one line.
    pub fn text(&self) -> Cow<'_, str> {
        // valid text, the usual case, is not copied
        std::str::from_utf8(self.bytes()).map_or_else(|_| String::from_utf8_lossy(self.bytes()), Cow::Borrowed)
    }

    /// The text for names: lines that may be Latin-1 are read as Latin-1, because Excel writes `°/s` so.
    pub fn legible(&self) -> Cow<'_, str> {
        let of_line = |line: &[u8]| {
            let is_text = line.iter().all(|byte| matches!(byte, b'\t' | b'\r' | b'\n' | b' '..=b'~' | 0xA0..));
            match std::str::from_utf8(line) {
                Err(_) if is_text => line.iter().map(|byte| char::from(*byte)).collect(),
                _ => String::from_utf8_lossy(line).into_owned(),
            }
        };
        let by_lines = || self.bytes().split_inclusive(|byte| *byte == b'\n').map(of_line).collect();
        std::str::from_utf8(self.bytes()).map_or_else(|_| Cow::Owned(by_lines()), Cow::Borrowed)
    }
}

pub struct Blocks<'a> {
    path: &'a Path,
    input: Input,
    /// The start of a line that is not complete yet.
    rest: Vec<u8>,
    ended: bool,
    /// Buffers of used blocks. To allocate new ones would take as long as to read into them.
    spare: Vec<Vec<u8>>,
    /// The delimiter to put between a stamp and the next line; `None` if stamps have no lines of their own.
    stamps: Option<u8>,
    marks: Marks,
}

impl<'a> Blocks<'a> {
    pub fn new(path: &'a Path, input: Input) -> Self {
        Self { path, input, rest: Vec::new(), ended: false, spare: Vec::new(), stamps: None, marks: Marks::default() }
    }

    /// Reads blocks in which each line that is only a stamp is joined with the next line by this delimiter.
    pub fn with_stamps(self, stamps: Option<u8>) -> Self {
        Self { stamps, ..self }
    }

    pub fn without_marks(self, marks: &Marks) -> Self {
        Self { marks: marks.clone(), ..self }
    }

    pub fn reuse(&mut self, blocks: Vec<Block>) {
        self.spare.extend(blocks.into_iter().map(|block| block.buffer));
    }

    pub fn next(&mut self) -> Result<Option<Block>, InputError> {
        if self.ended {
            return Ok(None);
        }
        let mut buffer = self.spare.pop().unwrap_or_default();
        let mut filled = self.rest.len();
        buffer.resize(buffer.len().max(filled + BLOCK), 0);
        buffer[..filled].copy_from_slice(&self.rest);
        loop {
            let before = filled;
            filled += self.fill(&mut buffer[before..])?;
            self.ended = filled < buffer.len();
            if self.ended {
                self.join(&mut buffer[..filled]);
                self.marks.erase(&mut buffer[..filled]);
                return Ok((filled > 0).then_some(Block { buffer, end: filled, is_last: true }));
            }
            if let Some(end) = self.end(&buffer, before) {
                self.rest.clear();
                self.rest.extend_from_slice(&buffer[end..]);
                self.join(&mut buffer[..end]);
                self.marks.erase(&mut buffer[..end]);
                return Ok(Some(Block { buffer, end, is_last: false }));
            }
            if filled > MAX_LINE {
                let what = "a line is longer than 1 MB: is this a text file?";
                return Err(InputError::damaged(self.path, "as a text file", what));
            }
            buffer.resize(filled + BLOCK, 0);
        }
    }

    /// The end of the last whole line in the buffer, if it is behind `before`. A stamp stays with the line that
    /// follows.
    fn end(&self, buffer: &[u8], before: usize) -> Option<usize> {
        let end = before + memrchr(b'\n', &buffer[before..])? + 1;
        let Some(stamps) = self.stamps else { return Some(end) };
        let start = memrchr(b'\n', &buffer[..end - 1]).map_or(0, |at| at + 1);
        let end = if is_stamp(&buffer[start..end], stamps) { start } else { end };
        (end > 0).then_some(end)
    }

    /// Joins each stamp with the line that follows it.
    fn join(&self, lines: &mut [u8]) {
        let Some(stamps) = self.stamps else { return };
        let mut start = 0;
        while let Some(end) = memchr(b'\n', &lines[start..]).map(|at| start + at) {
            if is_stamp(&lines[start..end], stamps) {
                lines[end] = stamps;
            }
            start = end + 1;
        }
    }

    /// Reads until the buffer is full or the text ends.
    fn fill(&mut self, buffer: &mut [u8]) -> Result<usize, InputError> {
        let mut filled = 0;
        while filled < buffer.len() {
            match self.input.read(&mut buffer[filled..]) {
                Ok(0) => break,
                Ok(read) => filled += read,
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(InputError::io("read", self.path, error)),
            }
        }
        Ok(filled)
    }

    pub fn several(&mut self, count: usize) -> Result<Vec<Block>, InputError> {
        let mut blocks = Vec::with_capacity(count);
        while blocks.len() < count
            && let Some(block) = self.next()?
        {
            blocks.push(block);
        }
        Ok(blocks)
    }
}

/// True if a line begins as a number or a date does, and has one cell only.
fn is_stamp(line: &[u8], delimiter: u8) -> bool {
    let line = line.trim_ascii();
    line.first().is_some_and(|first| matches!(first, b'0'..=b'9' | b'-' | b'+' | b'.')) && !line.contains(&delimiter)
}
