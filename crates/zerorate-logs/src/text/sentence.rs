//! Reads sentences of a serial line: `$VNYMR,+073.2,…,+00.000043*68`. The two hexadecimal digits behind `*` are the
//! exclusive or of the bytes between `$` and `*` (NMEA 0183). Four digits are the CRC-16 of these bytes (VectorNav).

use crc::{CRC_16_XMODEM, Crc};
use std::collections::BTreeMap;

/// The body of a sentence, and the checksum that `*` announces. The checksum covers the body.
fn parts(line: &str) -> Option<(&str, &str)> {
    let (body, sum) = line.strip_prefix('$')?.rsplit_once('*')?;
    let is_sum = matches!(sum.len(), 2 | 4) && sum.bytes().all(|byte| byte.is_ascii_hexdigit());
    is_sum.then_some((body, sum))
}

/// A line without the checksum of a sentence, without the brackets of a Python list, and without the `;` that some
/// programs put at the end of a line. That `;` is kept if the line has another one, or neither two commas nor a comma
/// and a point.
pub fn without_end(line: &str) -> &str {
    let line = parts(line).map_or(line, |(body, _)| &line[..=body.len()]);
    let line = in_brackets(line).unwrap_or(line);
    let are_cells = |rest: &str| rest.contains(',') && rest.contains('.') || rest.matches(',').count() > 1;
    line.strip_suffix(';').filter(|rest| !rest.contains(';') && are_cells(rest)).unwrap_or(line)
}

/// The cells between the brackets of a list or a tuple: of `[0.01, 0.2],`.
fn in_brackets(line: &str) -> Option<&str> {
    let inner = line.trim_end_matches(',').strip_suffix([']', ')'])?.trim_end_matches([']', ')']);
    let cells = inner.strip_prefix(['[', '('])?.trim_start_matches(['[', '(']);
    (cells.contains(',') && !cells.contains(['[', ']', '(', ')', '{', '"'])).then_some(cells)
}

/// Removes the same parts as [`without_end`], and verifies the checksum. Returns an error if the checksum is wrong.
pub fn checked(line: &str) -> Result<&str, String> {
    let Some((body, stated)) = parts(line) else { return Ok(without_end(line)) };
    let found = match stated.len() {
        2 => format!("{:02X}", body.bytes().fold(0, |sum, byte| sum ^ byte)),
        _ => format!("{:04X}", Crc::<u16>::new(&CRC_16_XMODEM).checksum(body.as_bytes())),
    };
    match found.eq_ignore_ascii_case(stated) {
        true => Ok(&line[..=body.len()]),
        false => Err(format!("its checksum is {found}, and it states {stated}")),
    }
}

/// The first cell of a sentence, such as `$VNYMR`.
fn tag(line: &str) -> Option<&str> {
    line.starts_with('$').then(|| line.split(',').next().unwrap_or(line))
}

/// The first cell of the most frequent kind of sentence. A receiver sends several kinds, and one of them is the log.
pub fn most<'a>(lines: impl Iterator<Item = &'a str>) -> Option<String> {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    lines.filter_map(tag).for_each(|tag| *counts.entry(tag).or_default() += 1);
    counts.into_iter().max_by_key(|(_, count)| *count).map(|(tag, _)| tag.to_owned())
}

/// True if a line is a sentence of another kind than the one that is read.
pub fn is_other(line: &str, read: Option<&str>) -> bool {
    read.is_some() && tag(line).is_some_and(|tag| Some(tag) != read)
}
