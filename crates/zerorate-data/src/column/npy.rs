//! Columns of a NumPy array: one dimension, a column of two, or a field of a structured array.

use super::choice::{Choice, Columns};
use super::clock::Times;
use super::open::Log;
use super::series::SeriesBuilder;
use super::unit::TimeUnit;
use super::{Asked, Clock, Found, FoundColumn, Result, wrong};
use crate::Input;
use crate::capture::CaptureError;
use crate::survive::survive;
use npyz::{DType, Endianness, NpyHeader, Order, TimeUnits, TypeChar, TypeStr};
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

/// Bytes that a read asks the system for.
const BUFFER: usize = 1 << 18;

/// Reads columns.
pub fn read(log: Log<'_>, asked: &Asked<'_>) -> Result<Found> {
    let path = log.path;
    let mut file = BufReader::with_capacity(BUFFER, log.input);
    let failed = |error| CaptureError::io("read", path, error);
    let header = header(&mut file).map_err(|what| CaptureError::damaged(path, "as an NPY file", what))?;
    let start = file.stream_position().map_err(failed)?;
    let fields = fields(path, &header)?;
    let rows = header.shape().first().copied().unwrap_or_default();
    check_length(path, &header, file.get_ref().length().map_err(failed)?.saturating_sub(start))?;
    let numeric = fields.iter().map(|field| field.kind.is_some_and(|kind| kind != Kind::Time)).collect();
    let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
    let Choice { values: chosen, time } =
        Columns { path, names, numeric, settings: asked.args.names }.choose(asked.wanted, asked.args, &[])?;
    let mut values: Vec<_> = chosen.iter().map(|_| SeriesBuilder::sharing(log.room, chosen.len())).collect();
    values.iter().try_for_each(|values| values.check_room(rows)).map_err(|why| CaptureError::no_room(path, why))?;
    let mut times = Times::new();
    times.unit = time.and_then(|time| fields[time].time_unit);
    let wanted: Vec<&Field> = chosen.iter().chain(&time).map(|index| &fields[*index]).collect();
    each(path, &mut file, start, rows, &wanted, |column, cell| match values.get_mut(column) {
        Some(values) => push_value(values, cell),
        None => push_time(&mut times, cell, wanted[column]),
    })?;
    let clock = time.map_or(Clock::Silent, |time| Clock::Column(fields[time].name.clone(), times));
    let columns =
        chosen.iter().zip(values).map(|(index, values)| FoundColumn::new(fields[*index].name.clone(), values));
    Ok(Found { columns: columns.collect(), clock, warning: None })
}

fn push_value(values: &mut SeriesBuilder, cell: Cell) -> Result<(), String> {
    match cell {
        Cell::Integer(integer) => values.push_integer(integer),
        Cell::Number(number) if values.push_number(number) => {}
        Cell::Number(_) => return Err("it is infinite, which cannot be averaged".to_owned()),
    }
    Ok(())
}

fn push_time(times: &mut Times, cell: Cell, field: &Field) -> Result<(), String> {
    match cell {
        Cell::Integer(i64::MIN) if field.kind == Some(Kind::Time) => {
            Err("no time; every row must have one".to_owned())
        }
        Cell::Integer(time) => {
            times.push_integer(time);
            Ok(())
        }
        Cell::Number(time) => times.push_number(time),
    }
}

/// Reads the header, a literal of Python behind its length. The library takes the length for granted and parses nested
/// brackets in a time that grows exponentially with their depth, so both are looked at first.
fn header(file: &mut BufReader<Input>) -> Result<NpyHeader, String> {
    let mut bytes = vec![0; START];
    file.read_exact(&mut bytes).map_err(|error| error.to_string())?;
    let wide = bytes[6] > 1;
    let mut length = [0; 4];
    file.read_exact(&mut length[..if wide { 4 } else { 2 }]).map_err(|error| error.to_string())?;
    bytes.extend(&length[..if wide { 4 } else { 2 }]);
    let length = u32::from_le_bytes(length);
    if length > MAX_HEADER {
        return Err(format!("its header would have {length} bytes, and more than {MAX_HEADER} are not read"));
    }
    file.take(length.into()).read_to_end(&mut bytes).map_err(|error| error.to_string())?;
    if depth(&bytes[START..]).is_none_or(|depth| depth > MAX_DEPTH) {
        return Err(format!("its header has brackets more than {MAX_DEPTH} deep, or a backslash"));
    }
    let header = survive(|| NpyHeader::from_reader(bytes.as_slice()));
    header.ok_or("its header makes no sense")?.map_err(|error| error.to_string())
}

