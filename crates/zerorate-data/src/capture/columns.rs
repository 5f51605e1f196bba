//! The columns of a capture in memory: samples to record batches, and back.

use super::succession::Mark;
use super::{CaptureError, chain};
use crate::cells::integers;
use adis16130::{ChannelStatus, RateCode, Sample, TempCode, Width};
use arrow_array::builder::{UInt8Builder, UInt32Builder};
use arrow_array::types::{UInt8Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrayRef, ArrowPrimitiveType, PrimitiveArray, RecordBatch, UInt8Array, UInt32Array};
use arrow_buffer::ScalarBuffer;
use arrow_schema::{DataType, Field, Metadata, Schema, SchemaRef};
use std::path::Path;
use std::sync::Arc;

/// Rows in a batch at most: a bound on memory.
pub const MAX_ROWS: usize = 8192;

/// Time a batch spans at most: what a killed process costs.
const MAX_SPAN_NS: u64 = 1_000_000_000;

/// Names of the raw columns.
pub const RAW: [&str; 6] = ["t_ns", "edge_seq", "rate_code", "status", "temp_code", "lost"];

/// The raw columns.
pub fn raw_fields() -> Vec<Field> {
    vec![
        Field::new("t_ns", DataType::UInt64, false),
        Field::new("edge_seq", DataType::UInt32, false),
        Field::new("rate_code", DataType::UInt32, false),
        Field::new("status", DataType::UInt8, true),
        Field::new("temp_code", DataType::UInt32, true),
        Field::new("lost", DataType::UInt32, false),
    ]
}

/// The columns that a corrected capture has after the raw ones.
pub fn derived_fields() -> Vec<Field> {
    vec![
        Field::new("rate_dps", DataType::Float64, false),
        Field::new("temp_c", DataType::Float64, true),
        Field::new(CORRECTED, DataType::Float64, true),
        Field::new("flags", DataType::UInt8, false),
    ]
}

/// The column that only a corrected capture has.
pub const CORRECTED: &str = "rate_corrected_dps";

/// The schema of a capture to be written: these columns, the metadata of the file, and the check over both.
pub fn schema(fields: Vec<Field>, metadata: Metadata) -> SchemaRef {
    let schema = Schema::new(fields).with_metadata(metadata);
    let metadata = schema.metadata().clone().with(chain::HEAD, chain::head(&schema));
    Arc::new(schema.with_metadata(metadata))
}

/// The rows of the open batch.
pub(crate) struct OpenBatch {
    t_ns: Vec<u64>,
    edge_seq: Vec<u32>,
    rate_code: Vec<u32>,
    status: UInt8Builder,
    temp_code: UInt32Builder,
    lost: Vec<u32>,
}

impl OpenBatch {
    /// No row yet.
    pub fn new() -> Self {
        Self {
            t_ns: Vec::with_capacity(MAX_ROWS),
            edge_seq: Vec::with_capacity(MAX_ROWS),
            rate_code: Vec::with_capacity(MAX_ROWS),
            status: UInt8Builder::with_capacity(MAX_ROWS),
            temp_code: UInt32Builder::with_capacity(MAX_ROWS),
            lost: Vec::with_capacity(MAX_ROWS),
        }
    }

    /// Whether the batch has no row.
    pub fn is_empty(&self) -> bool {
        self.t_ns.is_empty()
    }

    /// Whether a row at `t_ns` belongs into the next batch.
    pub fn is_full_for(&self, t_ns: u64) -> bool {
        self.t_ns.len() == MAX_ROWS
            || self.t_ns.first().is_some_and(|first| t_ns.saturating_sub(*first) >= MAX_SPAN_NS)
    }

    /// Adds a row.
    pub fn push(&mut self, sample: &Sample) {
        self.t_ns.push(sample.t_ns);
        self.edge_seq.push(sample.seq);
        self.rate_code.push(sample.rate.code());
        self.status.append_option(sample.status.map(ChannelStatus::bits));
        self.temp_code.append_option(sample.temp.map(TempCode::code));
        self.lost.push(sample.lost);
    }

    /// Takes the rows out.
    pub fn close(&mut self) -> Vec<ArrayRef> {
        let mut rows = std::mem::replace(self, Self::new());
        vec![
            column::<UInt64Type>(rows.t_ns),
            column::<UInt32Type>(rows.edge_seq),
            column::<UInt32Type>(rows.rate_code),
            Arc::new(rows.status.finish()),
            Arc::new(rows.temp_code.finish()),
            column::<UInt32Type>(rows.lost),
        ]
    }
}

fn column<T: ArrowPrimitiveType>(values: Vec<T::Native>) -> ArrayRef
where
    ScalarBuffer<T::Native>: From<Vec<T::Native>>,
{
    Arc::new(PrimitiveArray::<T>::new(values.into(), None))
}

