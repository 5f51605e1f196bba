//! Reads columns of a Parquet file. Besides the first rows of all columns, only the wanted columns are read and
//! decoded, several row groups at a time.

use super::open::Log;
use super::sample::ROWS;
use super::series::ROW_BYTES;
use super::tabular::TableColumns;
use crate::error::Result;
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
use arrow_array::{ArrayRef, RecordBatch};
use arrow_schema::{DataType, Field, FieldRef, Schema};
use bytes::{Buf, Bytes, buf};
use parquet::arrow::ProjectionMask;
use parquet::arrow::arrow_reader::{
    ArrowReaderMetadata, ArrowReaderOptions, ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder,
};
use parquet::errors::{ParquetError, Result as ParquetResult};
use parquet::file::reader::{ChunkReader, Length};
use rayon::iter::{IntoParallelIterator, ParallelIterator};
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex};
use zerorate_input::limits::MemoryBudget;
use zerorate_input::parquet::{guarded, refuse_joined};
use zerorate_input::{Input, InputError};

/// Number of rows of a piece, the part of a column that is decoded at once.
const PIECE: usize = 1 << 16;

pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, input: file, room, .. } = log;
    let metadata = guarded(path, || ArrowReaderMetadata::load(&file, ArrowReaderOptions::default()))?;
    refuse_joined(path, metadata.metadata(), &file)?;
    let schema = metadata.schema().clone();
    let mut reading = TableColumns::start(path, &schema, room, asked, None)?;
    let groups = Groups {
        path,
        file: Mutex::new(file),
        metadata,
        columns: reading.columns.clone(),
        row_bytes: ROW_BYTES.saturating_mul(reading.len() as u64),
        room,
        rows_read: AtomicU64::new(0),
    };
    groups.first_rows().iter().try_for_each(|rows| reading.sample(rows))?;
    reading.reserve(groups.rows(), &schema);
    let at_once = rayon::current_num_threads();
    for first in (0..groups.len()).step_by(at_once) {
        let decoded: Vec<_> =
            (first..groups.len().min(first + at_once)).into_par_iter().map(|group| groups.decode(group)).collect();
        for pieces in decoded {
            pieces?.iter().try_for_each(|piece| reading.append(piece))?;
        }
    }
    reading.finish(None)
}

struct Groups<'a> {
    path: &'a Path,
    file: Mutex<Input>,
    metadata: ArrowReaderMetadata,
    columns: Vec<usize>,
    /// Number of bytes that a row of all wanted columns takes.
    row_bytes: u64,
    room: MemoryBudget,
    /// Number of decoded rows, summed over the columns. A page of a few bytes may state any number of rows.
    rows_read: AtomicU64,
}