/// The mark and the version.
const START: usize = 8;

/// Bytes of a header at most. NumPy itself reads 10 000 unless told otherwise.
const MAX_HEADER: u32 = 1 << 14;

/// Depth of its brackets at most: a dictionary, with a list of fields, each in brackets, with its shape in brackets.
const MAX_DEPTH: usize = 6;

/// How deep brackets stand in brackets; none where a backslash leaves open what is a string.
fn depth(header: &[u8]) -> Option<usize> {
    let (mut now, mut most, mut quote) = (0usize, 0, None);
    for byte in header {
        match (byte, quote) {
            (b'\\', _) => return None,
            (byte, Some(open)) => quote = Some(open).filter(|open| *open != byte),
            (b'"' | b'\'', None) => quote = Some(byte),
            (b'(' | b'[' | b'{', None) => now += 1,
            (b')' | b']' | b'}', None) => now = now.saturating_sub(1),
            _ => {}
        }
        most = most.max(now);
    }
    Some(most)
}

/// A column of an array.
struct Field {
    name: String,
    /// None if it holds no numbers of a kind that is read.
    kind: Option<Kind>,
    big_endian: bool,
    size: usize,
    /// Offset of the first number, from the start of the data, and from each to the next.
    offset: u64,
    stride: u64,
    time_unit: Option<TimeUnit>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Signed,
    Unsigned,
    Float,
    /// A signed number of units since some time.
    Time,
}

impl Field {
    fn new(name: String, dtype: &DType, offset: u64, stride: u64) -> Self {
        let DType::Plain(plain) = dtype else {
            return Self { name, kind: None, big_endian: false, size: 0, offset, stride, time_unit: None };
        };
        let size = plain.num_bytes().unwrap_or_default();
        let big_endian = plain.endianness() == Endianness::Big;
        Self { name, kind: kind(plain, size), big_endian, size, offset, stride, time_unit: time_unit(plain) }
    }

    /// The number in these bytes.
    fn decode(&self, bytes: &[u8]) -> Cell {
        // little endian, extended to eight bytes
        let mut wide = [0; 8];
        wide[..self.size].copy_from_slice(bytes);
        if self.big_endian {
            wide[..self.size].reverse();
        }
        let bits = u64::from_le_bytes(wide);
        let unused = 64 - 8 * self.size as u32;
        match self.kind {
            Some(Kind::Float) if self.size == 4 => Cell::Number(f32::from_bits(bits as u32).into()),
            Some(Kind::Float) => Cell::Number(f64::from_bits(bits)),
            Some(Kind::Unsigned) => i64::try_from(bits).map_or(Cell::Number(bits as f64), Cell::Integer),
            _ => Cell::Integer((bits << unused) as i64 >> unused),
        }
    }
}

fn kind(plain: &TypeStr, size: usize) -> Option<Kind> {
    match (plain.type_char(), size) {
        (TypeChar::Int, 1 | 2 | 4 | 8) => Some(Kind::Signed),
        (TypeChar::Uint, 1 | 2 | 4 | 8) => Some(Kind::Unsigned),
        (TypeChar::Float, 4 | 8) => Some(Kind::Float),
        (TypeChar::DateTime | TypeChar::TimeDelta, 8) => Some(Kind::Time),
        _ => None,
    }
}

fn time_unit(plain: &TypeStr) -> Option<TimeUnit> {
    match plain.time_units()? {
        TimeUnits::Second => Some(TimeUnit::S),
        TimeUnits::Millisecond => Some(TimeUnit::Ms),
        TimeUnits::Microsecond => Some(TimeUnit::Us),
        TimeUnits::Nanosecond => Some(TimeUnit::Ns),
        _ => None,
    }
}