/// The rows of a batch that was read: checked, typed, raw.
pub struct Rows {
    t_ns: ScalarBuffer<u64>,
    edge_seq: ScalarBuffer<u32>,
    rate_code: ScalarBuffer<u32>,
    status: UInt8Array,
    temp_code: UInt32Array,
    lost: ScalarBuffer<u32>,
    width: Width,
}

impl Rows {
    /// The raw columns of a batch of the capture at `path`; `place` says which batch, should it be damaged.
    pub fn from_batch(path: &Path, place: &str, batch: &RecordBatch, width: Width) -> Result<Self, CaptureError> {
        let source = Source { path, place, batch };
        let rows = Self {
            t_ns: source.required::<UInt64Type>("t_ns")?,
            edge_seq: source.required::<UInt32Type>("edge_seq")?,
            rate_code: source.required::<UInt32Type>("rate_code")?,
            status: source.column::<UInt8Type>("status")?,
            temp_code: source.column::<UInt32Type>("temp_code")?,
            lost: source.required::<UInt32Type>("lost")?,
            width,
        };
        source.check_codes("rate_code", rows.rate_code.iter().copied(), width)?;
        source.check_codes("temp_code", rows.temp_code.iter().flatten(), width)?;
        Ok(rows)
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.t_ns.len()
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// What each row says of the way from the row before.
    pub fn marks(&self) -> impl Iterator<Item = Mark> {
        let rows = self.t_ns.iter().zip(&self.edge_seq[..]).zip(&self.lost[..]);
        rows.map(|((t_ns, edge_seq), lost)| Mark { t_ns: *t_ns, edge_seq: *edge_seq, lost: *lost })
    }

    /// The sample in row `i`, which must be below [`Rows::len`].
    pub fn sample(&self, i: usize) -> Sample {
        Sample {
            t_ns: self.t_ns[i],
            seq: self.edge_seq[i],
            rate: RateCode::new(self.rate_code[i], self.width),
            status: self.status.is_valid(i).then(|| ChannelStatus::new(self.status.value(i))),
            temp: self.temp_code.is_valid(i).then(|| TempCode::new(self.temp_code.value(i), self.width)),
            lost: self.lost[i],
        }
    }

    /// All samples, in order.
    pub fn samples(&self) -> impl Iterator<Item = Sample> {
        (0..self.len()).map(|i| self.sample(i))
    }

    /// The raw columns as they were.
    pub fn columns(&self) -> Vec<ArrayRef> {
        vec![
            Arc::new(PrimitiveArray::<UInt64Type>::new(self.t_ns.clone(), None)),
            Arc::new(PrimitiveArray::<UInt32Type>::new(self.edge_seq.clone(), None)),
            Arc::new(PrimitiveArray::<UInt32Type>::new(self.rate_code.clone(), None)),
            Arc::new(self.status.clone()),
            Arc::new(self.temp_code.clone()),
            Arc::new(PrimitiveArray::<UInt32Type>::new(self.lost.clone(), None)),
        ]
    }
}

/// A batch, and where it stands.
struct Source<'a> {
    path: &'a Path,
    place: &'a str,
    batch: &'a RecordBatch,
}

impl Source<'_> {
    /// A column by name, in the type of the format: other software may have widened it.
    fn column<T: ArrowPrimitiveType<Native: TryFrom<i128>>>(
        &self,
        name: &str,
    ) -> Result<PrimitiveArray<T>, CaptureError> {
        let found = self
            .batch
            .column_by_name(name)
            .ok_or_else(|| CaptureError::not_a_capture(self.path, format!("it has no column `{name}`")))?;
        integers(found).map_err(|error| self.damaged(format!("column {name}: {error}")))
    }

    /// The same, without nulls.
    fn required<T: ArrowPrimitiveType<Native: TryFrom<i128>>>(
        &self,
        name: &str,
    ) -> Result<ScalarBuffer<T::Native>, CaptureError> {
        let column = self.column::<T>(name)?;
        match column.null_count() {
            0 => Ok(column.values().clone()),
            empty => Err(self.damaged(format!("column {name} has {empty} empty cells"))),
        }
    }

    fn check_codes(&self, name: &str, mut codes: impl Iterator<Item = u32>, width: Width) -> Result<(), CaptureError> {
        match codes.find(|code| *code > width.max_code()) {
            Some(code) => {
                Err(self.damaged(format!("{name} {code} is no code of {} bits, as the metadata states", width.bits())))
            }
            None => Ok(()),
        }
    }

    fn damaged(&self, what: String) -> CaptureError {
        CaptureError::damaged(self.path, self.place, what)
    }
}
