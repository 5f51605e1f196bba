//! Saves a result that cannot be written to its requested file.

use super::disk::sync_folder;
use super::place::folder_of;
use super::temporary::Temporary;
use std::ffi::OsStr;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Number of random characters that make the name unique.
const RANDOM: usize = 6;

/// Writes `content` to a new file beside one of `wanted`, or else in the folder for temporary files. The file has the
/// name `name` with `.rescue-` and random characters added. Returns its path, or `None` if no folder could be written.
pub fn rescue(name: &Path, wanted: &[&Path], content: &[u8]) -> Option<PathBuf> {
    // no file is put beside a device, such as /dev/null
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
    // drops the `.` component that joining `.` and a name leaves
    Ok(path.components().collect())
}
