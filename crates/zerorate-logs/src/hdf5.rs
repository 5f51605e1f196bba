//! Reads HDF5, which MATLAB writes as `-v7.3`.
//!
//! A data set of numbers is named by its path: `imu/gyro`, or in MATLAB `imu.gyro`. A field of a compound data set, as
//! PyTables writes tables, is named `table.gz`. Other data sets are ignored.

use super::binary::{BinaryNumber, Coding};
use super::clock::Times;
use super::open::Log;
use super::series::SeriesBuilder;
use super::{hdf5_index, lzf};
use crate::choice::{Choice, Columns};
use crate::error::{Result, object_of_matlab};
use crate::query::ColumnQuery;
use crate::raw_columns::{RawColumn, RawColumns};
use crate::stated_rate::{StatedRate, is_rate};
use crate::warning::LogWarning;
use hdf5_reader::attribute_api::Attribute;
use hdf5_reader::datatype_api::CompoundField;
use hdf5_reader::error::{ByteOrder, Error};
use hdf5_reader::filters::FilterRegistry;
use hdf5_reader::group::Group;
use hdf5_reader::storage::{Storage, StorageBuffer};
use hdf5_reader::{Dataset, Datatype, H5Type, Hdf5File, OpenOptions, SliceInfo, SliceInfoElem};
use std::path::Path;
use std::sync::Arc;
use zerorate_input::catch_panic::catch_panic;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{Input, InputError, InputWarning, TimeUnit, Unit};

/// The identifier of LZF, a compression of h5py, in the HDF Group's list of filters.
const LZF: u16 = 32000;

/// Largest number of columns of a data set; one with more is probably an image.
const MAX_COLUMNS: u64 = 4096;

const MAX_DEPTH: usize = 8;

const MAX_SETS: usize = 10_000;

const ROWS: usize = 1 << 16;

/// Largest total size of the unpacked chunks that are kept, bytes. The other columns in these chunks use them.
const CACHE: usize = 64 << 20;

/// Largest size of an object header, which holds attributes, in bytes.
const MAX_HEADER: usize = 1 << 22;

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, input, room, .. } = log;
    let behind = end(&input).map(|end| InputWarning::behind_end(path, &input, end)).transpose()?.flatten();
    let Content { sets, rates, objects } = content(path, input, room)?;
    if let (true, Some((name, class))) = (sets.is_empty(), objects.first()) {
        return Err(object_of_matlab(path, name, class));
    }
    let columns: Vec<SetColumn<'_>> = sets.iter().flat_map(Set::columns).collect();
    let names = columns.iter().map(|column| column.name.as_str()).collect();
    let all =
        Columns { path, names, numeric: vec![true; columns.len()], clocks: Vec::new(), settings: asked.args.names };
    let (Choice { values: chosen, time, .. }, rows) =
        all.choose_alike(asked.wanted, asked.args, |at| columns[at].rows)?;
    let wanted: Vec<&SetColumn<'_>> = chosen.iter().chain(&time).map(|at| &columns[*at]).collect();
    let mut values: Vec<_> = chosen.iter().map(|_| SeriesBuilder::sharing(room, chosen.len())).collect();
    values.iter().try_for_each(|values| values.check_room(rows)).map_err(|why| InputError::over_budget(path, why))?;
    let mut times = Times::new();
    for start in (0..rows).step_by(ROWS) {
        for (at, column) in wanted.iter().enumerate() {
            let wrong = |what: String| InputError::damaged(path, format!("data set {}", column.name), what);
            let read = catch_panic(|| column.read(start, rows.min(start + ROWS as u64)));
            let mut cells = (start..).zip(read.ok_or_else(|| senseless(path))?.map_err(|error| wrong(said(&error)))?);
            let taken = match values.get_mut(at) {
                Some(values) => cells.try_for_each(|(row, cell)| push(values, row, cell)),
                None => cells.try_for_each(|(row, cell)| push_time(&mut times, row, cell)),
            };
            taken.map_err(wrong)?;
        }
    }
    let time_unit = time.and_then(|time| columns[time].unit_text());
    times.unit = time_unit.and_then(|unit| TimeUnit::of_column(&format!("time [{unit}]")));
    let time = time.map(|time| (columns[time].name.clone(), times));
    let name = |(column, values): (&&SetColumn<'_>, SeriesBuilder)| RawColumn::new(column.with_unit(), values);
    let found = RawColumns::new(wanted.iter().zip(values).map(name), time, behind.map(LogWarning::File));
    Ok(RawColumns { stated_rate: StatedRate::among(rates), ..found })
}

