//! The checks of a capture: each block ends with a hash over everything before it (docs/formats/capture.md, "Checks").

use super::columns::Rows;
use super::hash::{SampleHash, hex};
use super::layout::Layout;
use arrow_array::cast::AsArray;
use arrow_array::{Array, ArrayRef, RecordBatch};
use arrow_schema::{DataType, Field, Metadata, Schema, SchemaRef};
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::sync::Arc;
use zerorate_input::table::{CHECKS, DESCRIPTION};

/// Metadata key of the check of the description.
pub const HEAD: &str = "zerorate.check.head";

const PREFIX: &[u8] = b"zerorate.capture.v2\n";
const END_MARK: &[u8] = b"end\n";

/// Number of hexadecimal digits of a check. A check misses a random change with a probability of 2⁻⁶⁴.
const DIGITS: usize = 16;

/// The statement at the end of a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct End {
    /// Number of rows in the file.
    pub rows: u64,
    /// The sample hash of all rows.
    pub samples_sha256: String,
    /// The check over the last block's check, the number of rows and the sample hash.
    pub check: String,
}

impl End {
    /// Formats the statement as it stands in the file. The text always has the same length.
    pub fn to_text(&self) -> String {
        format!("{:020} {} {}", self.rows, self.samples_sha256, self.check)
    }

    /// Parses the text of [`End::to_text`]; `None` if it is malformed.
    pub fn parse(text: &str) -> Option<Self> {
        let mut words = text.split(' ');
        let end = Self {
            rows: words.next()?.parse().ok()?,
            samples_sha256: words.next()?.to_owned(),
            check: words.next()?.to_owned(),
        };
        let whole = end.samples_sha256.len() == 64 && end.check.len() == DIGITS;
        (whole && words.next().is_none()).then_some(end)
    }
}

/// Computes the checks of a table while rows are added.
pub struct Chain {
    link: [u8; 32],
    samples: SampleHash,
    raw: Vec<String>,
    others: Sha256,
    rows: u64,
}

impl Chain {
    /// The chain begins with the hash of the description.
    pub fn new(schema: &Schema, layout: &Layout) -> Self {
        let raw = layout.raw_fields().iter().map(|field| field.name().clone()).collect();
        let (link, samples) = (head_digest(schema), SampleHash::new(layout));
        Self { link, samples, raw, others: Sha256::new(), rows: 0 }
    }

    /// Adds the next rows of a table, whose raw columns are `rows`.
    pub fn take(&mut self, rows: &Rows, table: &RecordBatch) {
        rows.iter().for_each(|row| self.samples.update(&row));
        self.rows += rows.len() as u64;
        let names = table.schema();
        let others: Vec<Cells> = (names.fields().iter().zip(table.columns()))
            .filter(|(field, _)| !self.raw.contains(field.name()))
            .map(|(_, column)| Cells::of(column))
            .collect();
        for row in 0..if others.is_empty() { 0 } else { table.num_rows() } {
            others.iter().for_each(|cells| self.others.update(cells.row(row)));
        }
    }

    /// Ends a block. Returns the check over the description and all rows so far.
    pub fn seal(&mut self) -> String {
        let mut digest = Sha256::new_with_prefix(self.link);
        digest.update(self.samples.digest());
        digest.update(self.others.clone().finalize());
        self.link = digest.finalize().into();
        hex(&self.link)[..DIGITS].to_owned()
    }

    /// The end statement, if the table ends here.
    pub fn end(&self) -> End {
        let samples_sha256 = self.samples.hex();
        let mut digest = Sha256::new_with_prefix(self.link);
        digest.update(END_MARK);
        digest.update(self.rows.to_le_bytes());
        digest.update(self.samples.digest());
        End { rows: self.rows, samples_sha256, check: hex(&digest.finalize())[..DIGITS].to_owned() }
    }

    pub fn samples_sha256(&self) -> String {
        self.samples.hex()
    }
}

/// The check of a description: of its metadata and its columns with their types.
pub fn head(schema: &Schema) -> String {
    hex(&head_digest(schema))[..DIGITS].to_owned()
}

/// The schema of a new capture: these columns, the metadata of the file, and the check of both.
pub fn checked_schema(fields: Vec<Field>, metadata: Metadata) -> SchemaRef {
    let schema = Schema::new(fields).with_metadata(metadata);
    let metadata = schema.metadata().clone().with(HEAD, head(&schema));
    Arc::new(schema.with_metadata(metadata))
}

/// True if the metadata entry `key` belongs to the description of the capture, over which [`head`] is the check.
pub fn describes(key: &str) -> bool {
    key.starts_with(DESCRIPTION) && !key.starts_with(CHECKS)
}

fn head_digest(schema: &Schema) -> [u8; 32] {
    let entries: BTreeMap<_, _> = schema.metadata().iter().filter(|(key, _)| describes(key)).collect();
    let mut digest = Sha256::new_with_prefix(PREFIX);
    for (key, value) in entries {
        digest.update(format!("{key} = {value}\n"));
    }
    for field in schema.fields() {
        digest.update(format!("{}: {}\n", field.name(), type_name(field.data_type())));
    }
    digest.finalize().into()
}

/// The name of a column type in the format; the Arrow name if no capture has such a column.
fn type_name(data_type: &DataType) -> String {
    let short = match data_type {
        DataType::UInt8 => "u8",
        DataType::UInt16 => "u16",
        DataType::UInt32 => "u32",
        DataType::UInt64 => "u64",
        DataType::Int32 => "i32",
        DataType::Float64 => "f64",
        DataType::Boolean => "bool",
        other => return other.to_string(),
    };
    short.to_owned()
}

/// A column encoded for the checks. For each row: a byte, 0 for a null or else 1, and the value in little endian.
struct Cells {
    bytes: Vec<u8>,
    stride: usize,
}

impl Cells {
    /// Encodes a column of numbers or Booleans. Any other column is not part of a capture, and gives no bytes.
    fn of(column: &ArrayRef) -> Self {
        match (column.data_type(), column.data_type().primitive_width()) {
            (DataType::Boolean, _) => {
                let values: Vec<u8> = column.as_boolean().values().iter().map(u8::from).collect();
                Self::fixed(column, &values, 1)
            }
            (_, Some(width)) => {
                let data = column.to_data();
                Self::fixed(column, &data.buffers()[0].as_slice()[data.offset() * width..], width)
            }
            _ => Self { bytes: Vec::new(), stride: 0 },
        }
    }

    fn fixed(column: &ArrayRef, values: &[u8], width: usize) -> Self {
        let mut bytes = vec![0; column.len() * (1 + width)];
        let rows = bytes.chunks_exact_mut(1 + width).zip(values.chunks_exact(width));
        for (_, (cell, value)) in rows.enumerate().filter(|(row, _)| column.is_valid(*row)) {
            cell[0] = 1;
            cell[1..].copy_from_slice(value);
        }
        Self { bytes, stride: 1 + width }
    }

    fn row(&self, row: usize) -> &[u8] {
        &self.bytes[row * self.stride..(row + 1) * self.stride]
    }
}
