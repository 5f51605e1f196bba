//! A text in blocks of whole lines.

use crate::Input;
use crate::capture::CaptureError;
use memchr::memrchr;
use std::borrow::Cow;
use std::io::Read;
use std::path::Path;

/// Bytes of a block, unless a line is longer.
#[cfg(not(test))]
const BLOCK: usize = 1 << 22;
/// Small enough that small texts have several.
#[cfg(test)]
const BLOCK: usize = 1 << 12;

/// The longest line, a bound on memory when a file is no text at all.
const MAX_LINE: usize = 1 << 20;

/// Bytes of whole lines. The last line of a text may lack its line feed.
pub struct Block {
    /// Its lines.
    pub bytes: Vec<u8>,
    /// Whether the text ends with it.
    pub is_last: bool,
}

impl Block {
    /// Its text; what is no UTF-8 is replaced, so that a line that a cable broke is one broken line.
    pub fn text(&self) -> Cow<'_, str> {
        // to look first is fast where all is as it should be
        std::str::from_utf8(&self.bytes).map_or_else(|_| String::from_utf8_lossy(&self.bytes), Cow::Borrowed)
    }
}

/// Reads blocks.
pub struct Blocks<'a> {
    path: &'a Path,
    input: Input,
    /// What was read of a line that is not whole.
    rest: Vec<u8>,
    ended: bool,
}

impl<'a> Blocks<'a> {
    /// Of `input`, which `path` names in messages.
    pub fn new(path: &'a Path, input: Input) -> Self {
        Self { path, input, rest: Vec::new(), ended: false }
    }

    /// The next block; none behind the last.
    pub fn next(&mut self) -> Result<Option<Block>, CaptureError> {
        if self.ended {
            return Ok(None);
        }
        let mut bytes = std::mem::take(&mut self.rest);
        loop {
            let before = bytes.len();
            bytes.reserve_exact(BLOCK);
            let read = (&mut self.input).take(BLOCK as u64).read_to_end(&mut bytes);
            let read = read.map_err(|error| CaptureError::io("read", self.path, error))?;
            self.ended = read < BLOCK;
            if self.ended {
                return Ok((!bytes.is_empty()).then_some(Block { bytes, is_last: true }));
            }
            if let Some(end) = memrchr(b'\n', &bytes[before..]) {
                self.rest = bytes.split_off(before + end + 1);
                return Ok(Some(Block { bytes, is_last: false }));
            }
            if bytes.len() > MAX_LINE {
                let what = "a line is longer than 1 MB: is this a text file?";
                return Err(CaptureError::damaged(self.path, "as a text file", what));
            }
        }
    }

    /// As many blocks as are to be had, up to `count`.
    pub fn several(&mut self, count: usize) -> Result<Vec<Block>, CaptureError> {
        let mut blocks = Vec::with_capacity(count);
        while blocks.len() < count
            && let Some(block) = self.next()?
        {
            blocks.push(block);
        }
        Ok(blocks)
    }
}
