//! An output file that is recorded into. The file has its final name from the start, and only one writer. A thread
//! checks four times a second that the file still exists, and syncs the file once a second.

use super::OutputError;
use super::disk::{claim, lock, open_stream, open_to_lock, sync_folder};
use super::identity::Identity;
use super::place::Place;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{self, RecvTimeoutError, Sender};
use std::thread::{self, JoinHandle};
use std::time::Duration;

/// Time between the checks of the file.
const LOOK_EVERY: Duration = Duration::from_millis(250);

/// Number of checks per sync of the file: one sync a second.
const LOOKS_PER_SYNC: u32 = 4;

/// A file to record into. It stays locked until all its handles are closed, so that no other run can record into it.
#[derive(Debug)]
pub struct Recording {
    path: PathBuf,
    file: File,
    written: Arc<AtomicU64>,
    /// The file and its checks. `None` for a pipe or a device, which cannot be removed or replaced.
    recorded: Option<Arc<RecordedFile>>,
    /// The checking thread. `None` for a pipe or a device, and after the thread has failed.
    watch: Option<Watch>,
}

impl Recording {
    /// Opens the file at `place`. `path` is the path that the user gave, for error messages.
    pub(super) fn new(path: &Path, place: Place) -> Result<Self, OutputError> {
        let failed = |error| OutputError::io("write", path, error);
        let written = Arc::default();
        let (file, target) = match place {
            Place::Stream { path: stream, .. } => (open_stream(&stream).map_err(failed)?, None),
            Place::Name { folder, name, replaces } => {
                let target = folder.join(&name);
                let file = match replaces {
                    None => create(path, &target)?,
                    Some(old) => replace(path, &folder, &name, &old)?,
                };
                file.sync_all().and_then(|()| sync_folder(&folder)).map_err(failed)?;
                (file, Some(target))
            }
        };
        let recorded = target.map(|target| {
            let file = file.try_clone().map_err(failed)?;
            Ok(Arc::new(RecordedFile { target, file, written: Arc::clone(&written) }))
        });
        let recorded = recorded.transpose()?;
        let watch = recorded.clone().map(Watch::of).transpose().map_err(failed)?;
        Ok(Self { path: path.to_owned(), file, written, recorded, watch })
    }

    /// The path that the user gave.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The writer of the file.
    ///
    /// # Errors
    /// Returns an error if the process has too many open files.
    pub fn writer(&self) -> io::Result<impl Write + Send + 'static> {
        Ok(CountingWriter { file: self.file.try_clone()?, written: Arc::clone(&self.written) })
    }

    /// Checks that the file is still intact.
    ///
    /// # Errors
    /// Returns an error if the file was removed, replaced or cut short, or if a sync failed.
    #[inline]
    pub fn check(&mut self) -> io::Result<()> {
        match self.watch.take_if(|watch| watch.thread.is_finished()) {
            None => Ok(()),
            Some(ended) => ended.finish(),
        }
    }

    /// Syncs the complete file to the disk.
    ///
    /// # Errors
    /// Returns the errors of [`Recording::check`], or an error if the file cannot be synced.
    pub fn finish(self) -> io::Result<()> {
        let Some(recorded) = self.recorded else { return Ok(()) };
        self.watch.map_or(Ok(()), Watch::finish)?;
        recorded.look()?;
        recorded.file.sync_all()
    }
}

struct CountingWriter {
    file: File,
    written: Arc<AtomicU64>,
}

impl Write for CountingWriter {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.file.write(bytes)?;
        self.written.fetch_add(written as u64, Ordering::Release);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}

/// A recording file and its checks. Each write appends, so a file that was cut elsewhere stays shorter than `written`.
#[derive(Debug)]
struct RecordedFile {
    target: PathBuf,
    file: File,
    written: Arc<AtomicU64>,
}

impl RecordedFile {
    fn look(&self) -> io::Result<()> {
        let lost = |what: &str| Err(io::Error::other(format!("it was {what} while it was recorded into")));
        let written = self.written.load(Ordering::Acquire);
        let there = Identity::of_open(&self.file, &self.target);
        match fs::metadata(&self.target) {
            Err(error) if error.kind() == ErrorKind::NotFound => return lost("removed or moved"),
            // an unreachable network file system does not mean that the file is gone
            Err(_) => {}
            Ok(named) if Identity::of(&named, &self.target) != there => return lost("replaced by another file"),
            Ok(_) => {}
        }
        let length = self.file.metadata()?.len();
        if length < written { lost(&format!("cut short, from {written} bytes to {length},")) } else { Ok(()) }
    }
}

fn create(path: &Path, target: &Path) -> Result<File, OutputError> {
    let file = OpenOptions::new().append(true).create_new(true).open(target).map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => OutputError::Exists { path: path.to_owned(), has_force: false },
        _ => OutputError::io("write", path, error),
    })?;
    lock(&file).map_err(|_| busy(path))?;
    Ok(file)
}

/// Creates a new file in place of the old one, to which other hard links may exist. The lock on the old file keeps
/// two runs from replacing it at once.
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

/// A thread that checks the file four times a second and calls `fdatasync` once a second. The thread keeps a slow disk
/// from delaying the reading of the part. It ends early on an error.
#[derive(Debug)]
struct Watch {
    stop: Sender<()>,
    thread: JoinHandle<io::Result<()>>,
}

impl Watch {
    fn of(recorded: Arc<RecordedFile>) -> io::Result<Self> {
        let (stop, stopped) = mpsc::channel();
        let thread = thread::Builder::new().name("capture-sync".to_owned()).spawn(move || {
            let mut looks = 0u32;
            while stopped.recv_timeout(LOOK_EVERY) == Err(RecvTimeoutError::Timeout) {
                recorded.look()?;
                looks = looks.wrapping_add(1);
                if looks.is_multiple_of(LOOKS_PER_SYNC) {
                    recorded.file.sync_data()?;
                }
            }
            Ok(())
        })?;
        Ok(Self { stop, thread })
    }

    fn finish(self) -> io::Result<()> {
        drop(self.stop);
        self.thread.join().unwrap_or_else(|_| Err(io::Error::other("the syncing thread died")))
    }
}
