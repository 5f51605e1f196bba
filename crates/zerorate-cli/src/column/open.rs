//! Opens a log by what it contains, whatever its name, and unpacks it.

use crate::capture::CaptureError;
use crate::capture::table::BatchSource;
use crate::output::Temporary;
use arrow::array::RecordBatch;
use arrow::datatypes::SchemaRef;
use arrow::error::ArrowError;
use arrow::ipc::reader::FileReader;
use flate2::read::MultiGzDecoder;
use lzma_rust2::XzReader;
use std::fs::File;
use std::io::{self, BufReader, BufWriter, Read, Seek, Write};
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};

/// As many bytes as the longest mark at a file's start has.
const MARK: u64 = 16;

/// Bytes that a read asks the system for.
const BUFFER: usize = 1 << 18;

/// An opened log.
pub struct Log<'a> {
    /// Its name, for messages.
    pub path: &'a Path,
    /// Its content, from the start.
    pub file: File,
    start: Vec<u8>,
    unpacked: Option<Temporary>,
}

/// What is in a log.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Parquet.
    Parquet,
    /// An Arrow file, also called Feather.
    ArrowFile,
    /// A NumPy array.
    Npy,
    /// MCAP.
    Mcap,
    /// A SQLite database.
    Sqlite,
    /// An Arrow stream, a capture or text.
    Other,
}

/// Opens a file, and unpacks it into a temporary one if it is packed.
pub fn open(path: &Path) -> Result<Log<'_>, CaptureError> {
    let failed = |error| CaptureError::io("read", path, error);
    let file = File::open(path).map_err(failed)?;
    if file.metadata().map_err(failed)?.is_dir() {
        return Err(CaptureError::not_a_log(
            path,
            "it is a directory; name the file (of a ROS 2 bag the .mcap or .db3 in it)",
        ));
    }
    let (mut file, start) = marked(file).map_err(failed)?;
    let Some(packing) = Packing::of(&start) else {
        return Ok(Log { path, file, start, unpacked: None });
    };
    let unpacked = packing.unpack(&mut file).map_err(|error| {
        let what = format!("it cannot be unpacked ({error}); was it cut short?");
        CaptureError::damaged(path, format!("as {packing:?}"), what)
    })?;
    let (file, start) = marked(File::open(unpacked.path()).map_err(failed)?).map_err(failed)?;
    match Packing::of(&start) {
        Some(_) => Err(CaptureError::not_a_log(path, "it is packed twice; unpack it once")),
        None => Ok(Log { path, file, start, unpacked: Some(unpacked) }),
    }
}

impl Log<'_> {
    /// What is in it; what cannot be read comes with advice.
    pub fn form(&self) -> Result<Form, CaptureError> {
        let starts = |mark: &[u8]| self.start.starts_with(mark);
        let foreign = FOREIGN.iter().find(|(mark, _)| starts(mark));
        match foreign {
            Some((_, advice)) => Err(CaptureError::not_a_log(self.path, *advice)),
            None if self.start.is_empty() => Err(CaptureError::not_a_log(self.path, "it is empty")),
            None if starts(b"PAR1") => Ok(Form::Parquet),
            None if starts(b"ARROW1") => Ok(Form::ArrowFile),
            None if starts(b"\x93NUMPY") => Ok(Form::Npy),
            None if starts(b"\x89MCAP0\r\n") => Ok(Form::Mcap),
            None if starts(b"SQLite format 3\0") => Ok(Form::Sqlite),
            None => Ok(Form::Other),
        }
    }

    /// The file that holds the content, unpacked.
    pub fn stands_in(&self) -> &Path {
        self.unpacked.as_ref().map_or(self.path, Temporary::path)
    }
}

/// Files that people have, and what to do with them.
const FOREIGN: &[(&[u8], &str)] = &[
    (
        b"#ROSBAG V",
        "it is a bag of ROS 1; convert it with `rosbags-convert --src FILE --dst FOLDER`, or with `mcap convert`",
    ),
    (b"PK\x03\x04", "it is a zip or .npz archive; unpack it and name a file in it"),
    (b"\x89HDF\r\n\x1A\n", "it is an HDF5 file; export the column as .npy, Parquet or CSV"),
    (b"MATLAB 5.0 MAT", "it is a MATLAB file; export the column as .npy, Parquet or CSV"),
    (b"ULog\x01\x12\x35", "it is a PX4 log; convert it with `ulog2csv`"),
    (b"BZh", "it is packed by bzip2; unpack it"),
    (b"\x04\x22\x4D\x18", "it is packed by lz4; unpack it"),
    (b"7z\xBC\xAF\x27\x1C", "it is a 7z archive; unpack it and name a file in it"),
];

/// How a file is packed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Packing {
    Gzip,
    Xz,
    Zstd,
}

impl Packing {
    fn of(start: &[u8]) -> Option<Self> {
        match start {
            [0x1F, 0x8B, 8, flags, ..] if *flags < 0x20 => Some(Self::Gzip),
            [0xFD, b'7', b'z', b'X', b'Z', 0, ..] => Some(Self::Xz),
            [0x28, 0xB5, 0x2F, 0xFD, ..] => Some(Self::Zstd),
            _ => None,
        }
    }

    /// Unpacks into a file, because some forms are not read from start to end.
    fn unpack(self, packed: &mut File) -> io::Result<Temporary> {
        let packed = BufReader::with_capacity(BUFFER, packed);
        let mut content: Box<dyn Read + '_> = match self {
            Self::Gzip => Box::new(MultiGzDecoder::new(packed)),
            Self::Xz => Box::new(XzReader::new(packed, true)),
            Self::Zstd => Box::new(zstd::Decoder::with_buffer(packed)?),
        };
        let unpacked = Temporary::in_passing()?;
        let mut out = BufWriter::with_capacity(BUFFER, unpacked.file());
        io::copy(&mut content, &mut out)?;
        out.flush()?;
        drop(out);
        Ok(unpacked)
    }
}

/// A file and how it starts.
fn marked(mut file: File) -> io::Result<(File, Vec<u8>)> {
    let mut start = Vec::new();
    (&mut file).take(MARK).read_to_end(&mut start)?;
    file.rewind()?;
    Ok((file, start))
}

/// Reads an Arrow file, batch by batch.
struct ArrowFile {
    path: PathBuf,
    reader: FileReader<BufReader<File>>,
}

/// An Arrow file as a table.
pub fn arrow_file(path: &Path, file: File) -> Result<Box<dyn BatchSource>, CaptureError> {
    let reader = guarded(path, || FileReader::try_new(BufReader::with_capacity(BUFFER, file), None))?;
    Ok(Box::new(ArrowFile { path: path.to_owned(), reader }))
}

impl Iterator for ArrowFile {
    type Item = Result<RecordBatch, CaptureError>;

    fn next(&mut self) -> Option<Self::Item> {
        guarded(&self.path, || self.reader.next().transpose()).transpose()
    }
}

impl BatchSource for ArrowFile {
    fn schema(&self) -> SchemaRef {
        self.reader.schema()
    }

    fn warning(&self) -> Option<&str> {
        None
    }
}

/// The Arrow library takes for granted that offsets are right, and panics where they are not.
fn guarded<T>(path: &Path, read: impl FnOnce() -> Result<T, ArrowError>) -> Result<T, CaptureError> {
    let reason = match panic::catch_unwind(AssertUnwindSafe(read)) {
        Ok(Ok(value)) => return Ok(value),
        Ok(Err(error)) => error.to_string(),
        Err(_) => "its batches cannot be decoded".to_owned(),
    };
    Err(CaptureError::damaged(path, "as an Arrow file", reason))
}