impl Groups<'_> {
    fn len(&self) -> usize {
        self.metadata.metadata().num_row_groups()
    }

    /// The number of rows that the file states, up to [`MAX_RESERVED`].
    fn rows(&self) -> usize {
        let stated = self.metadata.metadata().file_metadata().num_rows();
        usize::try_from(stated).unwrap_or_default().min(MAX_RESERVED)
    }

    fn first_rows(&self) -> Vec<RecordBatch> {
        let mut rows = 0;
        let next = |group: usize| {
            let batch = (rows < ROWS).then(|| self.first_rows_of(group)).flatten()?;
            rows += batch.num_rows();
            Some(batch)
        };
        (0..self.len()).map_while(next).collect()
    }

    /// The first rows of a row group in all columns with numbers or words. `None` if one of these columns cannot be
    /// read. This is not an error, because the column may not be wanted.
    fn first_rows_of(&self, group: usize) -> Option<RecordBatch> {
        let fits = |field: &Field| {
            let of = field.data_type();
            of.is_primitive() || of.is_string() || matches!(of, DataType::Boolean | DataType::Dictionary(..))
        };
        let fields = self.metadata.schema().fields().iter().cloned().enumerate();
        let fields: Vec<(usize, FieldRef)> = fields.filter(|(_, field)| fits(field)).collect();
        let first = |at: usize| self.reader(group, at, ROWS)?.next().transpose().map_err(ParquetError::from);
        let read = |at: usize| Some(guarded(self.path, || first(at)).ok()??.column(0).clone());
        let columns: Vec<ArrayRef> = fields.iter().map(|(at, _)| read(*at)).collect::<Option<_>>()?;
        let schema = Schema::new(fields.into_iter().map(|(_, field)| field).collect::<Vec<_>>());
        RecordBatch::try_new(Arc::new(schema), columns).ok()
    }

    fn decode(&self, group: usize) -> Result<Vec<Vec<ArrayRef>>, InputError> {
        let columns: Vec<Vec<ArrayRef>> = self
            .columns
            .iter()
            .map(|column| guarded(self.path, || self.column(group, *column)))
            .collect::<Result<_, _>>()?;
        let pieces = columns[0].len();
        let stated = self.metadata.metadata().row_group(group).num_rows();
        let has_all = |column: &Vec<ArrayRef>| {
            column.len() == pieces && column.iter().map(|piece| piece.len() as i64).sum::<i64>() == stated
        };
        if !columns.iter().all(has_all) {
            let what = format!("a column of row group {group} does not have the {stated} rows that the index states");
            return Err(InputError::damaged(self.path, "as a Parquet file", what));
        }
        Ok((0..pieces).map(|piece| columns.iter().map(|column| column[piece].clone()).collect()).collect())
    }

    fn column(&self, group: usize, column: usize) -> ParquetResult<Vec<ArrayRef>> {
        let pieces = self.reader(group, column, PIECE)?.map(|batch| {
            let piece = batch?.column(0).clone();
            let rows = piece.len() as u64 + self.rows_read.fetch_add(piece.len() as u64, Ordering::Relaxed);
            let bytes = rows.saturating_mul(self.row_bytes) / self.columns.len() as u64;
            self.room.check(bytes).map_err(|why| ParquetError::External(Box::new(why)))?;
            Ok(piece)
        });
        pieces.collect()
    }

    /// A column of a row group, in pieces of `piece` rows.
    fn reader(&self, group: usize, column: usize, piece: usize) -> ParquetResult<ParquetRecordBatchReader> {
        let chunk = self.chunk(group, column)?;
        ParquetRecordBatchReaderBuilder::new_with_metadata(chunk, self.metadata.clone())
            .with_projection(ProjectionMask::roots(self.metadata.parquet_schema(), [column]))
            .with_row_groups(vec![group])
            .with_batch_size(piece)
            .build()
    }

    fn chunk(&self, group: usize, column: usize) -> ParquetResult<Chunk> {
        let group = self.metadata.metadata().row_group(group);
        let descriptor = self.metadata.parquet_schema();
        let ranges = (0..group.num_columns())
            .filter(|leaf| descriptor.get_column_root_idx(*leaf) == column)
            .map(|leaf| group.column(leaf).byte_range());
        let (start, end) = ranges.fold((u64::MAX, 0), |(from, to), (start, length)| {
            (from.min(start), to.max(start.saturating_add(length)))
        });
        let mut bytes = Vec::new();
        let mut file = self.file.lock().map_err(|_| ParquetError::General("a reader died".to_owned()))?;
        file.seek(SeekFrom::Start(start))?;
        (&mut *file).take(end.saturating_sub(start)).read_to_end(&mut bytes)?;
        Ok(Chunk { start, bytes: bytes.into() })
    }
}

/// Most rows to reserve at once, so that a wrong number of rows in a file does not take all memory.
const MAX_RESERVED: usize = 1 << 26;

/// A range of bytes of a file, addressed by offsets in the whole file.
struct Chunk {
    start: u64,
    bytes: Bytes,
}

impl Chunk {
    fn rest(&self, start: u64) -> ParquetResult<Bytes> {
        let outside = || ParquetError::EOF(format!("byte {start} is outside its column"));
        let offset = start.checked_sub(self.start).and_then(|offset| usize::try_from(offset).ok());
        let offset = offset.filter(|offset| *offset <= self.bytes.len()).ok_or_else(outside)?;
        Ok(self.bytes.slice(offset..))
    }
}

impl Length for Chunk {
    fn len(&self) -> u64 {
        self.start + self.bytes.len() as u64
    }
}

impl ChunkReader for Chunk {
    type T = buf::Reader<Bytes>;

    fn get_read(&self, start: u64) -> ParquetResult<Self::T> {
        Ok(self.rest(start)?.reader())
    }

    fn get_bytes(&self, start: u64, length: usize) -> ParquetResult<Bytes> {
        let rest = self.rest(start)?;
        if length > rest.len() {
            return Err(ParquetError::EOF(format!("{length} bytes at {start} are outside their column")));
        }
        Ok(rest.slice(..length))
    }
}
