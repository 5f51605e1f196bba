//! The CSV format of a capture: the description as comment lines, a header, then the rows.

use super::CaptureError;
use super::blocks::{BlockSink, Out};
use super::chain::{self, End};
use super::columns::MAX_ROWS;
use super::info::CaptureInfo;
use arrow_array::builder::PrimitiveBuilder;
use arrow_array::cast::AsArray;
use arrow_array::types::{Float64Type, Int32Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrayRef, ArrowPrimitiveType, RecordBatch, downcast_integer_array};
use arrow_schema::{ArrowError, DataType, Field, Metadata, Schema, SchemaRef};
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;
use zerorate_input::delimited::{Delimiter, Lines};
use zerorate_input::table::{BATCH_CHECK, BatchSource, END, Stated};
use zerorate_input::{Input, InputError, InputWarning};

/// The start of every CSV capture.
pub const PREAMBLE: &str = "# zerorate.";

/// Size of the write buffer, bytes. It holds a few batches.
const WRITE_BUFFER: usize = 1 << 20;

pub struct CsvSink {
    path: PathBuf,
    out: BufWriter<Out>,
}

impl CsvSink {
    pub fn create(path: &Path, out: Out, schema: &SchemaRef) -> Result<Self, CaptureError> {
        let mut sink = Self { path: path.to_owned(), out: BufWriter::with_capacity(WRITE_BUFFER, out) };
        schema.metadata().iter().try_for_each(|(key, value)| sink.state(key, value))?;
        let names: Vec<&str> = schema.fields().iter().map(|field| field.name().as_str()).collect();
        sink.text(&(names.join(",") + "\n"))?;
        Ok(sink)
    }

    /// Writes a metadata entry as a comment line.
    fn state(&mut self, key: &str, value: &str) -> Result<(), CaptureError> {
        self.text(&format!("# {key} = {value}\n"))
    }

    fn rows(&mut self, rows: &RecordBatch) -> Result<(), CaptureError> {
        let written: Result<Vec<_>, _> = rows.columns().iter().map(written).collect();
        let written = written.map_err(|error| InputError::arrow("write", &self.path, error))?;
        let mut line = String::new();
        for row in 0..rows.num_rows() {
            line.clear();
            for (index, column) in written.iter().enumerate() {
                line.push_str(if index == 0 { "" } else { "," });
                column(row, &mut line);
            }
            line.push('\n');
            self.text(&line)?;
        }
        Ok(())
    }

    fn text(&mut self, text: &str) -> Result<(), CaptureError> {
        self.out.write_all(text.as_bytes()).map_err(|error| CaptureError::io("write", &self.path, error))
    }

    fn flush(&mut self) -> Result<(), CaptureError> {
        self.out.flush().map_err(|error| CaptureError::io("write", &self.path, error))
    }
}

impl BlockSink for CsvSink {
    fn write(&mut self, rows: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError> {
        self.rows(rows)?;
        check.map_or(Ok(()), |check| self.state(BATCH_CHECK, check))?;
        self.flush()
    }

    fn finish(mut self: Box<Self>, check: Option<&str>, end: &End) -> Result<(), CaptureError> {
        check.map_or(Ok(()), |check| self.state(BATCH_CHECK, check))?;
        self.state(END, &end.to_text())?;
        self.flush()
    }
}

pub struct CsvReader {
    path: PathBuf,
    lines: Lines,
    /// The name and builder of each column in the file, in order. The builder is `None` for an unknown name.
    columns: Vec<NamedColumn>,
    /// True if the rows have checks, as in version 2 of the format.
    is_checked: bool,
    length: u64,
    /// Position behind the end statement, bytes; 0 before the statement was read.
    end: u64,
    stated: Stated,
}

/// A line below the header.
enum Entry {
    /// A row. It was added to the columns.
    Row,
    /// The check over all rows before it.
    Check(String),
    End(String),
    Comment,
    /// The end of the file, possibly after an incomplete line.
    Nothing,
}

impl CsvReader {
    pub fn open(path: &Path, input: Input) -> Result<Self, CaptureError> {
        let length = input.length().map_err(|error| CaptureError::io("read", path, error))?;
        let mut lines = Lines::new(path, input);
        let mut description = Metadata::new();
        let header = loop {
            let Some(line) = lines.next_line()? else {
                return Err(CaptureError::not_a_capture(path, "it has no header line"));
            };
            let Some(comment) = line.text.strip_prefix('#') else {
                break line.text.to_owned();
            };
            if let Some((key, value)) = comment.split_once('=') {
                description.insert(key.trim().to_owned(), value.trim().to_owned());
            }
        };
        let layout = CaptureInfo::from_metadata(path, &description)?.layout;
        let known = [layout.raw_fields(), layout.derived_fields()].concat();
        let field = |name: &str| known.iter().find(|field| field.name() == name);
        let names: Vec<&str> = Delimiter::Comma.cells(&header).collect();
        let fields: Vec<Field> =
            names.iter().filter_map(|name| field(name)).map(|field| field.clone().with_nullable(true)).collect();
        let columns = names
            .iter()
            .map(|name| ((*name).to_owned(), field(name).map(|field| cell_column(field.data_type()))))
            .collect();
        Ok(Self {
            path: path.to_owned(),
            lines,
            is_checked: description.contains_key(chain::HEAD),
            length,
            end: 0,
            columns,
            stated: Stated::new(Arc::new(Schema::new(fields).with_metadata(description))),
        })
    }

