//! Reads MATLAB files of version 5 to 7.2 (MathWorks, MAT-File Format, R2023b). Matrices of real numbers have the name
//! of their variable, or `variable.field` in a structure of one element. Other variables are ignored.
//!
//! Compressed data carries a checksum (Adler-32), other data carries none. A matrix whose size and data disagree is an
//! error, because nobody would notice that its columns were left out.

use super::binary::{BinaryNumber, Coding};
use super::clock::Times;
use super::open::{BUFFER, Log, MATLAB};
use super::series::SeriesBuilder;
use crate::choice::{Choice, Columns};
use crate::error::{Result, object_of_matlab};
use crate::query::ColumnQuery;
use crate::raw_columns::{RawColumn, RawColumns};
use crate::stated_rate::StatedRate;
use crate::warning::LogWarning;
use flate2::read::ZlibDecoder;
use std::io::{BufReader, Read};
use std::path::Path;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{InputError, InputWarning};

/// Size of the file header in bytes: text, version, and the mark of the byte order.
const HEAD: usize = 128;

/// Size of an element's tag in bytes: type and length.
const TAG: usize = 8;

/// Largest number of columns of a matrix; one with more is probably an image.
const MAX_COLUMNS: usize = 4096;

const MAX_DEPTH: usize = 4;

const INT8: u32 = 1;
const SINGLE: u32 = 7;
const DOUBLE: u32 = 9;
const INT64: u32 = 12;
const UINT64: u32 = 13;
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, input, room, .. } = log;
    let mut file = BufReader::with_capacity(BUFFER, input);
    let (variables, of_end) = variables(path, &mut file, room)?;
    let mut columns: Vec<Variable<'_>> = Vec::new();
    for (number, variable) in variables.iter().enumerate() {
        variable.columns(&mut columns).map_err(|what| damaged(path, number, &what))?;
    }
    // a single number is not a column of the log, and may be its sample rate
    let (columns, single): (Vec<_>, Vec<_>) = columns.into_iter().partition(|column| column.rows > 1);
    let stated_rate = StatedRate::among(single.iter().filter_map(Variable::number));
    if let (true, Some((name, class))) = (columns.is_empty(), variables.iter().find_map(Element::object)) {
        return Err(object_of_matlab(path, &name, &class));
    }
    let names = columns.iter().map(|column| column.name.as_str()).collect();
    let all =
        Columns { path, names, numeric: vec![true; columns.len()], clocks: Vec::new(), settings: asked.args.names };
    let (Choice { values: chosen, time, .. }, _) =
        all.choose_alike(asked.wanted, asked.args, |at| columns[at].rows as u64)?;
    let found = chosen.iter().map(|at| columns[*at].values(path, room, chosen.len()));
    let found = found.collect::<Result<Vec<_>, _>>()?;
    let time = time.map(|time| Ok::<_, InputError>((columns[time].name.clone(), columns[time].times(path)?)));
    Ok(RawColumns { stated_rate, ..RawColumns::new(found, time.transpose()?, of_end.map(LogWarning::File)) })
}

/// The unpacked variables of a file, and a warning if the file is torn or another file follows.
fn variables(
    path: &Path,
    file: &mut BufReader<zerorate_input::Input>,
    room: MemoryBudget,
) -> Result<(Vec<Element>, Option<InputWarning>), InputError> {
    let big_endian = is_big_endian(path, file)?;
    let (mut all, mut bytes, mut end) = (Vec::new(), 0u64, HEAD as u64);
    while let Some(Packed { kind, length, data }) = Packed::next(path, file, big_endian)? {
        if kind == number(MATLAB, big_endian) {
            return Ok((all, InputWarning::behind_end(path, file.get_ref(), end)?));
        }
        end += (TAG + length) as u64;
        if data.len() < length {
            let path = path.display();
            return Ok((all, Some(InputWarning::Torn(format!("{path} ends inside a variable, which is dropped")))));
        }
        let wrong = |what: &str| damaged(path, all.len(), what);
        let data = match kind {
            MATRIX => data,
            COMPRESSED => unpacked(&data, room).map_err(|what| wrong(&what))?,
            kind => return Err(wrong(&format!("it is an element of type {kind}, which no variable has"))),
        };
        bytes = bytes.saturating_add(data.len() as u64);
        room.check(bytes).map_err(|why| InputError::over_budget(path, why))?;
        // a compressed element contains a whole element with its tag
        let data = match (kind, (Parts { bytes: &data, big_endian }).next()) {
            (MATRIX, _) => data,
            (_, Some((MATRIX, part))) => part.to_vec(),
            _ => return Err(wrong("what is packed in it is not a matrix, or is too short")),
        };
        all.push(Element { data, big_endian });
    }
    Ok((all, None))
}

