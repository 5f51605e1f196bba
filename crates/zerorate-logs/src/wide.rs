//! Converts text in UTF-16, as Windows and LabVIEW write it, to UTF-8.

use std::io::{self, BufReader, Read};
use std::path::Path;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{Input, InputError};

const BUFFER: usize = 1 << 16;

/// True if UTF-16 text is big endian; `None` if the start does not show UTF-16.
fn order(start: &[u8]) -> Option<bool> {
    let ascii = |at: usize| start[2..].iter().skip(at).step_by(2).all(|byte| (1..0x80).contains(byte));
    let zeros = |at: usize| start[2..].iter().skip(at).step_by(2).all(|byte| *byte == 0);
    match start {
        [0xFF, 0xFE, _, zero, ..] => (*zero == 0).then_some(false),
        [0xFE, 0xFF, zero, ..] => (*zero == 0).then_some(true),
        [first, 0, _, _, _, _, ..] if (1..0x80).contains(first) && ascii(0) && zeros(1) => Some(false),
        [0, first, _, _, _, _, ..] if (1..0x80).contains(first) && zeros(0) && ascii(1) => Some(true),
        _ => None,
    }
}

/// Converts text in UTF-16 to UTF-8. Any other input is returned as it is. `start` are the first bytes of the input.
pub fn narrowed(path: &Path, input: Input, start: &[u8], room: MemoryBudget) -> Result<Input, InputError> {
    let failed = |error| InputError::io("read", path, error);
    let Some(is_big) = order(start) else { return Ok(input) };
    // two bytes of UTF-16 become at most three bytes of UTF-8, so twice the length is enough
    let length = input.length().map_err(failed)?;
    room.check_on_disk(length.saturating_mul(2)).map_err(|why| InputError::over_budget(path, why))?;
    let again = input.try_clone().map_err(failed)?;
    let text = again.unpacked(|out| write(BufReader::with_capacity(BUFFER, input), is_big, out));
    text.map_err(failed)
}

fn write(mut wide: impl Read, is_big: bool, out: &mut dyn io::Write) -> io::Result<()> {
    let units = std::iter::from_fn(move || {
        let mut unit = [0; 2];
        wide.read_exact(&mut unit).ok()?;
        Some(if is_big { u16::from_be_bytes(unit) } else { u16::from_le_bytes(unit) })
    });
    let mut text = String::with_capacity(BUFFER);
    for character in char::decode_utf16(units) {
        text.push(character.unwrap_or(char::REPLACEMENT_CHARACTER));
        if text.len() >= BUFFER {
            out.write_all(text.as_bytes())?;
            text.clear();
        }
    }
    out.write_all(text.as_bytes())
}
