//! The file formats of logs: the marks at the start of each, and its reader.

use crate::arrow_file::ArrowFile;
use crate::error::Result;
use crate::open::{self, Log};
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
use crate::{dataflash, tabular, ulog};
use Content::{DescribedTable, Messages, Table};
use std::path::Path;
use zerorate_input::{Input, InputError, NotBuiltIn};

/// A file format with a reader of its own. Any other file is an Arrow stream, text or raw numbers.
pub struct Form {
    /// The marks at the start of a file. One of them suffices.
    marks: &'static [&'static [u8]],
    pub words: &'static str,
    pub content: Content,
    /// The reader of the format, or the feature that adds it.
    pub reader: Result<Reader, NotBuiltIn>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// Arrays or messages. Their rows cannot be selected by the values of columns.
    Messages,
    /// A table with named columns.
    Table,
    /// A table that may describe itself. If so, it is opened as a whole.
    DescribedTable,
}

type Reader = fn(Log<'_>, &ColumnQuery<'_>) -> Result<RawColumns>;

/// The reader of a format that a feature adds.
macro_rules! reader {
    ($feature:tt, $what:literal, $($reader:tt)*) => {{
        #[cfg(feature = $feature)]
        let reader: Result<Reader, NotBuiltIn> = Ok(crate::$($reader)*);
        #[cfg(not(feature = $feature))]
        let reader: Result<Reader, NotBuiltIn> = Err(NotBuiltIn { what: $what, feature: $feature });
        reader
    }};
}

const fn form(
    marks: &'static [&'static [u8]],
    words: &'static str,
    content: Content,
    reader: Result<Reader, NotBuiltIn>,
) -> Form {
    Form { marks, words, content, reader }
}

static FORMS: [Form; 11] = [
    form(&[b"PAR1"], "Parquet", DescribedTable, reader!("parquet", "Parquet", parquet::read)),
    form(&[b"ARROW1"], "Arrow file (Feather)", Table, Ok(read_arrow_file)),
    form(&[b"\x93NUMPY"], "NumPy array (.npy)", Messages, reader!("numpy", "the reader of NumPy arrays", npy::read)),
    form(&[b"PK\x03\x04"], "NumPy arrays (.npz)", Messages, reader!("npz", "the reader of .npz archives", npz::read)),
    form(&[b"\x89MCAP0\r\n"], "MCAP", Messages, reader!("mcap", "MCAP", mcap_bag::read)),
    form(&[open::ROS_BAG], "bag of ROS 1", Messages, reader!("ros", "the reader of ROS 1 bags", rosbag::read)),
    form(&[open::ULOG], "log of PX4 (ULog)", Messages, Ok(ulog::read)),
    form(&[&open::ARDUPILOT], "log of ArduPilot (DataFlash)", Messages, Ok(dataflash::read)),
    form(&[open::MATLAB], "MATLAB 5 to 7.2", Messages, reader!("matlab", "the reader of MATLAB files", mat::read)),
    form(&HDF5, "HDF5, as MATLAB 7.3 writes it", Messages, reader!("hdf5", "HDF5", hdf5::read)),
    form(
        &[b"SQLite format 3\0"],
        "SQLite bag of ROS 2",
        Messages,
        reader!("sqlite", "SQLite, in which older ROS 2 bags lie", sqlite_bag::read),
    ),
];

/// From version 7.3 on, MATLAB writes HDF5 behind a header of its own.
const HDF5: [&[u8]; 2] = [b"\x89HDF\r\n\x1A\n", b"MATLAB 7.3 MAT"];

impl Form {
    /// Recognises the format of a log. The error for a file of an unsupported format says what to do.
    pub fn of(log: &Log<'_>) -> Result<Option<&'static Self>, InputError> {
        log.check()?;
        Ok(FORMS.iter().find(|form| form.marks.iter().any(|mark| log.start.starts_with(mark))))
    }
}

/// The format of a file in words, recognised by its start; `path` names the file in messages.
///
/// # Errors
/// Returns an error if the file cannot be read, is empty, or is of a known format that is not supported.
pub fn kind(path: &Path, input: Input) -> Result<String, InputError> {
    let log = open::looked_at(path, input)?;
    match open::packing(&log.start) {
        Some(packing) => Ok(packing),
        None if log.start.starts_with(&ARROW_STREAM) => Ok("Arrow stream".to_owned()),
        None => Ok(Form::of(&log)?.map_or("text", |form| form.words).to_owned()),
    }
}

/// The mark before each message of an Arrow stream.
const ARROW_STREAM: [u8; 4] = [0xFF; 4];

fn read_arrow_file(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let source = ArrowFile::open(log.path, log.input, log.room)?;
    tabular::read(log.path, Box::new(source), log.room, asked)
}