/// The error for a variable. `before` is the number of variables before it in the file.
fn damaged(path: &Path, before: usize, what: &str) -> InputError {
    InputError::damaged(path, format!("variable {} of a MATLAB file", before + 1), what)
}

fn is_big_endian(path: &Path, file: &mut BufReader<zerorate_input::Input>) -> Result<bool, InputError> {
    let mut head = [0; HEAD];
    let damaged = |what: &str| InputError::damaged(path, "as a MATLAB file", what);
    file.read_exact(&mut head).map_err(|_| damaged("it ends in its head"))?;
    match &head[HEAD - 2..] {
        b"IM" => Ok(false),
        b"MI" => Ok(true),
        _ => Err(damaged("its head does not tell the order of bytes")),
    }
}

/// An element of the file, which may be compressed.
struct Packed {
    kind: u32,
    /// Number of data bytes that the element states.
    length: usize,
    /// The data bytes that the file has.
    data: Vec<u8>,
}

impl Packed {
    /// Reads the next element; `None` at the end of the file. If its tag is cut off, the element states data but has
    /// none.
    fn next(
        path: &Path,
        file: &mut BufReader<zerorate_input::Input>,
        big_endian: bool,
    ) -> Result<Option<Self>, InputError> {
        let failed = |error| InputError::io("read", path, error);
        let (mut tag, mut data) = (Vec::new(), Vec::new());
        file.take(TAG as u64).read_to_end(&mut tag).map_err(failed)?;
        if tag.is_empty() {
            return Ok(None);
        }
        let Some((kind, length)) = tag.split_at_checked(4).filter(|(_, length)| length.len() == 4) else {
            return Ok(Some(Self { kind: MATRIX, length: 8, data }));
        };
        let (kind, length) = (number(kind, big_endian), number(length, big_endian));
        file.take(length.into()).read_to_end(&mut data).map_err(failed)?;
        Ok(Some(Self { kind, length: length as usize, data }))
    }
}

fn unpacked(packed: &[u8], room: MemoryBudget) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    // one byte over the limit shows that there is too much
    let read = ZlibDecoder::new(packed).take(room.bytes().saturating_add(1)).read_to_end(&mut bytes);
    read.map(|_| bytes).map_err(|error| format!("it cannot be unpacked ({error}): take another copy of the file"))
}

fn number(bytes: &[u8], big_endian: bool) -> u32 {
    match (bytes.first_chunk(), big_endian) {
        (Some(bytes), true) => u32::from_be_bytes(*bytes),
        (Some(bytes), false) => u32::from_le_bytes(*bytes),
        (None, _) => 0,
    }
}

/// Iterates over the parts of a matrix: type and bytes.
struct Parts<'a> {
    bytes: &'a [u8],
    big_endian: bool,
}

impl<'a> Iterator for Parts<'a> {
    type Item = (u32, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let first = number(self.bytes.get(..4)?, self.big_endian);
        // a part of up to four bytes is stored in its tag
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

impl<'a> Parts<'a> {
    fn part(&mut self, what: &str) -> Result<(u32, &'a [u8]), String> {
        self.next().ok_or_else(|| format!("its {what} are missing or cut short"))
    }
}

/// The bytes of a variable.
struct Element {
    data: Vec<u8>,
    big_endian: bool,
}

impl Element {
    fn columns<'a>(&'a self, found: &mut Vec<Variable<'a>>) -> Result<(), String> {
        collect(Parts { bytes: &self.data, big_endian: self.big_endian }, "", MAX_DEPTH, found)
    }

    /// Name and class of the variable, if it is an object, such as a timetable.
    fn object(&self) -> Option<(String, String)> {
        let mut parts = Parts { bytes: &self.data, big_endian: self.big_endian };
        let is_object = number(parts.next()?.1, self.big_endian).to_le_bytes()[0] == OBJECT;
        let mut text = || Some(String::from_utf8_lossy(parts.next()?.1).into_owned());
        // the name of the type system, MCOS, is between them
        let (name, _, class) = (text()?, text()?, text()?);
        is_object.then_some((name, class))
    }
}

/// A column of a matrix.
struct Variable<'a> {
    name: String,
    kind: u32,
    bytes: &'a [u8],
    /// Index of the first number of the column in `bytes`, and the distance to the next, counted in numbers.
    first: usize,
    step: usize,
    rows: usize,
    big_endian: bool,
}

const STRUCTURE: u8 = 2;
const OBJECT: u8 = 17;
const NUMBERS: std::ops::RangeInclusive<u8> = 6..=15;
const COMPLEX: u8 = 0x08;

