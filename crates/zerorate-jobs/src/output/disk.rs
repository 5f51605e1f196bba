//! Onto the disk, and turns among processes.

use super::OutputError;
use super::temporary::Temporary;
use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::time::Duration;

/// The ending of the name of every unfinished file. Nothing else makes such names, so the files of a killed run are
/// known by it.
const ENDING: &str = ".zerorate.part";

/// Characters between the name of the file and the ending, which differ from one unfinished file to the next.
const RANDOM: usize = 6;

/// The longest part of a name that an unfinished file repeats, so that a long name does not become too long.
const LONGEST_STEM: usize = 100;

/// A wait for another process that claims a file in the same folder; it takes microseconds.
const TURN_TRIES: u32 = 200;
const TURN_PAUSE: Duration = Duration::from_millis(5);

/// Makes an unfinished file beside `name`, under a name that nothing has. One process at a time has one for the same
/// name. Files that killed processes left in the folder are removed.
pub fn claim(path: &Path, folder: &Path, name: &OsStr) -> Result<Temporary, OutputError> {
    let _turn = turn_in(folder);
    let stem = stem(name);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(start) = name.strip_suffix(ENDING) else { continue };
        let is_rival = start.strip_prefix(&stem).is_some_and(|random| random.len() == RANDOM);
        match owner(&entry.path()) {
            Owner::Alive if is_rival => return Err(OutputError::Busy { path: path.to_owned() }),
            // a user who may not remove the file leaves it
            Owner::Dead => drop(fs::remove_file(entry.path())),
            Owner::Alive | Owner::Unknown => {}
        }
    }
    create(folder, &stem).map_err(|error| OutputError::io("write", path, error))
}

/// Makes another unfinished file, for a name that is claimed already.
pub fn unfinished(folder: &Path, name: &OsStr) -> io::Result<Temporary> {
    create(folder, &stem(name))
}

fn stem(name: &OsStr) -> String {
    format!("{}.", name.to_string_lossy().chars().take(LONGEST_STEM).collect::<String>())
}

/// A new file, locked. Before it is, another process may take it for one that was left, and remove it.
fn create(folder: &Path, stem: &str) -> io::Result<Temporary> {
    let mut tries = TURN_TRIES;
    loop {
        let new = Temporary::for_keeps(folder, stem, ENDING, RANDOM)?;
        let locked = lock(new.file());
        let is_there = new.path().symlink_metadata().is_ok();
        match locked {
            Ok(()) if is_there => return Ok(new),
            Err(error) if error.kind() != ErrorKind::WouldBlock || tries == 0 => return Err(error),
            _ if tries == 0 => return Err(ErrorKind::NotFound.into()),
            _ => tries -= 1,
        }
    }
}

/// The state of the process that made an unfinished file.
enum Owner {
    Alive,
    Dead,
    /// The file system has no locks, or it is not a file.
    Unknown,
}

/// The kernel holds the lock of a file for as long as its process lives.
#[cfg(unix)]
fn owner(path: &Path) -> Owner {
    use rustix::fs::{FlockOperation, flock};
    let Ok(file) = open_to_lock(path) else { return Owner::Unknown };
    if !file.metadata().is_ok_and(|metadata| metadata.is_file()) {
        return Owner::Unknown;
    }
    match flock(&file, FlockOperation::NonBlockingLockExclusive) {
        Ok(()) => Owner::Dead,
        Err(rustix::io::Errno::WOULDBLOCK) => Owner::Alive,
        Err(_) => Owner::Unknown,
    }
}

#[cfg(not(unix))]
fn owner(_: &Path) -> Owner {
    Owner::Unknown
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

/// Does nothing on other systems, where a lock would keep readers out too.
#[cfg(not(unix))]
pub fn lock(_: &File) -> io::Result<()> {
    Ok(())
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
