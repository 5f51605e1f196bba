//! A file that is recorded into: under its final name from the start, onto the disk once a second, by one writer.

use super::OutputError;
use super::disk::{claim, lock, open_to_lock, sync_folder};
use super::identity::Identity;
use super::place::Place;
use std::ffi::OsStr;
use std::fs::{File, OpenOptions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Time between two requests to put the file onto the disk.
const SYNC_EVERY: Duration = Duration::from_secs(1);

/// A file to record into. It is locked until it and its clones are closed, so that no other run records into it.
#[derive(Debug)]
pub struct Recording {
    path: PathBuf,
    file: File,
    sync: Option<BackgroundSync>,
}

impl Recording {
    /// Opens `place`, which `path` has led to.
    pub(super) fn new(path: &Path, place: Place) -> Result<Self, OutputError> {
        let failed = |error| OutputError::io("write", path, error);
        let (file, sync) = match place {
            Place::Stream { path: stream, .. } => (OpenOptions::new().write(true).open(stream).map_err(failed)?, None),
            Place::Name { folder, name, replaces } => {
                let file = match replaces {
                    None => create(path, &folder.join(&name))?,
                    Some(old) => replace(path, &folder, &name, &old)?,
                };
                file.sync_all().and_then(|()| sync_folder(&folder)).map_err(failed)?;
                let sync = BackgroundSync::of(&file).map_err(failed)?;
                (file, Some(sync))
            }
        };
        Ok(Self { path: path.to_owned(), file, sync })
    }

    /// The name that was asked for.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// To write to.
    ///
    /// # Errors
    /// The process has too many files open.
    pub fn file(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Everything was written: puts it onto the disk.
    ///
    /// # Errors
    /// Data did not get there, now or before.
    pub fn finish(self) -> io::Result<()> {
        let Some(sync) = self.sync else { return Ok(()) };
        sync.finish()?;
        self.file.sync_all()
    }
}

fn create(path: &Path, target: &Path) -> Result<File, OutputError> {
    let file = OpenOptions::new().write(true).create_new(true).open(target).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => OutputError::Exists { path: path.to_owned(), has_force: false },
        _ => OutputError::io("write", path, error),
    })?;
    lock(&file).map_err(|_| busy(path))?;
    Ok(file)
}

/// A new file in place of the old one, which hard links may still name. The old one's lock keeps two runs from doing
/// so at once.
fn replace(path: &Path, folder: &Path, name: &OsStr, old: &Identity) -> Result<File, OutputError> {
    let failed = |error| OutputError::io("write", path, error);
    let target = folder.join(name);
    let held = open_to_lock(&target).map_err(failed)?;
    lock(&held).map_err(|_| busy(path))?;
    if Identity::of_open(&held, &target).as_ref() != Some(old) || Identity::of_file(&target).as_ref() != Some(old) {
        return Err(busy(path));
    }
    claim(path, folder, name)?.replace(&target).map_err(failed)
}

fn busy(path: &Path) -> OutputError {
    OutputError::Busy { path: path.to_owned() }
}

/// Asks for `fdatasync` once a second in a thread of its own: a slow disk must not keep the part waiting.
#[derive(Debug)]
struct BackgroundSync {
    stop: Sender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl BackgroundSync {
    fn of(file: &File) -> io::Result<Self> {
        let file = file.try_clone()?;
        let (stop, stopped) = mpsc::channel();
        let thread = thread::Builder::new().name("capture-sync".to_owned()).spawn(move || {
            while stopped.recv_timeout(SYNC_EVERY) == Err(RecvTimeoutError::Timeout) {
                file.sync_data()?;
            }
            Ok(())
        })?;
        Ok(Self { stop, thread })
    }

    /// Ends, and says whether one of the requests failed.
    fn finish(self) -> io::Result<()> {
        drop(self.stop);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the syncing thread died")))
    }
}