/// Finds the columns of a matrix. Their names begin with `name` or, if `name` is empty, with the name of the matrix.
/// Only structures of one element and matrices of real numbers have columns.
fn collect<'a>(mut parts: Parts<'a>, name: &str, depth: usize, found: &mut Vec<Variable<'a>>) -> Result<(), String> {
    let big_endian = parts.big_endian;
    let Some(depth) = depth.checked_sub(1) else { return Ok(()) };
    let flags = number(parts.part("class")?.1, big_endian).to_le_bytes();
    let is_of_numbers = NUMBERS.contains(&flags[0]) && flags[1] & COMPLEX == 0;
    if flags[0] != STRUCTURE && !is_of_numbers {
        return Ok(());
    }
    let dimensions: Vec<u32> = parts.part("size")?.1.chunks_exact(4).map(|chunk| number(chunk, big_endian)).collect();
    let own = String::from_utf8_lossy(parts.part("name")?.1).into_owned();
    let name = if name.is_empty() { own } else { name.to_owned() };
    match dimensions[..] {
        [1, 1] if flags[0] == STRUCTURE => collect_fields(parts, &name, depth, found),
        [rows, columns] if is_of_numbers && rows > 0 && columns > 0 => {
            let (kind, bytes) = parts.part("numbers")?;
            let (rows, columns) = (rows as usize, columns as usize);
            let stated = size(kind).and_then(|size| rows.checked_mul(columns)?.checked_mul(size));
            if stated != Some(bytes.len()) {
                let there = bytes.len();
                return Err(format!("`{name}` states {rows} x {columns} numbers of type {kind}, in {there} bytes"));
            }
            split(&name, kind, bytes, (rows, columns), big_endian, found);
            Ok(())
        }
        [rows, columns] if is_of_numbers && !parts.part("numbers")?.1.is_empty() => {
            Err(format!("`{name}` states {rows} x {columns} numbers, and holds some"))
        }
        _ => Ok(()),
    }
}

fn collect_fields<'a>(
    mut parts: Parts<'a>,
    name: &str,
    depth: usize,
    found: &mut Vec<Variable<'a>>,
) -> Result<(), String> {
    let big_endian = parts.big_endian;
    let length = number(parts.part("length of field names")?.1, big_endian) as usize;
    for field in parts.part("field names")?.1.chunks_exact(length.max(1)) {
        let end = field.iter().position(|byte| *byte == 0).unwrap_or(field.len());
        let (kind, bytes) = parts.part("fields")?;
        let name = format!("{name}.{}", String::from_utf8_lossy(&field[..end]));
        // an empty matrix has no parts
        if kind == MATRIX && !bytes.is_empty() {
            collect(Parts { bytes, big_endian }, &name, depth, found)?;
        }
    }
    Ok(())
}

/// Splits a matrix into columns. A row or column vector is one column. Samples run along the longer side.
fn split<'a>(
    name: &str,
    kind: u32,
    bytes: &'a [u8],
    (rows, columns): (usize, usize),
    big_endian: bool,
    found: &mut Vec<Variable<'a>>,
) {
    let (count, longer) = (rows.min(columns), rows.max(columns));
    if count > MAX_COLUMNS {
        return;
    }
    let upright = rows >= columns;
    found.extend((0..count).map(|at| {
        let (first, step) = if upright { (at * rows, 1) } else { (at, rows) };
        let name = if count == 1 { name.to_owned() } else { format!("{name}.{at}") };
        Variable { name, kind, bytes, first, step, rows: longer, big_endian }
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

impl Variable<'_> {
    fn cells(&self) -> impl Iterator<Item = BinaryNumber> {
        let size = size(self.kind).unwrap_or(1);
        let coding = match self.kind {
            SINGLE | DOUBLE => Coding::Float,
            INT8 | 3 | 5 | INT64 => Coding::Signed,
            _ => Coding::Unsigned,
        };
        (0..self.rows).map(move |row| {
            let bytes = &self.bytes[(self.first + row * self.step) * size..][..size];
            BinaryNumber::decode(coding, bytes, self.big_endian)
        })
    }

    /// The name and the value of a single number.
    fn number(&self) -> Option<(String, f64)> {
        Some((self.name.clone(), self.cells().next()?.as_f64()))
    }

    fn values(&self, path: &Path, room: MemoryBudget, sharing: usize) -> Result<RawColumn, InputError> {
        let mut values = SeriesBuilder::sharing(room, sharing);
        values.check_room(self.rows as u64).map_err(|why| InputError::over_budget(path, why))?;
        for (row, cell) in self.cells().enumerate() {
            if !cell.add_to(&mut values) {
                return Err(self.wrong(path, row, "it is infinite, which cannot be averaged"));
            }
        }
        Ok(RawColumn::new(self.name.clone(), values))
    }

    fn times(&self, path: &Path) -> Result<Times, InputError> {
        let mut times = Times::new();
        for (row, cell) in self.cells().enumerate() {
            cell.add_to_times(&mut times).map_err(|what| self.wrong(path, row, &what))?;
        }
        Ok(times)
    }

    fn wrong(&self, path: &Path, row: usize, what: &str) -> InputError {
        InputError::damaged(path, format!("column {}, row {row}", self.name), what)
    }
}
