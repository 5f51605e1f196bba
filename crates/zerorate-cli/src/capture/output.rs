//! Where results go: never over what cannot be had again, and never half a derived file under its final name.

use super::CaptureError;
use std::fs::{self, File, OpenOptions};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Opens a file to record into. An existing one is an error unless `force`; a pipe or a device is no file to lose.
pub fn create(path: &Path, force: bool) -> Result<File, CaptureError> {
    let fresh = OpenOptions::new().write(true).create_new(true).open(path);
    let file = match fresh {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            refuse_existing(path, force)?;
            File::create(path)
        }
        other => other,
    };
    file.map_err(|error| CaptureError::io("create", path, error))
}

fn refuse_existing(path: &Path, force: bool) -> Result<(), CaptureError> {
    if !force && path.is_file() { Err(CaptureError::Exists { path: path.to_owned() }) } else { Ok(()) }
}

/// A file that takes its name only when it is complete.
pub struct Staged {
    target: PathBuf,
    staging: PathBuf,
}

impl Staged {
    /// A result for `target`, which must not exist unless `force`.
    pub fn new(target: &Path, force: bool) -> Result<Self, CaptureError> {
        refuse_existing(target, force)?;
        let renamed = target.is_file() || !target.exists();
        let mut staging = target.as_os_str().to_owned();
        if renamed {
            staging.push(".part");
        }
        Ok(Self { target: target.to_owned(), staging: staging.into() })
    }

    /// Where to write until then.
    pub fn path(&self) -> &Path {
        &self.staging
    }

    /// The file is complete.
    pub fn publish(self) -> Result<(), CaptureError> {
        if self.staging == self.target {
            return Ok(());
        }
        fs::rename(&self.staging, &self.target).map_err(|error| CaptureError::io("write", &self.target, error))
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        if self.staging != self.target {
            // after `publish` there is nothing left to remove
            let _ = fs::remove_file(&self.staging);
        }
    }
}
