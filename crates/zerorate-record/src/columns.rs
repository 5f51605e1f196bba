//! Converts rows of a capture to record batches, and back.

use super::CaptureError;
use super::layout::{CodedAxis, Layout};
use super::row::Row;
use super::succession::Mark;
use arrow_array::builder::{PrimitiveBuilder, UInt32Builder};
use arrow_array::types::{Int32Type, UInt8Type, UInt16Type, UInt32Type, UInt64Type};
use arrow_array::{Array, ArrayRef, ArrowPrimitiveType, Int32Array, PrimitiveArray, RecordBatch, UInt32Array};
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
    codes: Vec<CodeBuilder>,
    status: UInt32Builder,
    temp_code: CodeBuilder,
    lost: Vec<u32>,
}

impl OpenBatch {
    pub fn new(layout: &Layout) -> Self {
        Self {
            fields: layout.raw_fields(),
            t_ns: Vec::with_capacity(MAX_ROWS),
            edge_seq: Vec::with_capacity(MAX_ROWS),
            codes: layout.axes().iter().map(|axis| CodeBuilder::new(&axis.scale)).collect(),
            status: UInt32Builder::with_capacity(MAX_ROWS),
            temp_code: CodeBuilder::new(layout.temp()),
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
        self.codes.iter_mut().zip(row.codes()).for_each(|(column, code)| column.append(Some(*code)));
        self.status.append_option(row.status);
        self.temp_code.append(row.temp_code);
        self.lost.push(row.lost);
    }

    /// Returns the rows as columns, and empties the batch.
    pub fn close(&mut self) -> Result<Vec<ArrayRef>, ArrowError> {
        let ends = [column::<UInt64Type>(&mut self.t_ns), column::<UInt32Type>(&mut self.edge_seq)];
        let codes = self.codes.iter_mut().map(CodeBuilder::finish);
        let status: ArrayRef = Arc::new(self.status.finish());
        let status = narrowed(&status, &self.fields)?;
        let after = [status, self.temp_code.finish(), column::<UInt32Type>(&mut self.lost)];
        Ok(ends.into_iter().chain(codes).chain(after).collect())
    }
}

fn column<T: ArrowPrimitiveType>(values: &mut Vec<T::Native>) -> ArrayRef
where
    ScalarBuffer<T::Native>: From<Vec<T::Native>>,
{
    let values = std::mem::replace(values, Vec::with_capacity(MAX_ROWS));
    Arc::new(PrimitiveArray::<T>::new(values.into(), None))
}

/// Converts the status to the type of its column.
fn narrowed(status: &ArrayRef, fields: &[Field]) -> Result<ArrayRef, ArrowError> {
    let field = fields.iter().find(|field| field.name() == "status");
    Ok(match field.map(Field::data_type) {
        Some(DataType::UInt8) => Arc::new(integers::<UInt8Type>(status)?),
        Some(DataType::UInt16) => Arc::new(integers::<UInt16Type>(status)?),
        _ => status.clone(),
    })
}

enum CodeBuilder {
    Unsigned(PrimitiveBuilder<UInt32Type>),
    Signed(PrimitiveBuilder<Int32Type>),
}

impl CodeBuilder {
    fn new(scale: &Scale) -> Self {
        if scale.signed {
            Self::Signed(PrimitiveBuilder::with_capacity(MAX_ROWS))
        } else {
            Self::Unsigned(PrimitiveBuilder::with_capacity(MAX_ROWS))
        }
    }

    /// Appends a code. The conversion is exact, because codes have at most 32 bits.
    fn append(&mut self, code: Option<i64>) {
        match self {
            Self::Unsigned(codes) => codes.append_option(code.map(|code| code as u32)),
            Self::Signed(codes) => codes.append_option(code.map(|code| code as i32)),
        }
    }

    fn finish(&mut self) -> ArrayRef {
        match self {
            Self::Unsigned(codes) => Arc::new(codes.finish()),
            Self::Signed(codes) => Arc::new(codes.finish()),
        }
    }
}

enum Codes {
    Unsigned(UInt32Array),
    Signed(Int32Array),
}

impl Codes {
    #[inline]
    fn get(&self, row: usize) -> Option<i64> {
        match self {
            Self::Unsigned(codes) => codes.is_valid(row).then(|| codes.value(row).into()),
            Self::Signed(codes) => codes.is_valid(row).then(|| codes.value(row).into()),
        }
    }

