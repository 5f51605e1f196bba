//! Converts rows of a capture to record batches, and back.

use super::CaptureError;
use super::layout::{CodedAxis, Layout};
use super::row::Row;
use super::succession::Mark;
use arrow_array::builder::Int64Builder;
use arrow_array::types::{Int32Type, Int64Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrayRef, ArrowPrimitiveType, Int64Array, PrimitiveArray, RecordBatch, UInt32Array};
use arrow_buffer::ScalarBuffer;
use arrow_schema::{ArrowError, DataType, Field};
use std::path::Path;
use std::sync::Arc;
use zerorate::{MAX_AXES, Reading, Scale};
use zerorate_input::cells::integers;

/// Largest number of rows in a batch, which bounds the memory.
pub const MAX_ROWS: usize = 8192;

/// Longest time span of a batch, ns. If the process is killed, a stream or a CSV file lacks at most the open batch.
const MAX_SPAN_NS: u64 = 1_000_000_000;

/// The rows that were collected for the next batch.
pub(crate) struct OpenBatch {
    fields: Vec<Field>,
    t_ns: Vec<u64>,
    edge_seq: Vec<u32>,
    codes: Vec<Int64Builder>,
    status: Int64Builder,
    temp_code: Int64Builder,
    lost: Vec<u32>,
}

impl OpenBatch {
    pub fn new(layout: &Layout) -> Self {
        let builder = || Int64Builder::with_capacity(MAX_ROWS);
        Self {
            fields: layout.raw_fields(),
            t_ns: Vec::with_capacity(MAX_ROWS),
            edge_seq: Vec::with_capacity(MAX_ROWS),
            codes: layout.axes().iter().map(|_| builder()).collect(),
            status: builder(),
            temp_code: builder(),
            lost: Vec::with_capacity(MAX_ROWS),
        }
    }

    pub fn is_empty(&self) -> bool {
        self.t_ns.is_empty()
    }

    /// True if a row at `t_ns` belongs to the next batch.
    pub fn is_full_for(&self, t_ns: u64) -> bool {
        self.t_ns.len() == MAX_ROWS
            || self.t_ns.first().is_some_and(|first| t_ns.saturating_sub(*first) >= MAX_SPAN_NS)
    }

    /// Adds a row, which must fit the layout.
    pub fn push(&mut self, row: &Row) {
        self.t_ns.push(row.t_ns);
        self.edge_seq.push(row.edge_seq);
        self.codes.iter_mut().zip(row.codes()).for_each(|(column, code)| column.append_value(*code));
        self.status.append_option(row.status.map(i64::from));
        self.temp_code.append_option(row.temp_code);
        self.lost.push(row.lost);
    }

    /// Returns the rows as columns, and empties the batch.
    pub fn close(&mut self) -> Result<Vec<ArrayRef>, ArrowError> {
        let before = [column::<UInt64Type>(&mut self.t_ns), column::<UInt32Type>(&mut self.edge_seq)];
        let codes = self.codes.iter_mut().chain([&mut self.status, &mut self.temp_code]);
        let codes = codes.map(|codes| -> ArrayRef { Arc::new(codes.finish()) });
        let lost = column::<UInt32Type>(&mut self.lost);
        typed(before.into_iter().chain(codes).chain([lost]), &self.fields)
    }
}

fn column<T: ArrowPrimitiveType>(values: &mut Vec<T::Native>) -> ArrayRef
where
    ScalarBuffer<T::Native>: From<Vec<T::Native>>,
{
    let values = std::mem::replace(values, Vec::with_capacity(MAX_ROWS));
    Arc::new(PrimitiveArray::<T>::new(values.into(), None))
}

/// Converts raw columns, in their order in the file, to the types of their fields.
fn typed(columns: impl Iterator<Item = ArrayRef>, fields: &[Field]) -> Result<Vec<ArrayRef>, ArrowError> {
    let one = |(column, field): (ArrayRef, &Field)| -> Result<ArrayRef, ArrowError> {
        Ok(match field.data_type() {
            DataType::UInt8 => Arc::new(integers::<UInt8Type>(&column)?),
            DataType::UInt16 => Arc::new(integers::<UInt16Type>(&column)?),
            DataType::UInt32 => Arc::new(integers::<UInt32Type>(&column)?),
            DataType::Int32 => Arc::new(integers::<Int32Type>(&column)?),
            _ => column,
        })
    };
    columns.zip(fields).map(one).collect()
}

/// The value in a row; `None` for a null.
#[inline]
fn get<T: ArrowPrimitiveType>(column: &PrimitiveArray<T>, row: usize) -> Option<T::Native> {
    column.is_valid(row).then(|| column.value(row))
}

/// The raw columns of a batch. Their values are checked.
pub struct Rows {
    t_ns: ScalarBuffer<u64>,
    edge_seq: ScalarBuffer<u32>,
    codes: Vec<Int64Array>,
    status: UInt32Array,
    temp_code: Int64Array,
    lost: ScalarBuffer<u32>,
    fields: Vec<Field>,
}

