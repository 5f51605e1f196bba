//! Onto the disk, and turns among processes.

use super::OutputError;
use super::temporary::Temporary;
use std::ffi::OsStr;
use std::fs::{self, DirEntry, File};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::time::Duration;

/// What the name of every unfinished file ends in.
const ENDING: &str = ".part";

/// The longest part of a name that an unfinished file repeats, so that a long name does not become too long.
const LONGEST_STEM: usize = 100;

/// A wait for another process that claims a file in the same folder; it takes microseconds.
const TURN_TRIES: u32 = 200;
const TURN_PAUSE: Duration = Duration::from_millis(5);

/// Makes an unfinished file beside `name`, under a name that nothing has. One process at a time has one for the same
/// name.
pub fn claim(path: &Path, folder: &Path, name: &OsStr) -> Result<Temporary, OutputError> {
    let failed = |error| OutputError::io("write", path, error);
    let name = name.to_string_lossy();
    let stem = format!("{}.", name.chars().take(LONGEST_STEM).collect::<String>());
    let _turn = turn_in(folder);
    let is_unfinished = |entry: &DirEntry| {
        let name = entry.file_name().to_string_lossy().into_owned();
        name.starts_with(&stem) && name.ends_with(ENDING)
    };
    let siblings = fs::read_dir(folder).into_iter().flatten().flatten();
    if siblings.filter(is_unfinished).any(|entry| is_locked(&entry.path())) {
        return Err(OutputError::Busy { path: path.to_owned() });
    }
    let temporary = Temporary::for_keeps(folder, &stem, ENDING).map_err(failed)?;
    lock(temporary.file()).map_err(failed)?;
    Ok(temporary)
}

/// Puts the names in a folder onto the disk. Not every file system has a way to ask for it.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(not(unix)) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        synced => synced,
    }
}

/// The lock of a folder, for as long as it takes to look for other writers and to become one. Where it cannot be had,
/// exclusive names remain.
fn turn_in(folder: &Path) -> Option<File> {
    let folder = File::open(folder).ok()?;
    for _ in 0..TURN_TRIES {
        if lock(&folder).is_ok() {
            return Some(folder);
        }
        std::thread::sleep(TURN_PAUSE);
    }
    None
}

/// Marks an open file as being written, until it is closed. `WouldBlock`: another process has.
#[cfg(unix)]
pub fn lock(file: &File) -> io::Result<()> {
    use rustix::fs::{FlockOperation, flock};
    match flock(file, FlockOperation::NonBlockingLockExclusive) {
        Err(error) if error == rustix::io::Errno::WOULDBLOCK => Err(ErrorKind::WouldBlock.into()),
        // a network file system without locks
        _ => Ok(()),
    }
}

/// There, the lock would keep readers out too.
#[cfg(not(unix))]
pub fn lock(_: &File) -> io::Result<()> {
    Ok(())
}

fn is_locked(path: &Path) -> bool {
    open_to_lock(path).is_ok_and(|file| lock(&file).is_err())
}

/// Opens a file without following a link or waiting for a pipe.
#[cfg(unix)]
pub fn open_to_lock(path: &Path) -> io::Result<File> {
    use rustix::fs::{Mode, OFlags, open};
    let flags = OFlags::RDONLY | OFlags::NOFOLLOW | OFlags::NONBLOCK | OFlags::CLOEXEC;
    Ok(open(path, flags, Mode::empty())?.into())
}

#[cfg(not(unix))]
pub fn open_to_lock(path: &Path) -> io::Result<File> {
    File::open(path)
}