/// The columns of an array.
fn fields(path: &Path, header: &NpyHeader) -> Result<Vec<Field>, CaptureError> {
    let unreadable = |what: String| CaptureError::not_a_log(path, what);
    let dtype = header.dtype();
    let size = dtype.num_bytes().filter(|size| *size > 0).map(|size| size as u64);
    let size = size.ok_or_else(|| unreadable(format!("its elements {} have no fixed size", dtype.descr())))?;
    match (&dtype, header.shape()) {
        (DType::Record(fields), [_]) => {
            let mut offset = 0;
            let mut column = |field: &npyz::Field| {
                let found = Field::new(field.name.clone(), &field.dtype, offset, size);
                offset += field.dtype.num_bytes().unwrap_or_default() as u64;
                found
            };
            Ok(fields.iter().map(&mut column).collect())
        }
        (DType::Plain(_), [_]) => Ok(vec![Field::new("0".to_owned(), &dtype, 0, size)]),
        (DType::Plain(_), [rows, columns]) if *columns <= MAX_COLUMNS => {
            let column = |number: u64| match header.order() {
                Order::C => Field::new(number.to_string(), &dtype, number * size, columns * size),
                Order::Fortran => {
                    Field::new(number.to_string(), &dtype, number.saturating_mul(*rows).saturating_mul(size), size)
                }
            };
            Ok((0..*columns).map(column).collect())
        }
        (_, shape) => {
            let remedy = "save a column of it with numpy.save";
            Err(unreadable(format!("its shape {shape:?} is neither one column nor at most {MAX_COLUMNS}; {remedy}")))
        }
    }
}

/// Columns of an array of two dimensions at most: with more it is rather an image, or the array lies on its side.
const MAX_COLUMNS: u64 = 4096;

fn check_length(path: &Path, header: &NpyHeader, there: u64) -> Result<(), CaptureError> {
    let size = header.dtype().num_bytes().unwrap_or_default() as u64;
    let expected = header.shape().iter().try_fold(size, |product, n| product.checked_mul(*n));
    if expected.is_some_and(|expected| expected <= there) {
        return Ok(());
    }
    let expected = expected.map_or("more".to_owned(), |expected| expected.to_string());
    let what = format!("its header states {expected} bytes of data and {there} follow; was it cut short?");
    Err(CaptureError::damaged(path, "as an NPY file", what))
}

enum Cell {
    Integer(i64),
    Number(f64),
}

/// Calls `take` with every number of these columns: row by row in one pass, where a row stands in one place.
fn each(
    path: &Path,
    file: &mut BufReader<Input>,
    start: u64,
    rows: u64,
    fields: &[&Field],
    mut take: impl FnMut(usize, Cell) -> Result<(), String>,
) -> Result<(), CaptureError> {
    let mut array = Array { path, file, start, rows };
    if span(fields) <= fields.first().map_or(0, |field| field.stride) {
        return array.each_row(fields, take);
    }
    // one column behind the other
    let mut columns = fields.iter().enumerate();
    columns.try_for_each(|(column, field)| array.each_row(&[*field], |_, cell| take(column, cell)))
}

/// Bytes from the start of the first of these columns to the end of the last, in a row.
fn span(fields: &[&Field]) -> u64 {
    let end = fields.iter().map(|field| field.offset.saturating_add(field.size as u64)).max().unwrap_or_default();
    end - fields.iter().map(|field| field.offset).min().unwrap_or_default()
}

/// The data of a file.
struct Array<'a> {
    path: &'a Path,
    file: &'a mut BufReader<Input>,
    start: u64,
    rows: u64,
}

impl Array<'_> {
    fn each_row(
        &mut self,
        fields: &[&Field],
        mut take: impl FnMut(usize, Cell) -> Result<(), String>,
    ) -> Result<(), CaptureError> {
        let Self { path, file, start, rows } = self;
        let failed = |error| CaptureError::io("read", path, error);
        let first = fields.iter().map(|field| field.offset).min().unwrap_or_default();
        let stride = fields.first().map_or(0, |field| field.stride);
        file.seek(SeekFrom::Start(*start + first)).map_err(failed)?;
        let mut bytes = vec![0; span(fields) as usize];
        let skipped = (stride - bytes.len() as u64) as i64;
        for row in 0..*rows {
            file.read_exact(&mut bytes).map_err(failed)?;
            for (column, field) in fields.iter().enumerate() {
                let cell = field.decode(&bytes[(field.offset - first) as usize..][..field.size]);
                take(column, cell)
                    .map_err(|what| wrong(path, format_args!("column {}, row {row}", field.name), what))?;
            }
            if skipped > 0 && row + 1 < *rows {
                file.seek_relative(skipped).map_err(failed)?;
            }
        }
        Ok(())
    }
}
