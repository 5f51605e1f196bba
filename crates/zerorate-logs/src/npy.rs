//! Reads columns of NumPy arrays. A column is an array of one dimension, a column of a two-dimensional array, or a
//! field of a structured array. The columns come from one array, or from several arrays of an archive.

mod header;

use super::binary::{BinaryNumber, Coding};
use super::clock::Times;
use super::open::{BUFFER, Log};
use super::series::SeriesBuilder;
use crate::choice::{Choice, Columns};
use crate::error::Result;
use crate::query::ColumnQuery;
use crate::raw_columns::{RawColumn, RawColumns};
use crate::stated_rate::{StatedRate, is_rate};
use crate::warning::LogWarning;
use header::{Element, Form, Header, Kind};
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{Input, InputError, InputWarning, TimeUnit};

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, mut input, room, .. } = log;
    let length = input.length().map_err(|error| InputError::io("read", path, error))?;
    let array = Array::new(path, &mut input, length, "")?;
    let behind = InputWarning::behind_end(path, &input, array.end)?;
    let mut input = Some(input);
    let mut found = read_arrays(path, room, &[array], asked, |_, is_wanted| Ok(input.take().filter(|_| is_wanted)))?;
    found.warnings.extend(behind.map(LogWarning::File));
    Ok(found)
}

/// The layout of an array, as its header states it.
pub struct Array {
    fields: Vec<Field>,
    rows: u64,
    /// Offset of the data in the file, and offset behind the data.
    start: u64,
    end: u64,
    /// True if the array is a single number whose name is that of a sample rate.
    is_rate: bool,
}

impl Array {
    /// Reads the header of an array in a file of `length` bytes. `name` is its name in an archive, or empty.
    pub fn new(path: &Path, file: &mut impl Read, length: u64, name: &str) -> Result<Self, InputError> {
        let place = if name.is_empty() { "as an NPY file".to_owned() } else { format!("array {name}") };
        let (header, start) = header(file).map_err(|what| InputError::damaged(path, place, what))?;
        let end = start + check_length(path, &header, length.saturating_sub(start))?;
        let is_rate = is_rate(name) && header.shape.iter().all(|length| *length == 1);
        let header = if is_rate { Header { shape: vec![1], ..header } } else { header.upright() };
        let rows = header.shape.first().copied().unwrap_or_default();
        let fields = match (header.shape.as_slice(), name) {
            ([], name) if !name.is_empty() => Vec::new(),
            (_, "") => fields(path, &header)?,
            // in an archive, an array of an unsupported type has no columns
            (shape, name) => {
                fields(path, &header).unwrap_or_default().into_iter().map(|field| field.of(name, shape)).collect()
            }
        };
        Ok(Self { fields, rows, start, end, is_rate })
    }

    /// The name and the value of an array that is a single number.
    fn rate(&self, path: &Path, file: &mut BufReader<Input>) -> Result<Option<(String, f64)>, InputError> {
        let Some(field) = self.fields.first().filter(|field| field.kind.is_some()) else { return Ok(None) };
        let mut rate = None;
        each(path, file, self.start, 1, &[field], |_, cells| {
            rate = cells.iter().next().map(|cell| (field.name.clone(), field.decode(cell).as_f64()));
            Ok(())
        })?;
        Ok(rate)
    }

    #[cfg(feature = "npz")]
    pub fn columns(&self) -> usize {
        self.fields.len()
    }
}