/// Finds the data sets, rates and objects of a file. Data sets are sorted by name: a file lists them in any order.
fn content(path: &Path, input: Input, room: MemoryBudget) -> Result<Content, InputError> {
    let most = usize::try_from(room.bytes()).unwrap_or(usize::MAX) / 4;
    let options = OpenOptions::default()
        .with_max_chunk_bytes(most)
        .with_chunk_cache_bytes(most.min(CACHE))
        .with_max_read_bytes(most)
        .with_max_object_header_bytes(MAX_HEADER)
        .with_filter_registry(filters(most));
    let length = input.length().map_err(|error| InputError::io("read", path, error))?;
    let cut = if starts_as_matlab(&input) { '.' } else { '/' };
    let found = catch_panic(|| {
        let file = Hdf5File::from_storage_with_options(Arc::new(Bytes { input, length }), options)?;
        let mut found = Content::default();
        collect(&file.root_group()?, "", cut, MAX_DEPTH, &mut found)?;
        found.sets.sort_by(|one: &Set, other| one.name.cmp(&other.name));
        Ok::<_, Error>(found)
    });
    let damaged = |error: Error| InputError::damaged(path, "as an HDF5 file", said(&error));
    found.ok_or_else(|| senseless(path))?.map_err(damaged)
}

/// The filters of the library, and LZF.
fn filters(most: usize) -> FilterRegistry {
    let mut filters = FilterRegistry::new();
    let unpack = move |_: &_, packed: &[u8], _| {
        lzf::unpacked(packed, most).ok_or_else(|| Error::DecompressionError("LZF: it makes no sense".to_owned()))
    };
    filters.register(LZF, Box::new(unpack));
    filters
}

/// The text of an error. For an unknown compression it says what to do.
fn said(error: &Error) -> String {
    match error {
        Error::UnsupportedFilter(_) => {
            format!("{error}, which is not read; `h5repack -f GZIP=6 FILE NEW.h5` packs it in a way that is")
        }
        error => error.to_string(),
    }
}

fn senseless(path: &Path) -> InputError {
    InputError::damaged(path, "as an HDF5 file", "its content makes no sense")
}

fn push(values: &mut SeriesBuilder, row: u64, cell: BinaryNumber) -> Result<(), String> {
    cell.add_to(values).then_some(()).ok_or_else(|| format!("row {row} is infinite, which cannot be averaged"))
}

fn push_time(times: &mut Times, row: u64, cell: BinaryNumber) -> Result<(), String> {
    cell.add_to_times(times).map_err(|what| format!("row {row}: {what}"))
}

/// True if MATLAB wrote the file, with its own head before the head of HDF5.
fn starts_as_matlab(input: &Input) -> bool {
    input.bytes_at(0, 6).is_ok_and(|start| &start[..] == b"MATLAB")
}

/// Size of MATLAB's own header before the HDF5 content, in bytes.
const MATLAB_HEAD: u64 = 512;

/// The end of the file that its superblock states, counted from the start of the file. `None` if addresses do not have
/// eight bytes, or if the version of the superblock is unknown.
fn end(input: &Input) -> Option<u64> {
    let start = if starts_as_matlab(input) { MATLAB_HEAD } else { 0 };
    let block = input.bytes_at(start, 52).ok()?;
    let (size, end) = match block[8] {
        0 => (13, 40),
        1 => (13, 44),
        2 | 3 => (9, 28),
        _ => return None,
    };
    let end = block[end..].first_chunk().filter(|_| block[size] == 8)?;
    Some(u64::from_le_bytes(*end))
}

struct Bytes {
    input: Input,
    length: u64,
}

impl Storage for Bytes {
    fn len(&self) -> u64 {
        self.length
    }

    fn read_range(&self, offset: u64, len: usize) -> Result<StorageBuffer, Error> {
        let bytes = self.bytes(offset, len)?;
        hdf5_index::check(&bytes, |offset, len| self.bytes(offset, len))?;
        Ok(StorageBuffer::from_vec(bytes))
    }
}

impl Bytes {
    fn bytes(&self, offset: u64, len: usize) -> Result<Vec<u8>, Error> {
        // do not allocate memory for bytes that the file does not have
        if offset.checked_add(len as u64).is_none_or(|end| end > self.length) {
            return Err(Error::InvalidData(format!("{len} bytes at {offset} are not there: it was cut short")));
        }
        let bytes = self.input.bytes_at(offset, len).map_err(|error| Error::InvalidData(error.to_string()))?;
        Ok(bytes.into())
    }
}

struct Set {
    name: String,
    set: Dataset,
}

