//! A file that a run writes again and again, each time whole, and that no other run writes meanwhile.

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

/// A claimed file. The claim ends when this is dropped; what was written stays.
#[derive(Debug)]
pub struct Slot {
    /// The path as it was asked for.
    path: PathBuf,
    folder: PathBuf,
    name: OsString,
    /// The file that is there now.
    holds: Option<Identity>,
    /// Beside it, empty and locked: the claim, which other runs see.
    _claim: Temporary,
}

impl Slot {
    /// Claims `place`, which `path` has led to.
    pub(super) fn new(path: &Path, place: Place) -> Result<Self, OutputError> {
        let Place::Name { folder, name, replaces } = place else {
            return Err(OutputError::NotAFile { path: path.to_owned() });
        };
        let claim = claim(path, &folder, &name)?;
        Ok(Self { path: path.to_owned(), folder, name, holds: replaces, _claim: claim })
    }

    /// The name that was asked for.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The content, with at most `most` bytes; none where the file does not exist.
    ///
    /// # Errors
    /// Returns an error if the file cannot be read.
    pub fn content(&self, most: Bytes) -> io::Result<Option<String>> {
        match files::text(&self.target(), most) {
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            read => read.map(Some),
        }
    }

    /// Replaces the content. Where that fails, the older content stays, and the caller can try again.
    ///
    /// # Errors
    /// Returns the error of the file system, or an error if another program has written there since.
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
            sync_folder(&self.folder)
        };
        put().map_err(|error| OutputError::io("write", &self.path, error))?;
        self.holds = Identity::of_file(&target);
        Ok(())
    }

    /// Removes the file, which is not wanted any more.
    pub fn clear(&mut self) {
        if self.holds.take() == Identity::of_file(&self.target()) {
            let _ = fs::remove_file(self.target());
        }
    }

    fn target(&self) -> PathBuf {
        self.folder.join(&self.name)
    }
}
