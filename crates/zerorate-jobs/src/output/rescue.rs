//! A last place for a result that cannot be written where it should be.

use super::disk::sync_folder;
use super::place::folder_of;
use super::temporary::Temporary;
use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Random characters that make the name unique.
const RANDOM: usize = 6;

/// Writes `content` beside the first of `wanted` where that is possible, or else to the folder for temporary files,
/// under a free name like `name`. Returns where it is; none if no place takes it.
pub fn rescue(name: &Path, wanted: &[&Path], content: &[u8]) -> Option<PathBuf> {
    // a device has no room for files beside it
    let beside = wanted.iter().filter(|path| !path.exists() || path.is_file()).map(|path| folder_of(path).to_owned());
    beside.chain([std::env::temp_dir()]).find_map(|folder| write(&folder, name, content).ok())
}

fn write(folder: &Path, name: &Path, content: &[u8]) -> io::Result<PathBuf> {
    let part = |part: Option<&OsStr>| part.map(|part| part.to_string_lossy().into_owned());
    let start = format!("{}.rescue-", part(name.file_stem()).unwrap_or_else(|| "result".to_owned()));
    let end = part(name.extension()).map_or_else(String::new, |ending| format!(".{ending}"));
    let file = Temporary::for_keeps(folder, &start, &end, RANDOM)?;
    let mut open = file.file();
    open.write_all(content)?;
    open.sync_all()?;
    let path = file.keep()?;
    sync_folder(folder)?;
    // without a `.` in its middle, which a name without a folder leaves
    Ok(path.components().collect())
}