#[derive(Default)]
struct Content {
    sets: Vec<Set>,
    /// The sample rates in Hz that the file states, with their names.
    rates: Vec<(String, f64)>,
    /// Names and classes of MATLAB's objects, which are not numbers.
    objects: Vec<(String, String)>,
}

fn collect(group: &Group, name: &str, cut: char, depth: usize, found: &mut Content) -> Result<(), Error> {
    let Some(depth) = depth.checked_sub(1) else { return Ok(()) };
    let (groups, members) = group.members()?;
    let below = |own: &str| if name.is_empty() { own.to_owned() } else { format!("{name}{cut}{own}") };
    found.rates.extend(stated_rates(group.attributes().unwrap_or_default(), name));
    for set in members {
        let own = set.name().rsplit('/').next().unwrap_or_default().to_owned();
        if set.attribute("MATLAB_object_decode").is_ok() {
            found.objects.extend(matlab_class(&set).map(|class| (below(&own), class)));
            continue;
        }
        let has_numbers = size(set.dtype()).is_some() || matches!(set.dtype(), Datatype::Compound { .. });
        if found.sets.len() < MAX_SETS && has_numbers && is_of_numbers(&set) {
            let set = Set { name: below(&own), set };
            found.rates.extend(set.rates());
            found.sets.push(set);
        }
    }
    for group in groups {
        let own = group.name().rsplit('/').next().unwrap_or_default().to_owned();
        // a group such as `#refs#` holds MATLAB's internal data
        if !own.starts_with('#') {
            collect(&group, &below(&own), cut, depth, found)?;
        }
    }
    Ok(())
}

fn matlab_class(set: &Dataset) -> Option<String> {
    let class = set.attribute("MATLAB_class").and_then(|class| class.read_string()).ok()?;
    Some(class.trim_end_matches('\0').to_owned())
}

/// True if a data set holds numbers. MATLAB writes texts and the sizes of empty arrays as numbers, and marks them by
/// an attribute.
fn is_of_numbers(set: &Dataset) -> bool {
    matlab_class(set).is_none_or(|class| class != "char") && set.attribute("MATLAB_empty").is_err()
}

struct SetColumn<'a> {
    name: String,
    set: &'a Dataset,
    rows: u64,
    /// In a two-dimensional data set, the index of the column, and whether the first dimension counts the log's rows.
    at: Option<(u64, bool)>,
    /// The field, if the data set is a compound.
    field: Option<&'a CompoundField>,
}

impl Set {
    /// The columns of a data set. A row vector and a column vector are one column each. A matrix has samples along its
    /// longer side.
    fn columns(&self) -> Vec<SetColumn<'_>> {
        let Self { name, set } = self;
        let of = |name: String, rows: u64, at: Option<(u64, bool)>| SetColumn { name, set, rows, at, field: None };
        match *set.shape() {
            [rows] if rows > 1 => match set.dtype() {
                Datatype::Compound { fields, .. } => {
                    let numbers = fields.iter().filter(|field| size(&field.datatype).is_some());
                    let named = |field: &CompoundField| of(format!("{name}.{}", field.name), rows, None);
                    numbers.map(|field| SetColumn { field: Some(field), ..named(field) }).collect()
                }
                _ => vec![of(name.clone(), rows, None)],
            },
            [..] if size(set.dtype()).is_none() => Vec::new(),
            [rows, columns] if rows.max(columns) > 1 && rows.min(columns) <= MAX_COLUMNS => {
                let (upright, count) = (rows >= columns, rows.min(columns));
                let named = |at: u64| if count == 1 { name.clone() } else { format!("{name}.{at}") };
                (0..count).map(|at| of(named(at), rows.max(columns), Some((at, upright)))).collect()
            }
            _ => Vec::new(),
        }
    }

    /// The sample rates that the data set states: in its attributes, or as its only number, if its name is that of a
    /// rate.
    fn rates(&self) -> Vec<(String, f64)> {
        let Self { name, set } = self;
        let mut rates = stated_rates(set.attributes(), name);
        if is_rate(name) && size(set.dtype()).is_some() && set.num_elements().is_ok_and(|count| count == 1) {
            let number = set.read_array::<Cell>().ok().and_then(|cells| cells.first().copied());
            rates.extend(number.map(|Cell(number)| (name.clone(), number.as_f64())));
        }
        rates
    }
}

fn stated_rates(attributes: Vec<Attribute>, owner: &str) -> Vec<(String, f64)> {
    let stated = attributes.into_iter().filter(|attribute| is_rate(&attribute.name));
    stated.filter_map(|of| Some((format!("{owner}@{}", of.name), of.read_as_f64().ok()?))).collect()
}

