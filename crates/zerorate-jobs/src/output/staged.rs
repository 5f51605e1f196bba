//! An output that gets its final name only when it is complete and synced to the disk.

use super::OutputError;
use super::disk::{claim, open_stream, sync_folder};
use super::identity::Identity;
use super::place::Place;
use super::temporary::Temporary;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A claimed output. If it is dropped before [`StagedOutput::publish`], a file of its name stays as it is.
#[derive(Debug)]
pub struct StagedOutput {
    path: PathBuf,
    destination: Destination,
}

#[derive(Debug)]
enum Destination {
    File { unfinished: Temporary, folder: PathBuf, target: PathBuf, replaces: Option<Identity> },
    Stream(File),
}

impl StagedOutput {
    /// Prepares the output: opens a pipe or a device, or creates an unfinished file beside the final name.
    pub(super) fn new(path: &Path, place: Place) -> Result<Self, OutputError> {
        let destination = match place {
            Place::Stream { path: stream, .. } => {
                Destination::Stream(open_stream(&stream).map_err(|error| OutputError::io("write", path, error))?)
            }
            Place::Name { folder, name, replaces } => {
                let unfinished = claim(path, &folder, &name)?;
                Destination::File { unfinished, target: folder.join(name), folder, replaces }
            }
        };
        Ok(Self { path: path.to_owned(), destination })
    }

    /// The path that the user gave.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The file to write to.
    ///
    /// # Errors
    /// Returns an error if the process has too many open files.
    pub fn file(&self) -> Result<File, OutputError> {
        let file = match &self.destination {
            Destination::File { unfinished, .. } => unfinished.file(),
            Destination::Stream(file) => file,
        };
        file.try_clone().map_err(|error| OutputError::io("write", &self.path, error))
    }

    /// Writes the whole content and publishes it.
    ///
    /// # Errors
    /// Returns the errors of [`StagedOutput::publish`].
    pub fn fill(self, content: &[u8]) -> Result<(), OutputError> {
        self.file()?.write_all(content).map_err(|error| OutputError::io("write", &self.path, error))?;
        self.publish()
    }

    /// Publishes the complete file: syncs it, renames it to its final name, and syncs the folder.
    ///
    /// # Errors
    /// Returns the error of the file system, or an error if another program has meanwhile put its own file there.
    pub fn publish(self) -> Result<(), OutputError> {
        let path = self.path;
        let failed = |error| OutputError::io("write", &path, error);
        let Destination::File { unfinished, folder, target, replaces } = self.destination else {
            return Ok(());
        };
        unfinished.file().sync_all().map_err(failed)?;
        let found = Identity::of_file(&target);
        let named = match replaces {
            Some(old) if found.as_ref() == Some(&old) => unfinished.replace(&target),
            _ => unfinished.name(&target),
        };
        match named {
            Ok(_) => sync_folder(&folder).map_err(failed),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => Err(OutputError::TakenMeanwhile { path }),
            Err(error) => Err(failed(error)),
        }
    }
}
