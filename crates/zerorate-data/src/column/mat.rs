//! MATLAB files of version 5 to 7.2 (MathWorks, MAT-File Format, R2023b): matrices of real numbers, by the name of the
//! variable, and those in structures of one element by `variable.field`. Any other variable is none of the log's.

use super::choice::{Choice, Columns, same_length};
use super::clock::Times;
use super::open::Log;
use super::series::SeriesBuilder;
use super::{Asked, Clock, Found, FoundColumn, Result};
use crate::Note;
use crate::capture::CaptureError;
use crate::limits::Room;
use flate2::read::ZlibDecoder;
use std::io::{BufReader, Read};
use std::path::Path;

/// Bytes that a read asks the system for.
const BUFFER: usize = 1 << 18;

/// Text, and what tells the order of bytes.
const HEAD: usize = 128;

/// Columns of a matrix at most: with more it is rather an image.
const MAX_COLUMNS: usize = 4096;

/// How deep structures stand in structures, at most.
const MAX_DEPTH: usize = 4;

const INT8: u32 = 1;
const SINGLE: u32 = 7;
const DOUBLE: u32 = 9;
const INT64: u32 = 12;
const UINT64: u32 = 13;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

/// Reads columns of its matrices.
pub fn read(log: Log<'_>, asked: &Asked<'_>) -> Result<Found> {
    let Log { path, input, room, .. } = log;
    let mut file = BufReader::with_capacity(BUFFER, input);
    let (variables, torn) = variables(path, &mut file, room)?;
    let columns: Vec<Variable<'_>> = variables.iter().flat_map(Element::columns).collect();
    let names = columns.iter().map(|column| column.name.as_str()).collect();
    let all = Columns { path, names, numeric: vec![true; columns.len()], settings: asked.args.names };
    let Choice { values: chosen, time } = all.choose(asked.wanted, asked.args, &[])?;
    let wanted: Vec<&Variable<'_>> = chosen.iter().chain(&time).map(|at| &columns[*at]).collect();
    same_length(path, wanted.iter().map(|column| (column.name.as_str(), column.rows() as u64)))?;
    let found = chosen.iter().map(|at| columns[*at].values(path, room, chosen.len()));
    let found = found.collect::<Result<Vec<_>, _>>()?;
    let clock = match time.map(|time| &columns[time]) {
        Some(time) => Clock::Column(time.name.clone(), time.times(path)?),
        None => Clock::Silent,
    };
    Ok(Found { columns: found, clock, warnings: Note::torn(torn) })
}

/// The variables of a file, unpacked, up to where it is torn, which is said.
fn variables(
    path: &Path,
    file: &mut BufReader<crate::Input>,
    room: Room,
) -> Result<(Vec<Element>, Option<String>), CaptureError> {
    let mut head = [0; HEAD];
    let damaged = |what: &str| CaptureError::damaged(path, "as a MATLAB file", what);
    file.read_exact(&mut head).map_err(|_| damaged("it ends in its head"))?;
    let big_endian = match &head[HEAD - 2..] {
        b"IM" => false,
        b"MI" => true,
        _ => return Err(damaged("its head does not tell the order of bytes")),
    };
    let (mut all, mut bytes, mut torn) = (Vec::new(), 0u64, None);
    loop {
        let mut tag = [0; 8];
        let mut data = Vec::new();
        let read = file.read_exact(&mut tag).ok();
        if read.is_none() {
            break;
        }
        let (kind, length) = (number(&tag[..4], big_endian), number(&tag[4..], big_endian));
        let there = file.take(length.into()).read_to_end(&mut data);
        let there = there.map_err(|error| CaptureError::io("read", path, error))?;
        let kind = if kind == COMPRESSED {
            data = unpacked(&data, room);
            None
        } else {
            Some(kind)
        };
        bytes = bytes.saturating_add(data.len() as u64);
        room.check(bytes).map_err(|why| CaptureError::no_room(path, why))?;
        // a packed element has its tag inside
        let element = match kind {
            Some(kind) => Element::new(kind, data, big_endian),
            None => Parts { bytes: &data, big_endian }
                .next()
                .map(|(kind, part)| (kind, part.to_vec()))
                .and_then(|(kind, part)| Element::new(kind, part, big_endian)),
        };
        all.extend(element);
        if (there as u64) < u64::from(length) {
            let path = path.display();
            torn = Some(format!("{path} ends inside a variable, which is dropped"));
            break;
        }
    }
    Ok((all, torn))
}

