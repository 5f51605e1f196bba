//! Captures and logs on disk.

use std::fs::File;
use std::io::{Read, Seek};
use std::path::{Path, PathBuf};
use zerorate::Part;
use zerorate_data::capture::CaptureReader;
use zerorate_data::column::ColumnOptions;
use zerorate_data::{CaptureError, Input, LogError, RowReader};

/// Opens a file to be read.
///
/// # Errors
/// Why that cannot be.
pub fn open(path: &Path) -> Result<Input, CaptureError> {
    let file = File::open(path).map_err(|error| CaptureError::io("read", path, error))?;
    Ok(file.into())
}

/// What stands for standard input among the names of logs.
const STDIN: &str = "-";

/// Opens a log: a file, what is piped into the program (`-`), or the folder of a bag of ROS 2, which has several files.
/// Each comes with its name.
///
/// # Errors
/// Why that cannot be.
pub fn log(path: &Path) -> Result<Vec<(PathBuf, Input)>, CaptureError> {
    let failed = |error| CaptureError::io("read", path, error);
    if path == Path::new(STDIN) {
        return Ok(vec![(path.to_owned(), spooled(std::io::stdin().lock()).map_err(failed)?)]);
    }
    if !path.is_dir() {
        return Ok(vec![(path.to_owned(), open(path)?)]);
    }
    parts(path)?.into_iter().map(|part| Ok((part.clone(), open(&part)?))).collect()
}

/// How many bytes a log has on disk; what is piped in may have any number.
pub fn log_length(path: &Path) -> u64 {
    let length = |path: &Path| path.metadata().map_or(0, |metadata| metadata.len());
    match path {
        _ if path == Path::new(STDIN) => u64::MAX,
        _ if path.is_dir() => parts(path).iter().flatten().map(|part| length(part)).fold(0, u64::saturating_add),
        _ => length(path),
    }
}

/// What was piped in, in a file without a name: several forms are not read from start to end.
fn spooled(mut piped: impl Read) -> std::io::Result<Input> {
    let mut file = tempfile::tempfile()?;
    std::io::copy(&mut piped, &mut file)?;
    file.rewind()?;
    Ok(Input::nameless(file))
}

/// The files of a bag of ROS 2, in their order: those that end in .mcap or .db3, packed or not, with their numbers at the
/// end of their names (`bag_0.mcap`, `bag_1.mcap`).
fn parts(folder: &Path) -> Result<Vec<PathBuf>, CaptureError> {
    let failed = |error| CaptureError::io("read", folder, error);
    let all = folder.read_dir().map_err(failed)?.map(|entry| Ok(entry?.path()));
    let all: Vec<PathBuf> = all.collect::<std::io::Result<_>>().map_err(failed)?;
    let ends =
        |path: &Path, end: &str| path.to_str().is_some_and(|name| name.trim_end_matches(".zstd").ends_with(end));
    let of_kind = |end: &str| all.iter().filter(|path| ends(path, end)).cloned().collect::<Vec<_>>();
    let mut found = of_kind(".mcap");
    if found.is_empty() {
        found = of_kind(".db3");
    }
    if found.is_empty() {
        let why = "it is a directory and no bag of ROS 2 (it has no .mcap and no .db3 file); name the file";
        return Err(CaptureError::not_a_log(folder, why));
    }
    found.sort_by_key(|path| (number(path), path.clone()));
    Ok(found)
}

/// The number at the end of a file's name, without what stands behind its first point.
fn number(path: &Path) -> Option<u64> {
    let name = path.file_name()?.to_str()?.split('.').next()?;
    name.rsplit('_').next()?.parse().ok()
}

/// Opens a capture, in any of its forms.
///
/// # Errors
/// Why that cannot be, or what is wrong with its description.
pub fn capture(path: &Path) -> Result<CaptureReader, CaptureError> {
    CaptureReader::open(path, open(path)?)
}

/// Opens a capture, or a log of the part that is given (docs/formats/part.md).
///
/// # Errors
/// Why that cannot be, or what is wrong with it.
pub fn rows(path: &Path, part: Option<&Part>) -> Result<RowReader, LogError> {
    RowReader::open(path, open(path)?, part, &ColumnOptions::default())
}