impl Rows {
    /// Reads the raw columns of a batch. `path` names the capture and `place` the batch in errors.
    pub fn from_batch(path: &Path, place: &str, batch: &RecordBatch, layout: &Layout) -> Result<Self, CaptureError> {
        let found = Batch { path, place, batch };
        let codes = layout.axes().iter().map(|axis| found.required_codes(&axis.code_column(), &axis.scale));
        let rows = Self {
            t_ns: found.required::<UInt64Type>("t_ns")?,
            edge_seq: found.required::<UInt32Type>("edge_seq")?,
            codes: codes.collect::<Result<_, _>>()?,
            status: found.column::<UInt32Type>("status")?,
            temp_code: found.codes("temp_code", layout.temp())?,
            lost: found.required::<UInt32Type>("lost")?,
            fields: layout.raw_fields(),
        };
        found.check_status(&rows.status, layout.status_bits())?;
        Ok(rows)
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.t_ns.len()
    }

    /// True if there are no rows.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The time, edge number and losses of each row.
    pub fn marks(&self) -> impl Iterator<Item = Mark> {
        let rows = self.t_ns.iter().zip(&self.edge_seq[..]).zip(&self.lost[..]);
        rows.map(|((t_ns, edge_seq), lost)| Mark { t_ns: *t_ns, edge_seq: *edge_seq, lost: *lost })
    }

    /// Row `i`, which must be below [`Rows::len`].
    #[inline]
    pub fn row(&self, i: usize) -> Row {
        let mut codes = [0; MAX_AXES];
        codes.iter_mut().zip(&self.codes).for_each(|(code, column)| *code = column.value(i));
        Row::with_codes(self.t_ns[i], self.edge_seq[i], codes, self.codes.len())
            .with_lost(self.lost[i])
            .with_status(get(&self.status, i))
            .with_temp_code(get(&self.temp_code, i))
    }

    /// All rows in order.
    pub fn iter(&self) -> impl Iterator<Item = Row> {
        (0..self.len()).map(|i| self.row(i))
    }

    /// The readings of one axis, in order, without building whole rows. Empty if the layout has no such axis.
    pub fn readings<'a>(&'a self, layout: &'a Layout, axis: usize) -> impl Iterator<Item = Reading> + use<'a> {
        let column = layout.axes().get(axis).zip(self.codes.get(axis));
        let readings = move |(axis, codes): (&'a CodedAxis, &'a Int64Array)| {
            self.marks().enumerate().map(move |(i, mark)| {
                layout.reading_of(axis, codes.value(i), get(&self.temp_code, i), get(&self.status, i), mark)
            })
        };
        column.map(readings).into_iter().flatten()
    }

    /// The raw columns, in the order and with the types of the format.
    pub fn columns(&self) -> Result<Vec<ArrayRef>, ArrowError> {
        let before: [ArrayRef; 2] = [
            Arc::new(PrimitiveArray::<UInt64Type>::new(self.t_ns.clone(), None)),
            Arc::new(PrimitiveArray::<UInt32Type>::new(self.edge_seq.clone(), None)),
        ];
        let after: [ArrayRef; 3] = [
            Arc::new(self.status.clone()),
            Arc::new(self.temp_code.clone()),
            Arc::new(PrimitiveArray::<UInt32Type>::new(self.lost.clone(), None)),
        ];
        let codes = self.codes.iter().map(|codes| -> ArrayRef { Arc::new(codes.clone()) });
        typed(before.into_iter().chain(codes).chain(after), &self.fields)
    }
}

struct Batch<'a> {
    path: &'a Path,
    place: &'a str,
    batch: &'a RecordBatch,
}

impl Batch<'_> {
    /// A column by its name, converted to integers of type `T`, since other software may have changed its type.
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

    /// Like [`Self::column`], but a null is an error.
    fn required<T: ArrowPrimitiveType<Native: TryFrom<i128>>>(
        &self,
        name: &str,
    ) -> Result<ScalarBuffer<T::Native>, CaptureError> {
        let column = self.column::<T>(name)?;
        self.check_whole(name, column.null_count())?;
        Ok(column.values().clone())
    }

    fn codes(&self, name: &str, scale: &Scale) -> Result<Int64Array, CaptureError> {
        let codes = self.column::<Int64Type>(name)?;
        let (first, last) = scale.codes();
        match codes.iter().flatten().find(|code| !(first..=last).contains(code)) {
            Some(code) => {
                let bits = scale.width_bits;
                Err(self.damaged(format!("{name} {code} is not a code of {bits} bits, as the metadata states")))
            }
            None => Ok(codes),
        }
    }

    /// Like [`Self::codes`], but a null is an error.
    fn required_codes(&self, name: &str, scale: &Scale) -> Result<Int64Array, CaptureError> {
        let codes = self.codes(name, scale)?;
        self.check_whole(name, codes.null_count())?;
        Ok(codes)
    }

    fn check_whole(&self, name: &str, empty: usize) -> Result<(), CaptureError> {
        if empty == 0 { Ok(()) } else { Err(self.damaged(format!("column {name} has {empty} empty cells"))) }
    }

    fn check_status(&self, status: &UInt32Array, bits: u8) -> Result<(), CaptureError> {
        match status.iter().flatten().find(|status| u64::from(*status) >> bits > 0) {
            Some(status) => Err(self.damaged(format!("status {status} has more than {bits} bits"))),
            None => Ok(()),
        }
    }

    fn damaged(&self, what: String) -> CaptureError {
        CaptureError::damaged(self.path, self.place, what)
    }
}