fn unpacked(packed: &[u8], room: Room) -> Vec<u8> {
    let mut bytes = Vec::new();
    // what does not unpack is no variable; what is too much is found by its length
    let _ = ZlibDecoder::new(packed).take(room.bytes().saturating_add(1)).read_to_end(&mut bytes);
    bytes
}

fn number(bytes: &[u8], big_endian: bool) -> u32 {
    match (bytes.first_chunk(), big_endian) {
        (Some(bytes), true) => u32::from_be_bytes(*bytes),
        (Some(bytes), false) => u32::from_le_bytes(*bytes),
        (None, _) => 0,
    }
}

/// The parts of a matrix: type and bytes.
struct Parts<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Iterator for Parts<'a> {
    type Item = (u32, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let first = number(self.bytes.get(..4)?, self.big_endian);
        // up to four bytes stand in the tag itself
        if first >> 16 != 0 {
            let (part, rest) = self.bytes.split_at_checked(8)?;
            self.bytes = rest;
            return Some((first & 0xFFFF, part[4..].get(..(first >> 16) as usize)?));
        }
        let length = number(self.bytes.get(4..8)?, self.big_endian) as usize;
        let part = self.bytes.get(8..8usize.checked_add(length)?)?;
        let end = 8 + length.next_multiple_of(8);
        self.bytes = self.bytes.get(end..).unwrap_or_default();
        Some((first, part))
    }
}

/// A variable: its bytes.
struct Element {
    data: Vec<u8>,
    big_endian: bool,
}

impl Element {
    fn new(kind: u32, data: Vec<u8>, big_endian: bool) -> Option<Self> {
        (kind == MATRIX).then_some(Self { data, big_endian })
    }

    fn columns(&self) -> Vec<Variable<'_>> {
        let mut found = Vec::new();
        collect(Parts { bytes: &self.data, big_endian: self.big_endian }, "", MAX_DEPTH, &mut found);
        found
    }
}

/// A column of a matrix.
struct Variable<'a> {
    name: String,
    kind: u32,
    /// Those of the matrix.
    bytes: &'a [u8],
    /// Where the first number of the column stands in it, and how far it is to the next.
    first: usize,
    step: usize,
    len: usize,
    big_endian: bool,
}

const STRUCTURE: u8 = 2;
const NUMBERS: std::ops::RangeInclusive<u8> = 6..=15;
const COMPLEX: u8 = 0x08;

/// Finds the columns of a matrix, whose name is `name` if it has none itself.
fn collect<'a>(mut parts: Parts<'a>, name: &str, depth: usize, found: &mut Vec<Variable<'a>>) -> Option<()> {
    let big_endian = parts.big_endian;
    let depth = depth.checked_sub(1)?;
    let flags = number(parts.next()?.1, big_endian).to_le_bytes();
    let dimensions: Vec<u32> = parts.next()?.1.chunks_exact(4).map(|chunk| number(chunk, big_endian)).collect();
    let own = String::from_utf8_lossy(parts.next()?.1).into_owned();
    let name = if name.is_empty() { own } else { name.to_owned() };
    let [rows, columns] = dimensions[..] else { return None };
    let (rows, columns) = (rows as usize, columns as usize);
    match flags[0] {
        STRUCTURE if rows == 1 && columns == 1 => {
            let length = number(parts.next()?.1, big_endian) as usize;
            let names = parts.next()?.1.chunks_exact(length.max(1));
            for field in names {
                let end = field.iter().position(|byte| *byte == 0).unwrap_or(field.len());
                let (kind, bytes) = parts.next()?;
                let name = format!("{name}.{}", String::from_utf8_lossy(&field[..end]));
                if kind == MATRIX {
                    collect(Parts { bytes, big_endian }, &name, depth, found);
                }
            }
        }
        class if NUMBERS.contains(&class) && flags[1] & COMPLEX == 0 => {
            let (kind, bytes) = parts.next()?;
            let size = size(kind)?;
            (rows.checked_mul(columns)?.checked_mul(size)? == bytes.len()).then_some(())?;
            split(&name, kind, bytes, (rows, columns), big_endian, found);
        }
        _ => {}
    }
    Some(())
}

