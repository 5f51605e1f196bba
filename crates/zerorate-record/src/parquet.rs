//! Writes a capture as Parquet: the smallest format, for archives.

use crate::CaptureError;
use crate::blocks::{BlockSink, Out};
use crate::chain::End;
use arrow_array::RecordBatch;
use arrow_schema::{DataType, SchemaRef};
use parquet::arrow::ArrowWriter;
use parquet::basic::{Compression, Encoding};
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{WriterProperties, WriterPropertiesBuilder};
use parquet::schema::types::ColumnPath;
use std::path::{Path, PathBuf};
use zerorate_input::InputError;
pub use zerorate_input::parquet::BLOCK;
use zerorate_input::table::{BATCH_CHECKS, END};

/// Largest number of rows in a row group, which is built in memory.
const ROW_GROUP: usize = 1 << 20;

pub struct ParquetSink {
    path: PathBuf,
    writer: ArrowWriter<Out>,
    checks: Vec<String>,
}

impl ParquetSink {
    pub fn create(path: &Path, out: Out, schema: &SchemaRef) -> Result<Self, CaptureError> {
        let writer = ArrowWriter::try_new(out, schema.clone(), Some(properties(schema)))
            .map_err(|error| InputError::parquet("write", path, error))?;
        Ok(Self { path: path.to_owned(), writer, checks: Vec::new() })
    }
}

impl BlockSink for ParquetSink {
    fn write(&mut self, rows: &RecordBatch, check: Option<&str>) -> Result<(), CaptureError> {
        self.checks.extend(check.map(str::to_owned));
        self.writer.write(rows).map_err(|error| InputError::parquet("write", &self.path, error).into())
    }

    fn finish(mut self: Box<Self>, check: Option<&str>, end: &End) -> Result<(), CaptureError> {
        self.checks.extend(check.map(str::to_owned));
        let Self { path, mut writer, checks } = *self;
        writer.append_key_value_metadata(KeyValue::new(BATCH_CHECKS.to_owned(), checks.join(" ")));
        writer.append_key_value_metadata(KeyValue::new(END.to_owned(), end.to_text()));
        writer.close().map(drop).map_err(|error| InputError::parquet("write", &path, error).into())
    }
}

/// The properties of the file. The metadata is also written as Parquet metadata, for readers without Arrow.
fn properties(schema: &SchemaRef) -> WriterProperties {
    let metadata = schema.metadata().iter().map(|(key, value)| KeyValue::new(key.clone(), value.clone())).collect();
    let start = WriterProperties::builder()
        .set_compression(Compression::SNAPPY)
        .set_max_row_group_row_count(Some(ROW_GROUP))
        .set_key_value_metadata(Some(metadata));
    schema
        .fields()
        .iter()
        .fold(start, |properties, field| encoding(properties, field.name(), field.data_type()))
        .build()
}

/// Chooses a column's encoding. Timestamps and codes differ little from row to row, so their differences are stored.
/// A dictionary does not help with f64 values, which hardly ever repeat.
fn encoding(properties: WriterPropertiesBuilder, name: &str, data_type: &DataType) -> WriterPropertiesBuilder {
    let column = ColumnPath::from(name);
    match data_type {
        _ if matches!(name, "t_ns" | "edge_seq") || name.ends_with("_code") => properties
            .set_column_dictionary_enabled(column.clone(), false)
            .set_column_encoding(column, Encoding::DELTA_BINARY_PACKED),
        DataType::Float64 => properties.set_column_dictionary_enabled(column, false),
        _ => properties,
    }
}
