//! Temporary files. They are removed on drop, and by the handler of a signal that ends the program at once. Only a
//! killed process leaves them.

use std::collections::BTreeSet;
use std::fs::{self, File, Permissions};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use tempfile::{Builder, NamedTempFile};

static ALL: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

fn all() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    ALL.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Removes all temporary files right before the program exits. The list stays locked, so a thread that then creates a
/// temporary file waits forever.
pub fn remove_all_for_good() {
    let all = all();
    for path in all.iter() {
        let _ = fs::remove_file(path);
    }
    std::mem::forget(all);
}

/// Removes the path of the temporary file from an error. The user does not know that path.
fn without_path(error: io::Error) -> io::Error {
    match error.to_string().split_once(" at path ") {
        Some((why, _)) => io::Error::new(error.kind(), why),
        None => error,
    }
}

/// A newly created file, listed for removal until it gets its final name.
#[derive(Debug)]
pub struct Temporary {
    file: NamedTempFile,
    _listed: ListEntry,
}

impl Temporary {
    /// Creates a file in `folder` that is meant to be kept, usually under another name. It has the permissions of an
    /// ordinary new file, and is open for appending. Its name has `random` random characters between `start` and
    /// `end`.
    pub fn for_keeps(folder: &Path, start: &str, end: &str, random: usize) -> io::Result<Self> {
        let mut builder = Builder::new();
        builder.prefix(start).suffix(end).rand_bytes(random).append(true);
        if let Some(permissions) = permissions_before_umask() {
            builder.permissions(permissions);
        }
        let mut all = all();
        let file = builder.tempfile_in(folder).map_err(without_path)?;
        all.insert(file.path().to_owned());
        let listed = ListEntry(file.path().to_owned());
        Ok(Self { file, _listed: listed })
    }

    pub fn path(&self) -> &Path {
        self.file.path()
    }

    pub fn file(&self) -> &File {
        self.file.as_file()
    }

    pub fn keep(self) -> io::Result<PathBuf> {
        Ok(self.file.keep()?.1)
    }

    /// Renames the file to `target`, replacing an existing file.
    pub fn replace(self, target: &Path) -> io::Result<File> {
        Ok(self.file.persist(target)?)
    }

    /// Renames the file to `target`, which must not exist.
    pub fn name(self, target: &Path) -> io::Result<File> {
        self.file.persist_noclobber(target).or_else(|refused| {
            let taken = refused.error.kind() == ErrorKind::AlreadyExists || target.symlink_metadata().is_ok();
            // this file system can neither rename without replacing nor make a second link
            if taken { Err(refused.error) } else { Ok(refused.file.persist(target)?) }
        })
    }
}

#[derive(Debug)]
struct ListEntry(PathBuf);

impl Drop for ListEntry {
    fn drop(&mut self) {
        all().remove(&self.0);
    }
}

#[cfg(unix)]
fn permissions_before_umask() -> Option<Permissions> {
    use std::os::unix::fs::PermissionsExt;
    Some(Permissions::from_mode(0o666))
}

#[cfg(not(unix))]
fn permissions_before_umask() -> Option<Permissions> {
    None
}