/// A vector is one column, whichever way it lies; of a matrix, what is longer are the samples.
fn split<'a>(
    name: &str,
    kind: u32,
    bytes: &'a [u8],
    (rows, columns): (usize, usize),
    big_endian: bool,
    found: &mut Vec<Variable<'a>>,
) {
    let (count, len) = (rows.min(columns), rows.max(columns));
    // a single number is none of the log's columns
    if len < 2 || count > MAX_COLUMNS {
        return;
    }
    let upright = rows >= columns;
    found.extend((0..count).map(|at| {
        let (first, step) = if upright { (at * rows, 1) } else { (at, rows) };
        let name = if count == 1 { name.to_owned() } else { format!("{name}.{at}") };
        Variable { name, kind, bytes, first, step, len, big_endian }
    }));
}

fn size(kind: u32) -> Option<usize> {
    Some(match kind {
        1 | 2 => 1,
        3 | 4 => 2,
        5..=SINGLE => 4,
        DOUBLE | INT64 | UINT64 => 8,
        _ => return None,
    })
}

enum Value {
    Integer(i64),
    Number(f64),
}

impl Variable<'_> {
    fn rows(&self) -> usize {
        self.len
    }

    fn cells(&self) -> impl Iterator<Item = Value> {
        let size = size(self.kind).unwrap_or(1);
        let unused = 64 - 8 * size as u32;
        (0..self.len).map(move |row| {
            let bytes = &self.bytes[(self.first + row * self.step) * size..][..size];
            let mut wide = [0; 8];
            wide[..size].copy_from_slice(bytes);
            if self.big_endian {
                wide[..size].reverse();
            }
            let bits = u64::from_le_bytes(wide);
            match self.kind {
                SINGLE => Value::Number(f32::from_bits(bits as u32).into()),
                DOUBLE => Value::Number(f64::from_bits(bits)),
                INT8 | 3 | 5 | INT64 => Value::Integer((bits << unused) as i64 >> unused),
                _ => i64::try_from(bits).map_or(Value::Number(bits as f64), Value::Integer),
            }
        })
    }

    fn values(&self, path: &Path, room: Room, sharing: usize) -> Result<FoundColumn, CaptureError> {
        let mut values = SeriesBuilder::sharing(room, sharing);
        values.check_room(self.rows() as u64).map_err(|why| CaptureError::no_room(path, why))?;
        for (row, cell) in self.cells().enumerate() {
            match cell {
                Value::Integer(integer) => values.push_integer(integer),
                Value::Number(number) if values.push_number(number) => {}
                Value::Number(_) => return Err(self.wrong(path, row, "it is infinite, which cannot be averaged")),
            }
        }
        Ok(FoundColumn::new(self.name.clone(), values))
    }

    fn times(&self, path: &Path) -> Result<Times, CaptureError> {
        let mut times = Times::new();
        for (row, cell) in self.cells().enumerate() {
            match cell {
                Value::Integer(integer) => times.push_integer(integer),
                Value::Number(number) => {
                    times.push_number(number).map_err(|what| self.wrong(path, row, &what))?;
                }
            }
        }
        Ok(times)
    }

    fn wrong(&self, path: &Path, row: usize, what: &str) -> CaptureError {
        super::wrong(path, format_args!("column {}, row {row}", self.name), what)
    }
}