    fn read_entry(&mut self) -> Result<Entry, InputError> {
        let Some(line) = self.lines.next_line()? else {
            return Ok(Entry::Nothing);
        };
        let place = format!("line {}", line.number);
        if let Some(comment) = line.text.strip_prefix('#') {
            return match statement(comment) {
                Some(Entry::Check(_)) | None if !line.ended => Ok(Entry::Nothing),
                Some(entry) => Ok(entry),
                None => Err(InputError::damaged(&self.path, place, "what it states about the end is malformed")),
            };
        }
        if self.stated.end.is_some() {
            let bytes = self.length.saturating_sub(self.end);
            let what = format!("rows follow behind its end, in {bytes} bytes; were two files joined?");
            return Err(InputError::damaged(&self.path, place, what));
        }
        if !line.ended {
            let path = self.path.display();
            let text = format!("{path} lacks its last line end; its last line may be cut short and is dropped");
            self.stated.warning = Some(InputWarning::Torn(text));
            return Ok(Entry::Nothing);
        }
        push_cells(&self.path, &place, line.text, &mut self.columns)?;
        Ok(Entry::Row)
    }

    /// Marks the file as incomplete. Its last `rows` rows are dropped.
    fn torn(&mut self, rows: usize) {
        self.stated.torn = true;
        let path = self.path.display();
        let text = format!("{path} was not closed; {rows} rows after its last whole block are dropped");
        self.stated.warning = Some(InputWarning::Torn(text));
    }

    fn damaged(&self, what: &str) -> InputError {
        InputError::damaged(&self.path, format!("line {}", self.lines.number()), what)
    }
}

/// Parses the statement in a comment; `None` if it is malformed.
fn statement(comment: &str) -> Option<Entry> {
    let entry = comment.split_once('=').map(|(key, value)| (key.trim(), value.trim()));
    match entry {
        Some((BATCH_CHECK, check)) => Some(Entry::Check(check.to_owned())),
        Some((END, end)) => End::parse(end).map(|_| Entry::End(end.to_owned())),
        _ => Some(Entry::Comment),
    }
}

type NamedColumn = (String, Option<Box<dyn CellColumn>>);

fn push_cells(path: &Path, place: &str, line: &str, columns: &mut [NamedColumn]) -> Result<(), InputError> {
    let mut cells = Delimiter::Comma.cells(line);
    for (name, column) in columns {
        let wrong = |what: String| InputError::damaged(path, format!("{place}, column {name}"), what);
        let cell = cells.next().ok_or_else(|| wrong("the line ends before this cell".to_owned()))?;
        if column.as_mut().is_some_and(|column| !column.push(cell)) {
            return Err(wrong(format!("`{cell}` is not a number in the range of this column")));
        }
    }
    match cells.next() {
        Some(_) => Err(InputError::damaged(path, place, "more cells than the header has")),
        None => Ok(()),
    }
}

impl BatchSource for CsvReader {
    fn form(&self) -> &'static str {
        "CSV"
    }