impl SetColumn<'_> {
    fn unit_text(&self) -> Option<String> {
        let attributes = self.set.attributes();
        let named = attributes.iter().find(|of| matches!(of.name.to_lowercase().as_str(), "unit" | "units"))?;
        let text = named.read_string().ok()?;
        Some(text.trim_matches(['\0', ' ']).to_owned())
    }

    /// The name with the unit of the data set, unless the name states it, or the column is a field of a compound.
    /// Another text, such as `counts`, is put beside a name that states a unit, since it may deny that unit.
    fn with_unit(&self) -> String {
        let stated = Unit::of_column(&self.name);
        let text = self.unit_text().filter(|text| self.field.is_none() && !text.is_empty()).unwrap_or_default();
        match text.parse::<Unit>() {
            Ok(unit) if stated != Some(unit) => format!("{} [{unit}]", self.name),
            Err(_) if stated.is_some() && !text.is_empty() => format!("{} [{text}]", self.name),
            _ => self.name.clone(),
        }
    }

    fn read(&self, start: u64, end: u64) -> Result<Vec<BinaryNumber>, Error> {
        let rows = SliceInfoElem::Slice { start, end, step: 1 };
        let selections = match self.at {
            None => vec![rows],
            Some((at, true)) => vec![rows, SliceInfoElem::Index(at)],
            Some((at, false)) => vec![SliceInfoElem::Index(at), rows],
        };
        let cells = self.cells(&SliceInfo { selections })?;
        let missing = || Error::InvalidData(format!("of the rows {start} to {end} there are {}", cells.len()));
        if cells.len() as u64 == end - start { Ok(cells) } else { Err(missing()) }
    }

    fn cells(&self, rows: &SliceInfo) -> Result<Vec<BinaryNumber>, Error> {
        let Some(field) = self.field else {
            return Ok(self.set.read_slice::<Cell>(rows)?.into_iter().map(|Cell(number)| number).collect());
        };
        let of_field =
            |row: CompoundRow| row.0.get(field.byte_offset as usize..).and_then(|at| number(at, &field.datatype));
        let missing = || Error::InvalidData(format!("{} is not in its compound", self.name));
        self.set.read_slice::<CompoundRow>(rows)?.into_iter().map(|row| of_field(row).ok_or_else(missing)).collect()
    }
}

/// Size of this type in bytes, if it is a number.
fn size(of: &Datatype) -> Option<usize> {
    match of {
        Datatype::FixedPoint { size: size @ (1 | 2 | 4 | 8), .. } => Some((*size).into()),
        Datatype::FloatingPoint { size: size @ (4 | 8), .. } => Some((*size).into()),
        _ => None,
    }
}

fn number(bytes: &[u8], of: &Datatype) -> Option<BinaryNumber> {
    let (coding, byte_order) = match of {
        Datatype::FloatingPoint { byte_order, .. } => (Coding::Float, byte_order),
        Datatype::FixedPoint { signed: true, byte_order, .. } => (Coding::Signed, byte_order),
        Datatype::FixedPoint { byte_order, .. } => (Coding::Unsigned, byte_order),
        _ => return None,
    };
    Some(BinaryNumber::decode(coding, bytes.get(..size(of)?)?, *byte_order == ByteOrder::BigEndian))
}

#[derive(Clone, Copy)]
struct Cell(BinaryNumber);

impl H5Type for Cell {
    fn hdf5_type() -> Datatype {
        f64::hdf5_type()
    }

    fn element_size(of: &Datatype) -> usize {
        size(of).unwrap_or_default()
    }

    fn from_bytes(bytes: &[u8], of: &Datatype) -> Result<Self, Error> {
        number(bytes, of).map(Self).ok_or_else(|| Error::InvalidData(format!("{of:?} is no number")))
    }
}

#[derive(Clone)]
struct CompoundRow(Vec<u8>);

impl H5Type for CompoundRow {
    fn hdf5_type() -> Datatype {
        Datatype::Compound { size: 0, fields: Vec::new() }
    }

    fn element_size(of: &Datatype) -> usize {
        match of {
            Datatype::Compound { size, .. } => *size as usize,
            _ => 0,
        }
    }

    fn from_bytes(bytes: &[u8], of: &Datatype) -> Result<Self, Error> {
        let missing = || Error::InvalidData("a compound is cut short".to_owned());
        bytes.get(..Self::element_size(of)).map(|bytes| Self(bytes.to_vec())).ok_or_else(missing)
    }
}
