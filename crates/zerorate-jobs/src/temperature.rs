//! The temperature of a log: which of its columns it is.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;
use zerorate_host::files;
use zerorate_logs::{Column, ColumnOptions, TEMPERATURE_NAMES, Wanted};

/// Bytes at both ends of a file in which columns name themselves.
const ENDS: u64 = 1 << 16;

/// The temperature of the log at `path`: the column `name`, or one by the usual names; none where there is none.
#[must_use]
pub fn of_log(path: &Path, name: Option<&str>, options: &ColumnOptions) -> Option<Column> {
    let read = |names: &[&str]| named(path, names, options);
    match name {
        Some(name) => read(&[name]),
        None => usual(path, read),
    }
}

/// The temperature of a log, by one of these names.
pub fn named(path: &Path, names: &[&str], options: &ColumnOptions) -> Option<Column> {
    let read = |name: &&str| {
        let wanted = [(*name).to_owned()];
        zerorate_logs::read_parts(path, files::log(path).ok()?, Wanted::Listed(&wanted), options).ok()?.pop()
    };
    names.iter().find_map(read)
}

/// The temperature of a log by the usual names, where the log seems to have one.
pub fn usual(file: &Path, read: impl Fn(&[&str]) -> Option<Column>) -> Option<Column> {
    if speaks_of_temperature(file) { read(&TEMPERATURE_NAMES) } else { None }
}

/// Whether a file names something like a temperature near its beginning or its end, so that a second look is worth it.
/// What is piped in is not read twice.
fn speaks_of_temperature(file: &Path) -> bool {
    let ends = || -> std::io::Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let mut file = File::open(file)?;
        let len = file.metadata()?.len();
        file.by_ref().take(ENDS).read_to_end(&mut bytes)?;
        if len > 2 * ENDS {
            file.seek(SeekFrom::Start(len - ENDS))?;
            file.take(ENDS).read_to_end(&mut bytes)?;
        }
        Ok(bytes)
    };
    ends().is_ok_and(|bytes| bytes.windows(4).any(|word| word.eq_ignore_ascii_case(b"temp")))
}
