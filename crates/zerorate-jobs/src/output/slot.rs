//! An output that a run rewrites repeatedly, each time atomically, while no other run can write to it.

use super::OutputError;
use super::disk::{claim, sync_folder, unfinished};
use super::identity::Identity;
use super::place::Place;
use super::temporary::Temporary;
use std::ffi::OsString;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use zerorate_host::files;
use zerorate_input::limits::Bytes;

/// A claimed file. The claim ends on drop; the written content stays.
#[derive(Debug)]
pub struct Slot {
    path: PathBuf,
    folder: PathBuf,
    name: OsString,
    /// The identity of the file as this run found or wrote it; `None` if there is none.
    holds: Option<Identity>,
    /// An empty locked file beside the claimed file. It shows the claim to other runs.
    _claim: Temporary,
}

impl Slot {
    /// Claims `place`, the destination of `path`.
    pub(super) fn new(path: &Path, place: Place) -> Result<Self, OutputError> {
        let Place::Name { folder, name, replaces } = place else {
            return Err(OutputError::NotAFile { path: path.to_owned() });
        };
        let claim = claim(path, &folder, &name)?;
        Ok(Self { path: path.to_owned(), folder, name, holds: replaces, _claim: claim })
    }

    /// The path that the user gave.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The content of the file; `None` if the file does not exist.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read or has more than `most` bytes.
    pub fn content(&self, most: Bytes) -> io::Result<Option<String>> {
        match files::text(&self.target(), most) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            read => read.map(Some),
        }
    }

    /// Replaces the content atomically. If the replacement fails, the old content stays and the caller can try again.
    ///
    /// # Errors
    /// Returns the error of the file system, or an error if another program has put its own file at the path.
    pub fn put(&mut self, content: &[u8]) -> Result<(), OutputError> {
        let target = self.target();
        let found = Identity::of_file(&target);
        if found.is_some() && found != self.holds {
            return Err(OutputError::TakenMeanwhile { path: self.path.clone() });
        }
        let put = || -> io::Result<()> {
            let new = unfinished(&self.folder, &self.name)?;
            new.file().write_all(content)?;
            new.file().sync_all()?;
            if found.is_some() {
                new.replace(&target)?
            } else {
                new.name(&target)?
            };
            Ok(())
        };
        let failed = |error| OutputError::io("write", &self.path, error);
        put().map_err(failed)?;
        // the file is this program's own from now on, even if its folder cannot be synchronised
        self.holds = Identity::of_file(&target);
        sync_folder(&self.folder).map_err(failed)
    }

    /// Removes the file, unless another program has replaced it.
    pub fn clear(&mut self) {
        if self.holds.take() == Identity::of_file(&self.target()) {
            let _ = fs::remove_file(self.target());
        }
    }

    fn target(&self) -> PathBuf {
        self.folder.join(&self.name)
    }
}
