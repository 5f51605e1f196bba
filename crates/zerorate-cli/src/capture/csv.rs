//! The CSV form: the description as comment lines, a header, then the rows.

use super::CaptureError;
use super::columns::{MAX_ROWS, derived_fields, raw_fields, schema};
use super::delimited::{Delimiter, Lines};
use super::table::{BatchSink, BatchSource};
use arrow::array::{ArrayRef, ArrowPrimitiveType, PrimitiveBuilder, RecordBatch};
use arrow::csv::{Writer, WriterBuilder};
use arrow::datatypes::{DataType, Field, Float64Type, Metadata, SchemaRef, UInt8Type, UInt32Type, UInt64Type};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::str::FromStr;
use std::sync::Arc;

/// How every CSV capture starts.
pub const PREAMBLE: &str = "# zerorate.";

/// Bytes of a few batches.
const WRITE_BUFFER: usize = 1 << 20;

/// Writes a CSV file.
pub struct Sink {
    path: PathBuf,
    rows: Writer<BufWriter<File>>,
}

impl Sink {
    /// Writes the description and the header.
    pub fn create(path: &Path, file: File, schema: &SchemaRef) -> Result<Self, CaptureError> {
        let mut out = BufWriter::with_capacity(WRITE_BUFFER, file);
        schema
            .metadata()
            .iter()
            .try_for_each(|(key, value)| writeln!(out, "# {key} = {}", value.replace(['\r', '\n'], " ")))
            .map_err(|error| CaptureError::io("write", path, error))?;
        let mut sink = Self { path: path.to_owned(), rows: WriterBuilder::new().with_header(true).build(out) };
        sink.write(&RecordBatch::new_empty(schema.clone()))?;
        Ok(sink)
    }
}

impl BatchSink for Sink {
    fn write(&mut self, batch: &RecordBatch) -> Result<(), CaptureError> {
        self.rows.write(batch).map_err(|error| CaptureError::arrow("write", &self.path, error))
    }

    fn finish(self: Box<Self>) -> Result<(), CaptureError> {
        let Self { path, rows } = *self;
        rows.into_inner().flush().map_err(|error| CaptureError::io("write", &path, error))
    }
}

/// Reads a CSV capture.
pub struct Source {
    path: PathBuf,
    lines: Lines,
    schema: SchemaRef,
    /// For each column of the file, in order: its builder, or none if its name is unknown.
    columns: Vec<(String, Option<Box<dyn CellColumn>>)>,
    ended: bool,
    warning: Option<String>,
}

impl Source {
    /// Reads the description and the header.
    pub fn open(path: &Path, file: File) -> Result<Self, CaptureError> {
        let mut lines = Lines::new(path, file);
        let mut description = Metadata::new();
        let header = loop {
            let Some(line) = lines.next()? else {
                return Err(CaptureError::not_a_capture(path, "it has no header line"));
            };
            let Some(comment) = line.text.strip_prefix('#') else {
                break line.text.to_owned();
            };
            if let Some((key, value)) = comment.split_once('=') {
                description.insert(key.trim().to_owned(), value.trim().to_owned());
            }
        };
        let known: Vec<Field> = raw_fields().into_iter().chain(derived_fields()).collect();
        let field = |name: &str| known.iter().find(|field| field.name() == name);
        let names: Vec<&str> = Delimiter::Comma.cells(&header).collect();
        let fields =
            names.iter().filter_map(|name| field(name)).map(|field| field.clone().with_nullable(true)).collect();
        let columns = names
            .iter()
            .map(|name| ((*name).to_owned(), field(name).map(|field| cell_column(field.data_type()))))
            .collect();
        Ok(Self {
            path: path.to_owned(),
            lines,
            schema: schema(fields, description),
            columns,
            ended: false,
            warning: None,
        })
    }

    /// Reads a line into the columns; false at the end.
    fn read_row(&mut self) -> Result<bool, CaptureError> {
        let Some(line) = self.lines.next()? else {
            return Ok(false);
        };
        if !line.ended {
            self.warning = Some(format!(
                "{} does not end with a line end: its last line may be cut short and is dropped",
                self.path.display()
            ));
            return Ok(false);
        }
        let mut cells = Delimiter::Comma.cells(line.text);
        for (name, column) in &mut self.columns {
            let wrong =
                |what: String| CaptureError::damaged(&self.path, format!("line {}, column {name}", line.number), what);
            let cell = cells.next().ok_or_else(|| wrong("the line ends before this cell".to_owned()))?;
            if column.as_mut().is_some_and(|column| !column.push(cell)) {
                return Err(wrong(format!("`{cell}` is no number in the range of this column")));
            }
        }
        match cells.next() {
            Some(_) => Err(CaptureError::damaged(
                &self.path,
                format!("line {}", line.number),
                "more cells than the header has",
            )),
            None => Ok(true),
        }
    }

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, CaptureError> {
        let mut rows = 0;
        while rows < MAX_ROWS && !self.ended {
            if self.read_row()? {
                rows += 1;
            } else {
                self.ended = true;
            }
        }
        if rows == 0 {
            return Ok(None);
        }
        let columns = self.columns.iter_mut().filter_map(|(_, column)| Some(column.as_mut()?.finish())).collect();
        let batch = RecordBatch::try_new(self.schema.clone(), columns);
        batch.map(Some).map_err(|error| CaptureError::arrow("read", &self.path, error))
    }
}

impl Iterator for Source {
    type Item = Result<RecordBatch, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        let batch = self.read_batch().transpose();
        self.ended |= !matches!(batch, Some(Ok(_)));
        batch
    }
}

impl BatchSource for Source {
    fn schema(&self) -> SchemaRef {
        self.schema.clone()
    }

    fn warning(&self) -> Option<&str> {
        self.warning.as_deref()
    }
}

/// A column that grows by cells of text.
trait CellColumn {
    /// Adds a cell; an empty one is a null. False if it is no number of the type.
    fn push(&mut self, cell: &str) -> bool;

    /// Takes the column out.
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
        DataType::UInt8 => Box::new(PrimitiveBuilder::<UInt8Type>::new()),
        _ => Box::new(PrimitiveBuilder::<Float64Type>::new()),
    }
}
