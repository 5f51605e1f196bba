//! Reads NumPy arrays in a zip archive (`.npz`). Each member carries a checksum (CRC-32), and the index at the end
//! repeats the header of each member.

use super::npy::{self, Array};
use super::open::{BUFFER, Log, Unpacking};
use crate::error::Result;
use crate::query::ColumnQuery;
use crate::raw_columns::RawColumns;
use std::io::{self, BufReader, Read};
use std::path::Path;
use zerorate_input::catch_panic::catch_panic;
use zerorate_input::limits::MemoryBudget;
use zerorate_input::{Input, InputError};
use zip::ZipArchive;
use zip::result::{ZipError, ZipResult};

/// Largest number of columns of all arrays together.
const MAX_COLUMNS: usize = 1 << 16;

/// Reads columns of the arrays of an archive, named after their arrays.
pub fn read(log: Log<'_>, asked: &ColumnQuery<'_>) -> Result<RawColumns> {
    let Log { path, input, room, .. } = log;
    let again = input.try_clone().map_err(|error| InputError::io("read", path, error))?;
    let (archive, names) = open(path, input)?;
    let mut archive = Archive { path, archive, room, bytes: 0 };
    let mut arrays = Vec::new();
    let mut columns = 0;
    for name in &names {
        let array = archive.header(name)?;
        columns += array.columns();
        if columns > MAX_COLUMNS {
            let why = format!("its arrays have more than {MAX_COLUMNS} columns; save only the arrays of the log");
            return Err(InputError::not_a_log(path, why).into());
        }
        arrays.push(array);
    }
    npy::read_arrays(path, room, &arrays, asked, |at, is_wanted| {
        let name = &names[at];
        if is_wanted {
            let unpacked = again.unpacked(|out| archive.unpack(name, out));
            return unpacked.map(Some).map_err(|why| why.in_file(path, &place(name)));
        }
        // unpacked only to verify its checksum: a damaged array might have been a column
        archive.unpack(name, &mut io::sink()).map(|()| None).map_err(|why| why.in_file(path, &place(name)))
    })
}

fn place(name: &str) -> String {
    format!("array {name}")
}

/// The archive, and the names of its arrays.
fn open(path: &Path, input: Input) -> Result<(ZipArchive<BufReader<Input>>, Vec<String>), InputError> {
    let damaged = |what: String| InputError::damaged(path, "as an archive", what);
    let opened = catch_panic(|| -> ZipResult<_> {
        let archive = ZipArchive::new(BufReader::with_capacity(BUFFER, input))?;
        let names = archive.file_names().map(|name| Ok(name?.into_owned())).collect::<ZipResult<Vec<_>>>()?;
        Ok((archive, names))
    });
    let opened = opened.ok_or_else(|| damaged("its index makes no sense".to_owned()))?;
    let (mut archive, names) = opened.map_err(|error| damaged(error.to_string()))?;
    if archive.offset() > 0 {
        let what = format!("two archives were joined: another one follows after its first {} bytes", archive.offset());
        return Err(damaged(what + "; cut it there"));
    }
    let (names, others): (Vec<String>, Vec<String>) = names.into_iter().partition(|name| name.ends_with(".npy"));
    if names.is_empty() {
        let why = match others.iter().any(|name| name == "xl/workbook.xml") {
            true => "it is a workbook of Excel; save the sheet as CSV",
            false => "it is a zip archive without arrays of NumPy; unpack it and name a file in it",
        };
        return Err(InputError::not_a_log(path, why));
    }
    let consistent = catch_panic(|| archive.validate_header_consistency());
    let consistent = consistent.unwrap_or(Err(ZipError::InvalidArchive("its index makes no sense".into())));
    consistent.map_err(|error| damaged(error.to_string()))?;
    Ok((archive, names))
}

struct Archive<'a> {
    path: &'a Path,
    archive: ZipArchive<BufReader<Input>>,
    room: MemoryBudget,
    /// Number of bytes that were unpacked so far.
    bytes: u64,
}

impl Archive<'_> {
    fn header(&mut self, name: &str) -> Result<Array, InputError> {
        let Self { path, archive, .. } = self;
        let senseless = || InputError::damaged(path, place(name), "its content makes no sense");
        let read = catch_panic(|| {
            let mut file =
                archive.by_name(name).map_err(|error| InputError::damaged(path, place(name), error.to_string()))?;
            let length = file.size();
            Array::new(path, &mut file, length, name.trim_end_matches(".npy"))
        });
        read.ok_or_else(senseless)?
    }

    /// Unpacks an array, and verifies its checksum.
    fn unpack(&mut self, name: &str, out: &mut dyn io::Write) -> Result<(), Unpacking> {
        let Self { archive, room, bytes, .. } = self;
        let copied = catch_panic(|| {
            let file = archive.by_name(name).map_err(io::Error::other)?;
            io::copy(&mut file.take(room.bytes_on_disk().saturating_sub(*bytes).saturating_add(1)), out)
        });
        *bytes += copied.unwrap_or_else(|| Err(io::Error::other("its content makes no sense")))?;
        room.check_on_disk(*bytes).map_err(Unpacking::OverBudget)
    }
}