    fn stated(&self) -> &Stated {
        &self.stated
    }

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, InputError> {
        let mut rows = 0;
        self.stated.check = None;
        while !self.stated.ended && self.stated.check.is_none() && (self.is_checked || rows < MAX_ROWS) {
            match self.read_entry()? {
                Entry::Row if rows == MAX_ROWS => return Err(self.damaged("a check is missing among its rows")),
                Entry::Row => rows += 1,
                Entry::Check(_) if rows == 0 => return Err(self.damaged("a check without rows")),
                Entry::Check(check) => self.stated.check = Some(check),
                Entry::End(_) if rows > 0 => return Err(self.damaged("the check of its last rows is missing")),
                Entry::End(end) => {
                    self.end = self.lines.position();
                    self.stated.end = Some(end);
                }
                Entry::Comment => {}
                Entry::Nothing => self.stated.ended = true,
            }
        }
        if self.is_checked && self.stated.ended && self.stated.end.is_none() {
            self.torn(rows);
            return Ok(None);
        }
        if rows == 0 {
            return Ok(None);
        }
        let columns = self.columns.iter_mut().filter_map(|(_, column)| Some(column.as_mut()?.finish())).collect();
        let batch = RecordBatch::try_new(self.stated.schema.clone(), columns);
        batch.map(Some).map_err(|error| InputError::arrow("read", &self.path, error))
    }

    fn may_be_stripped(&self) -> bool {
        false
    }
}

/// A function that writes the cell of a row into a line; it writes nothing for a null.
type WriteCell<'a> = Box<dyn Fn(usize, &mut String) + 'a>;

fn written(column: &ArrayRef) -> Result<WriteCell<'_>, ArrowError> {
    downcast_integer_array! {
        column => {
            Ok(Box::new(|row, line| {
                if column.is_valid(row) {
                    line.push_str(&column.value(row).to_string());
                }
            }))
        }
        DataType::Float64 => {
            let column = column.as_primitive::<Float64Type>();
            Ok(Box::new(|row, line| {
                if column.is_valid(row) {
                    push_float(column.value(row), line);
                }
            }))
        }
        other => Err(ArrowError::CsvError(format!("{other} is not a type of a capture's column")))
    }
}

/// Writes the shortest decimal that reads back as the same number, with a decimal point if it is finite.
fn push_float(value: f64, line: &mut String) {
    let plain = value == 0.0 || (1e-5..1e9).contains(&value.abs());
    let text = if plain || !value.is_finite() { value.to_string() } else { format!("{value:e}") };
    let (mantissa, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    line.push_str(mantissa);
    line.push_str(if mantissa.contains('.') || !value.is_finite() { "" } else { ".0" });
    line.push_str(exponent);
}

/// A column that is built from cells of text.
trait CellColumn {
    /// Adds a cell; an empty cell is a null. Returns `false` if the cell is not a number of the column's type.
    fn push(&mut self, cell: &str) -> bool;

    /// Returns the column, and empties the builder.
    fn finish(&mut self) -> ArrayRef;
}

impl<T: ArrowPrimitiveType> CellColumn for PrimitiveBuilder<T>
where
    T::Native: FromStr,
{
    fn push(&mut self, cell: &str) -> bool {
        if cell.is_empty() {
            self.append_null();
            return true;
        }
        cell.parse().map(|value| self.append_value(value)).is_ok()
    }

    fn finish(&mut self) -> ArrayRef {
        Arc::new(PrimitiveBuilder::finish(self))
    }
}

fn cell_column(data_type: &DataType) -> Box<dyn CellColumn> {
    match data_type {
        DataType::UInt64 => Box::new(PrimitiveBuilder::<UInt64Type>::new()),
        DataType::UInt32 => Box::new(PrimitiveBuilder::<UInt32Type>::new()),
        DataType::UInt16 => Box::new(PrimitiveBuilder::<UInt16Type>::new()),
        DataType::Int32 => Box::new(PrimitiveBuilder::<Int32Type>::new()),
        DataType::UInt8 => Box::new(PrimitiveBuilder::<UInt8Type>::new()),
        _ => Box::new(PrimitiveBuilder::<Float64Type>::new()),
    }
}
