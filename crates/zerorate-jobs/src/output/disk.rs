//! File locks, unfinished files and syncing: lets several processes write to one folder safely.

use super::OutputError;
use super::temporary::Temporary;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// The ending of every unfinished file's name. No other files have it, so a run can find what killed runs left.
const ENDING: &str = ".zerorate.part";

/// Number of random characters between the file's name and the ending.
const RANDOM: usize = 6;

/// The name of an unfinished file begins with at most this many characters of the final name, so that it does not
/// become too long for the file system.
const LONGEST_STEM: usize = 100;

/// Number of attempts to lock a folder, which others lock for microseconds, and of retries to create a file in it.
const TURN_TRIES: u32 = 200;
const TURN_PAUSE: Duration = Duration::from_millis(5);

/// Creates an unfinished file for `name`, under a new name. Where files can be locked, nobody else can claim `name` as
/// long as that file is open. Also removes the unfinished files that killed processes left in the folder.
pub fn claim(path: &Path, folder: &Path, name: &OsStr) -> Result<Temporary, OutputError> {
    let _turn = turn_in(folder);
    let stem = stem(name);
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let name = entry.file_name().to_string_lossy().into_owned();
        let Some(start) = name.strip_suffix(ENDING) else { continue };
        let is_rival = start.strip_prefix(&stem).is_some_and(|random| random.len() == RANDOM);
        match owner(&entry.path()) {
            Owner::Alive if is_rival => return Err(OutputError::Busy { path: path.to_owned() }),
            // a file that this user may not remove stays
            Owner::Dead => drop(fs::remove_file(entry.path())),
            Owner::Alive | Owner::Unknown => {}
        }
    }
    create(folder, &stem).map_err(|error| OutputError::io("write", path, error))
}

/// Creates another unfinished file for a name that this run has claimed already.
pub fn unfinished(folder: &Path, name: &OsStr) -> io::Result<Temporary> {
    create(folder, &stem(name))
}

fn stem(name: &OsStr) -> String {
    format!("{}.", name.to_string_lossy().chars().take(LONGEST_STEM).collect::<String>())
}

/// Creates a file and locks it. Tries again if another process took the unlocked file for a leftover and removed it.
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

enum Owner {
    Alive,
    Dead,
    /// Unknown, for example because the file system has no locks, or the path is not a regular file.
    Unknown,
}

/// Finds out whether the process that made the file still runs. The kernel releases the lock of a process that ends.
fn owner(path: &Path) -> Owner {
    let Ok(file) = open_to_lock(path) else { return Owner::Unknown };
    if cfg!(not(unix)) || !file.metadata().is_ok_and(|metadata| metadata.is_file()) {
        return Owner::Unknown;
    }
    match file.try_lock() {
        Ok(()) => Owner::Dead,
        Err(TryLockError::WouldBlock) => Owner::Alive,
        Err(TryLockError::Error(_)) => Owner::Unknown,
    }
}

/// True if a running process records into the file. False where that is not known, as without locks.
#[must_use]
pub fn is_being_recorded(path: &Path) -> bool {
    path.canonicalize().is_ok_and(|file| matches!(owner(&file), Owner::Alive))
}

/// Syncs the names in a folder to the disk, if the file system supports that.
pub fn sync_folder(folder: &Path) -> io::Result<()> {
    if cfg!(not(unix)) {
        return Ok(());
    }
    match File::open(folder)?.sync_all() {
        Err(error) if matches!(error.kind(), ErrorKind::InvalidInput | ErrorKind::Unsupported) => Ok(()),
        synced => synced,
    }
}

/// Locks a folder until the returned file is dropped. Returns `None` if the folder cannot be opened or stays locked by
/// others. Then, and where there are no locks, only the exclusive creation of names protects the files.
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

/// Locks an open file until it is closed. Returns `WouldBlock` if it is locked already, also by this process. Does
/// nothing on systems other than Unix, where a lock would also block readers.
pub fn lock(file: &File) -> io::Result<()> {
    if cfg!(not(unix)) {
        return Ok(());
    }
    match file.try_lock() {
        Err(TryLockError::WouldBlock) => Err(ErrorKind::WouldBlock.into()),
        // other errors come from file systems without locks, where the file is used unlocked
        _ => Ok(()),
    }
}

static OPENS_STREAM: AtomicBool = AtomicBool::new(false);

/// True while the program opens a pipe or a device to write to it. Opening a pipe waits for its reader, and cannot
/// check for a stop.
#[must_use]
pub fn opens_stream() -> bool {
    OPENS_STREAM.load(Ordering::Relaxed)
}

/// Opens a pipe or a device to write to it.
pub fn open_stream(path: &Path) -> io::Result<File> {
    OPENS_STREAM.store(true, Ordering::Relaxed);
    let opened = OpenOptions::new().write(true).open(path);
    OPENS_STREAM.store(false, Ordering::Relaxed);
    opened
}

/// Opens a file without following a link or blocking on a pipe.
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