/// Reads columns of arrays. `open` receives the index of an array and whether its data are wanted, and returns the
/// file with the array. `open` is called once for each array.
pub fn read_arrays(
    path: &Path,
    room: MemoryBudget,
    arrays: &[Array],
    asked: &ColumnQuery<'_>,
    mut open: impl FnMut(usize, bool) -> Result<Option<Input>, InputError>,
) -> Result<RawColumns> {
    let of_array = |(at, array): (usize, &Array)| (0..array.fields.len()).map(move |field| (at, field));
    let of_log = arrays.iter().enumerate().filter(|(_, array)| !array.is_rate);
    let places: Vec<(usize, usize)> = of_log.flat_map(of_array).collect();
    let field = |at: &usize| &arrays[places[*at].0].fields[places[*at].1];
    let fields: Vec<&Field> = (0..places.len()).map(|at| field(&at)).collect();
    let numeric = fields.iter().map(|field| field.kind.is_some_and(|kind| kind != Kind::Time)).collect();
    let names: Vec<&str> = fields.iter().map(|field| field.name.as_str()).collect();
    let columns = Columns { path, names, numeric, clocks: Vec::new(), settings: asked.args.names };
    let (Choice { values: chosen, time, .. }, rows) =
        columns.choose_alike(asked.wanted, asked.args, |at| arrays[places[at].0].rows)?;
    let left_out = columns.left_out(asked.wanted, time);
    let wanted: Vec<usize> = chosen.iter().chain(&time).copied().collect();
    let names: Vec<String> = wanted.iter().map(|at| field(at).name.clone()).collect();
    let mut values: Vec<_> = chosen.iter().map(|_| SeriesBuilder::sharing(room, chosen.len())).collect();
    values.iter().try_for_each(|values| values.check_room(rows)).map_err(|why| InputError::over_budget(path, why))?;
    for (values, at) in values.iter_mut().zip(&chosen) {
        values.reserve(rows as usize, field(at).kind != Some(Kind::Float));
    }
    let mut times = Times::new();
    times.unit = time.and_then(|time| field(&time).time_unit);
    let mut of_arrays = vec![Vec::new(); arrays.len()];
    wanted.iter().enumerate().for_each(|(column, at)| of_arrays[places[*at].0].push(column));
    let mut rates = Vec::new();
    for (at, (array, here)) in arrays.iter().zip(of_arrays).enumerate() {
        let Some(file) = open(at, array.is_rate || !here.is_empty())? else { continue };
        let mut file = BufReader::with_capacity(BUFFER, file);
        if array.is_rate {
            rates.extend(array.rate(path, &mut file)?);
            continue;
        }
        let Array { fields, rows, start, .. } = array;
        let of_here: Vec<&Field> = here.iter().map(|column| &fields[places[wanted[*column]].1]).collect();
        each(path, &mut file, *start, *rows, &of_here, |column, cells| match values.get_mut(here[column]) {
            Some(values) => push_values(values, cells, of_here[column]),
            None => push_times(&mut times, cells, of_here[column]),
        })?;
    }
    let time = time.map(|_| (names[chosen.len()].clone(), times));
    let columns = names.into_iter().zip(values).map(|(name, values)| RawColumn::new(name, values));
    Ok(RawColumns { stated_rate: StatedRate::among(rates), ..RawColumns::new(columns, time, left_out) })
}

/// An error: the row within the block, and the text.
type Wrong = (usize, String);

fn push_values(values: &mut SeriesBuilder, cells: &Cells<'_>, field: &Field) -> Result<(), Wrong> {
    let infinite = |row| (row, "it is infinite, which cannot be averaged".to_owned());
    if field.is_plain() {
        let added = match cells.packed() {
            Some(packed) => values.extend_numbers(packed.iter().map(|cell| f64::from_le_bytes(*cell))),
            None => values.extend_numbers(cells.plain().into_iter()),
        };
        return added.map_err(infinite);
    }
    for (row, cell) in cells.iter().enumerate() {
        if !field.decode(cell).add_to(values) {
            return Err(infinite(row));
        }
    }
    Ok(())
}

fn push_times(times: &mut Times, cells: &Cells<'_>, field: &Field) -> Result<(), Wrong> {
    for (row, cell) in cells.iter().enumerate() {
        let time = field.decode(cell);
        if time == BinaryNumber::Integer(i64::MIN) && field.kind == Some(Kind::Time) {
            return Err((row, "no time; every row must have one".to_owned()));
        }
        time.add_to_times(times).map_err(|what| (row, what))?;
    }
    Ok(())
}

/// Reads the start of a file up to its data. Returns the header and the offset of the data.
fn header(file: &mut impl Read) -> Result<(Header, u64), String> {
    let mut bytes = [0; START];
    file.read_exact(&mut bytes).map_err(|error| error.to_string())?;
    let mut length = [0; 4];
    let of_length = if bytes[6] > 1 { 4 } else { 2 };
    file.read_exact(&mut length[..of_length]).map_err(|error| error.to_string())?;
    let length = u32::from_le_bytes(length);
    if length > MAX_HEADER {
        return Err(format!("its header would have {length} bytes, and more than {MAX_HEADER} are not read"));
    }
    let mut text = Vec::new();
    file.take(length.into()).read_to_end(&mut text).map_err(|error| error.to_string())?;
    if depth(&text).is_none_or(|depth| depth > MAX_DEPTH) {
        return Err(format!("its header has brackets more than {MAX_DEPTH} deep, or a backslash"));
    }
    let header = Header::parse(&text).ok_or("its header is not one that NumPy writes, or is cut short")?;
    Ok((header, (START + of_length + text.len()) as u64))
}