    /// The code in a row. The column must not have a null there.
    #[inline]
    fn value(&self, row: usize) -> i64 {
        match self {
            Self::Unsigned(codes) => codes.value(row).into(),
            Self::Signed(codes) => codes.value(row).into(),
        }
    }

    fn to_array(&self) -> ArrayRef {
        match self {
            Self::Unsigned(codes) => Arc::new(codes.clone()),
            Self::Signed(codes) => Arc::new(codes.clone()),
        }
    }

    /// The first value that is outside of the scale's codes; `None` if all are inside.
    fn misfit(&self, scale: &Scale) -> Option<i64> {
        let (first, last) = scale.codes();
        let outside = |code: &i64| !(first..=last).contains(code);
        match self {
            Self::Unsigned(codes) => codes.iter().flatten().map(i64::from).find(outside),
            Self::Signed(codes) => codes.iter().flatten().map(i64::from).find(outside),
        }
    }
}

/// The raw columns of a batch. Their values are checked and have the types of the format.
pub struct Rows {
    t_ns: ScalarBuffer<u64>,
    edge_seq: ScalarBuffer<u32>,
    codes: Vec<Codes>,
    status: UInt32Array,
    temp_code: Codes,
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
        let status = self.status.is_valid(i).then(|| self.status.value(i));
        Row::with_codes(self.t_ns[i], self.edge_seq[i], codes, self.codes.len())
            .with_lost(self.lost[i])
            .with_status(status)
            .with_temp_code(self.temp_code.get(i))
    }

    /// All rows in order.
    pub fn iter(&self) -> impl Iterator<Item = Row> {
        (0..self.len()).map(|i| self.row(i))
    }

    /// The readings of one axis, in order, without building whole rows. Empty if the layout has no such axis.
    pub fn readings<'a>(&'a self, layout: &'a Layout, axis: usize) -> impl Iterator<Item = Reading> + use<'a> {
        let column = layout.axes().get(axis).zip(self.codes.get(axis));
        let readings = move |(axis, codes): (&'a CodedAxis, &'a Codes)| {
            self.marks().enumerate().map(move |(i, mark)| {
                let status = self.status.is_valid(i).then(|| self.status.value(i));
                layout.reading_of(axis, codes.value(i), self.temp_code.get(i), status, mark)
            })
        };
        column.map(readings).into_iter().flatten()
    }

    /// The raw columns, in the order and with the types of the format.
    pub fn columns(&self) -> Result<Vec<ArrayRef>, ArrowError> {
        let status: ArrayRef = Arc::new(self.status.clone());
        let before: [ArrayRef; 2] = [
            Arc::new(PrimitiveArray::<UInt64Type>::new(self.t_ns.clone(), None)),
            Arc::new(PrimitiveArray::<UInt32Type>::new(self.edge_seq.clone(), None)),
        ];
        let after: [ArrayRef; 3] = [
            narrowed(&status, &self.fields)?,
            self.temp_code.to_array(),
            Arc::new(PrimitiveArray::<UInt32Type>::new(self.lost.clone(), None)),
        ];
        Ok(before.into_iter().chain(self.codes.iter().map(Codes::to_array)).chain(after).collect())
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

    fn codes(&self, name: &str, scale: &Scale) -> Result<Codes, CaptureError> {
        let codes = if scale.signed {
            Codes::Signed(self.column::<Int32Type>(name)?)
        } else {
            Codes::Unsigned(self.column::<UInt32Type>(name)?)
        };
        match codes.misfit(scale) {
            Some(code) => {
                let bits = scale.width_bits;
                Err(self.damaged(format!("{name} {code} is not a code of {bits} bits, as the metadata states")))
            }
            None => Ok(codes),
        }
    }

    /// Like [`Self::codes`], but a null is an error.
    fn required_codes(&self, name: &str, scale: &Scale) -> Result<Codes, CaptureError> {
        let codes = self.codes(name, scale)?;
        self.check_whole(name, codes.to_array().null_count())?;
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
