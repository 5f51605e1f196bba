//! Reads Parquet files. Their index is at the end, so a file that was not closed cannot be read.

use crate::catch_panic::catch_panic;
use crate::limits::OverBudget;
use crate::table::{BATCH_CHECKS, BatchSource, END, Stated};
use crate::{Input, InputError};
use arrow_array::RecordBatch;
use bytes::Bytes;
use parquet::arrow::arrow_reader::{ParquetRecordBatchReader, ParquetRecordBatchReaderBuilder};
use parquet::errors::ParquetError;
use parquet::file::metadata::ParquetMetaData;
use parquet::file::reader::{ChunkReader, Length};
use std::io::{self, BufReader, ErrorKind, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::vec::IntoIter;

/// Rows per batch when a Parquet file is read, and per block when a capture is written as Parquet. All row groups of a
/// capture except the last consist of whole blocks.
pub const BLOCK: usize = 1 << 16;

/// Maximum number of decoded batches that wait in the queue to the reader.
#[cfg(not(target_family = "wasm"))]
const AHEAD: usize = 4;

/// The batches of a file. Another thread decodes them, except in a browser, where there is only one thread.
struct Batches {
    #[cfg(not(target_family = "wasm"))]
    decoded: std::sync::mpsc::Receiver<Result<Option<RecordBatch>, InputError>>,
    #[cfg(target_family = "wasm")]
    decode: Decode,
}

struct Decode {
    path: PathBuf,
    reader: ParquetRecordBatchReader,
}

impl Decode {
    fn next(&mut self) -> Result<Option<RecordBatch>, InputError> {
        let batch = guarded(&self.path, || Ok(self.reader.next()))?;
        batch.transpose().map_err(|error| InputError::arrow("read", &self.path, error))
    }
}

impl Batches {
    #[cfg(not(target_family = "wasm"))]
    fn of(mut decode: Decode) -> Self {
        let (done, decoded) = std::sync::mpsc::sync_channel(AHEAD);
        std::thread::spawn(move || {
            loop {
                let next = decode.next();
                let is_last = !matches!(next, Ok(Some(_)));
                // the receiver is gone if the reader was dropped
                if done.send(next).is_err() || is_last {
                    return;
                }
            }
        });
        Self { decoded }
    }

    #[cfg(not(target_family = "wasm"))]
    fn next(&mut self) -> Result<Option<RecordBatch>, InputError> {
        self.decoded.recv().unwrap_or(Ok(None))
    }

    #[cfg(target_family = "wasm")]
    fn of(decode: Decode) -> Self {
        Self { decode }
    }

    #[cfg(target_family = "wasm")]
    fn next(&mut self) -> Result<Option<RecordBatch>, InputError> {
        self.decode.next()
    }
}

/// Reads any Parquet file, batch by batch.
pub struct ParquetReader {
    /// The decoder, until the first batch is requested and decoding starts.
    decode: Option<Decode>,
    batches: Option<Batches>,
    /// The digests of the batches that are still to come, in order; `None` if the file has none.
    checks: Option<IntoIter<String>>,
    stated: Stated,
}

impl ParquetReader {
    /// Opens a file and reads the index at its end.
    pub fn open(path: &Path, input: Input) -> Result<Self, InputError> {
        let again = input.try_clone().map_err(|error| InputError::io("read", path, error))?;
        let builder = guarded(path, || ParquetRecordBatchReaderBuilder::try_new(input))?;
        refuse_joined(path, builder.metadata(), &again)?;
        let schema = builder.schema().clone();
        let stated = |key: &str| Some(schema.metadata().get(key)?.as_str());
        let checks = stated(BATCH_CHECKS).map(|checks| checks.split_whitespace().map(str::to_owned));
        let checks = checks.map(|checks| checks.collect::<Vec<_>>().into_iter());
        let end = stated(END).map(str::to_owned);
        let reader = guarded(path, || builder.with_batch_size(BLOCK).build())?;
        let stated = Stated { end, ..Stated::new(schema) };
        let decode = Some(Decode { path: path.to_owned(), reader });
        Ok(Self { decode, batches: None, checks, stated })
    }
}

/// The magic number at the end of one Parquet file and the one at the start of the next.
const JOINT: &[u8] = b"PAR1PAR1";

/// Size of the footer, bytes: the length of the index and the magic number.
const TAIL: u64 = 8;

/// Refuses several Parquet files that were joined into one. The index at the end counts offsets from the start of the
/// last file, so the library would read pages of the first file instead.
pub fn refuse_joined(path: &Path, metadata: &ParquetMetaData, input: &Input) -> Result<(), InputError> {
    guarded(path, || Ok(joint(metadata, input)?))?.map_or(Ok(()), |at| {
        let what = format!("two files were joined: another one follows after its first {at} bytes; cut it there");
        Err(InputError::damaged(path, "as a Parquet file", what))
    })
}

/// Offset at which a second file begins; `None` for a single file. A single file has nothing between its pages and its
/// index, unless it uses a part of the format that is unknown here.
fn joint(metadata: &ParquetMetaData, input: &Input) -> io::Result<Option<u64>> {
    let tail = input.length()?.saturating_sub(TAIL);
    let index = input.bytes_at(tail, 4)?.first_chunk().map_or(0, |length| u64::from(u32::from_le_bytes(*length)));
    let before = tail.saturating_sub(index).saturating_sub(pages_end(metadata));
    let is_joint = |at: u64| input.bytes_at(at.saturating_sub(4), JOINT.len()).is_ok_and(|mark| &mark[..] == JOINT);
    match before {
        0 => Ok(None),
        before if is_joint(before) => Ok(Some(before)),
        _ => Ok(input.find(JOINT, 0)?.map(|at| at + 4)),
    }
}

/// Offset of the end of the pages, and of their page indexes and Bloom filters, according to `metadata`.
fn pages_end(metadata: &ParquetMetaData) -> u64 {
    let end = |offset: Option<i64>, length: Option<i32>| {
        let offset = offset.and_then(|offset| u64::try_from(offset).ok()).unwrap_or_default();
        offset.saturating_add(length.and_then(|length| u64::try_from(length).ok()).unwrap_or_default())
    };
    let columns = metadata.row_groups().iter().flat_map(|group| group.columns());
    let ends = columns.flat_map(|column| {
        let (start, length) = column.byte_range();
        [
            start.saturating_add(length),
            end(column.column_index_offset(), column.column_index_length()),
            end(column.offset_index_offset(), column.offset_index_length()),
            end(column.bloom_filter_offset(), column.bloom_filter_length()),
        ]
    });
    ends.max().unwrap_or(JOINT.len() as u64 / 2)
}

impl Length for Input {
    fn len(&self) -> u64 {
        self.length().unwrap_or_default()
    }
}

impl ChunkReader for Input {
    type T = BufReader<Self>;

    fn get_read(&self, start: u64) -> Result<Self::T, ParquetError> {
        let mut input = self.try_clone()?;
        input.seek(SeekFrom::Start(start))?;
        Ok(BufReader::new(input))
    }

    fn get_bytes(&self, start: u64, length: usize) -> Result<Bytes, ParquetError> {
        self.bytes_at(start, length).map_err(|error| match error.kind() {
            ErrorKind::UnexpectedEof => ParquetError::EOF(error.to_string()),
            _ => error.into(),
        })
    }
}

/// Runs the Parquet library, which panics on some damaged files, and turns a panic into an error.
pub fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T, ParquetError>) -> Result<T, InputError> {
    let failed = |why: String| Err(InputError::damaged(path, "as a Parquet file", why));
    match catch_panic(read) {
        Some(Ok(value)) => Ok(value),
        Some(Err(error)) => match no_room(&error) {
            Some(why) => Err(InputError::over_budget(path, why)),
            None => failed(format!(
                "{error} (nothing of a Parquet file that was not closed can be read: record as .arrows)"
            )),
        },
        None => failed("its pages cannot be decoded".to_owned()),
    }
}

fn no_room(error: &ParquetError) -> Option<OverBudget> {
    match error {
        ParquetError::External(source) => source.downcast_ref().copied(),
        _ => None,
    }
}

impl BatchSource for ParquetReader {
    fn form(&self) -> &'static str {
        "Parquet"
    }

    fn stated(&self) -> &Stated {
        &self.stated
    }

    fn read_batch(&mut self) -> Result<Option<RecordBatch>, InputError> {
        if let Some(decode) = self.decode.take() {
            self.batches = Some(Batches::of(decode));
        }
        let batch = self.batches.as_mut().map_or(Ok(None), Batches::next)?;
        self.stated.check = self.checks.as_mut().and_then(Iterator::next);
        Ok(batch)
    }

    fn may_be_stripped(&self) -> bool {
        self.checks.is_none() && self.stated.end.is_none()
    }
}