/// Size of the magic number and the version in bytes.
const START: usize = 8;

/// Largest size of a header in bytes. NumPy itself reads 10 000 unless told otherwise.
const MAX_HEADER: u32 = 1 << 14;

/// Largest depth of brackets. A usual header has at most 4: the dictionary, the list of fields, a field, its shape.
const MAX_DEPTH: usize = 6;

/// The depth of nested brackets; `None` if there is a backslash, which leaves open where a string ends.
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

struct Field {
    name: String,
    /// The type of the numbers; `None` if the type is not supported.
    kind: Option<Kind>,
    big_endian: bool,
    size: usize,
    /// Offset of the first number from the start of the data, and distance between numbers, in bytes.
    offset: u64,
    stride: u64,
    time_unit: Option<TimeUnit>,
}

impl Field {
    fn new(name: String, element: &Element, offset: u64, stride: u64) -> Self {
        let Form::Value { kind, big_endian, time_unit } = element.form else {
            return Self { name, kind: None, big_endian: false, size: 0, offset, stride, time_unit: None };
        };
        let size = element.size.and_then(|size| usize::try_from(size).ok()).unwrap_or_default();
        Self { name, kind, big_endian, size, offset, stride, time_unit }
    }

    /// Names a column of a named array: `gyro`, in two dimensions `gyro.0`, and for a field `gyro.x`.
    fn of(self, array: &str, shape: &[u64]) -> Self {
        let name = match (shape, self.name.parse::<u64>()) {
            ([_], Ok(0)) => array.to_owned(),
            _ => format!("{array}.{}", self.name),
        };
        Self { name, ..self }
    }

    /// True if the column holds f64 in the byte order of nearly all machines.
    fn is_plain(&self) -> bool {
        self.kind == Some(Kind::Float) && self.size == 8 && !self.big_endian
    }

    fn decode(&self, bytes: &[u8]) -> BinaryNumber {
        let coding = match self.kind {
            Some(Kind::Float) => Coding::Float,
            Some(Kind::Unsigned) => Coding::Unsigned,
            _ => Coding::Signed,
        };
        BinaryNumber::decode(coding, bytes, self.big_endian)
    }
}

fn fields(path: &Path, header: &Header) -> Result<Vec<Field>, InputError> {
    let unreadable = |what: String| InputError::not_a_log(path, what);
    let Header { element, is_fortran, shape } = header;
    let size = element.size.filter(|size| *size > 0);
    let size = size.ok_or_else(|| unreadable("its elements have no fixed size".to_owned()))?;
    match (&element.form, shape.as_slice()) {
        (Form::Fields(fields), [_]) => {
            let mut offset = 0;
            let mut column = |(name, field): &(String, Element)| {
                let found = Field::new(name.clone(), field, offset, size);
                offset += field.size.unwrap_or_default();
                found
            };
            Ok(fields.iter().map(&mut column).collect())
        }
        (Form::Value { .. }, [_]) => Ok(vec![Field::new("0".to_owned(), element, 0, size)]),
        (Form::Value { .. }, [rows, columns]) if *columns <= MAX_COLUMNS => {
            let column = |number: u64| {
                let (offset, stride) = match is_fortran {
                    true => (number.saturating_mul(*rows).saturating_mul(size), size),
                    false => (number.saturating_mul(size), columns.saturating_mul(size)),
                };
                Field::new(number.to_string(), element, offset, stride)
            };
            Ok((0..*columns).map(column).collect())
        }
        (_, shape) => {
            let remedy = "save a column of it with numpy.save";
            Err(unreadable(format!("its shape {shape:?} is neither one column nor at most {MAX_COLUMNS}; {remedy}")))
        }
    }
}

/// Largest number of columns of a two-dimensional array. One with more is probably an image.
const MAX_COLUMNS: u64 = 4096;

/// In an array with more columns than this, and more columns than rows, each column is a sample.
const FEW_COLUMNS: u64 = 64;

impl Header {
    /// The same array, with a sample in each row.
    fn upright(self) -> Self {
        match self.shape[..] {
            [rows, columns] if columns > FEW_COLUMNS.max(rows) => {
                Self { is_fortran: !self.is_fortran, shape: vec![columns, rows], ..self }
            }
            _ => self,
        }
    }
}

/// The size of the data in bytes. Returns an error if the file has fewer bytes.
fn check_length(path: &Path, header: &Header, there: u64) -> Result<u64, InputError> {
    let size = header.element.size.unwrap_or_default();
    let expected = header.shape.iter().try_fold(size, |product, n| product.checked_mul(*n));
    if let Some(expected) = expected.filter(|expected| *expected <= there) {
        return Ok(expected);
    }
    let expected = expected.map_or("more".to_owned(), |expected| expected.to_string());
    let what = format!("its header states {expected} bytes of data and {there} follow; was it cut short?");
    Err(InputError::damaged(path, "as an NPY file", what))
}

/// The cells of a column in consecutive rows.
struct Cells<'a> {
    /// The bytes from the first cell on.
    bytes: &'a [u8],
    stride: usize,
    size: usize,
}

impl Cells<'_> {
    fn iter(&self) -> impl Iterator<Item = &[u8]> {
        self.bytes.chunks(self.stride).map(|row| &row[..self.size])
    }

    /// The cells, if they have eight bytes with nothing between them.
    fn packed(&self) -> Option<&[[u8; 8]]> {
        let (packed, rest) = self.bytes.as_chunks();
        (self.stride == size_of::<f64>() && rest.is_empty()).then_some(packed)
    }

    /// The numbers of [plain](Field::is_plain) cells.
    fn plain(&self) -> Vec<f64> {
        self.iter().filter_map(<[u8]>::first_chunk).map(|cell| f64::from_le_bytes(*cell)).collect()
    }
}

/// Calls `take` with the index of a column and a block of its cells. Reads all columns in one pass, unless the cells
/// of a row are far apart.
fn each(
    path: &Path,
    file: &mut BufReader<Input>,
    start: u64,
    rows: u64,
    fields: &[&Field],
    mut take: impl FnMut(usize, &Cells<'_>) -> Result<(), Wrong>,
) -> Result<(), InputError> {
    if fields.is_empty() {
        return Ok(());
    }
    let mut array = Data { path, file, start, rows };
    if span(fields) <= fields.first().map_or(0, |field| field.stride) {
        return array.each_block(fields, take);
    }
    // the cells of a row are far apart, so read one column after the other
    let mut columns = fields.iter().enumerate();
    columns.try_for_each(|(column, field)| array.each_block(&[*field], |_, cells| take(column, cells)))
}

/// Bytes of a row from the start of the first of these columns to the end of the last.
fn span(fields: &[&Field]) -> u64 {
    let end = fields.iter().map(|field| field.offset.saturating_add(field.size as u64)).max().unwrap_or_default();
    end - fields.iter().map(|field| field.offset).min().unwrap_or_default()
}

struct Data<'a> {
    path: &'a Path,
    file: &'a mut BufReader<Input>,
    start: u64,
    rows: u64,
}

impl Data<'_> {
    fn each_block(
        &mut self,
        fields: &[&Field],
        mut take: impl FnMut(usize, &Cells<'_>) -> Result<(), Wrong>,
    ) -> Result<(), InputError> {
        let Self { path, file, start, rows } = self;
        let failed = |error| InputError::io("read", path, error);
        let first = fields.iter().map(|field| field.offset).min().unwrap_or_default();
        let stride = fields.first().map_or(0, |field| field.stride);
        file.seek(SeekFrom::Start(*start + first)).map_err(failed)?;
        let span = span(fields) as usize;
        let at_once = (BUFFER as u64 / stride.max(1)).max(1);
        let mut bytes = Vec::new();
        for from in (0..*rows).step_by(at_once as usize) {
            let some = at_once.min(*rows - from);
            bytes.resize((some - 1) as usize * stride as usize + span, 0);
            file.read_exact(&mut bytes).map_err(failed)?;
            for (column, field) in fields.iter().enumerate() {
                let offset = (field.offset - first) as usize;
                let cells = Cells { bytes: &bytes[offset..], stride: stride as usize, size: field.size };
                take(column, &cells).map_err(|(row, what)| {
                    InputError::damaged(path, format!("column {}, row {}", field.name, from + row as u64), what)
                })?;
            }
            if from + some < *rows {
                file.seek_relative((stride - span as u64) as i64).map_err(failed)?;
            }
        }
        Ok(())
    }
}
