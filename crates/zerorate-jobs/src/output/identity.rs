//! Identifies a file under any of its names.

use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::path::{Path, PathBuf};

/// The identity of an existing file, or of a name that is still free.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Identity {
    /// Device and inode, which all hard links share.
    #[cfg(unix)]
    Inode(u64, u64),
    /// The canonical path, on systems without inodes.
    #[cfg(not(unix))]
    Path(PathBuf),
    /// The folder and name of a file that does not exist yet.
    Name(PathBuf, OsString),
}

impl Identity {
    /// The identity of the regular file to which `path` leads; `None` if there is none.
    pub fn of_file(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok().filter(Metadata::is_file)?;
        Self::of(&metadata, path)
    }

    /// The identity of a file or pipe with this metadata.
    #[cfg(unix)]
    pub fn of(metadata: &Metadata, _: &Path) -> Option<Self> {
        use std::os::unix::fs::MetadataExt;
        Some(Self::Inode(metadata.dev(), metadata.ino()))
    }

    /// The identity of the file or pipe at `path`; `None` if the path cannot be resolved.
    #[cfg(not(unix))]
    pub fn of(_: &Metadata, path: &Path) -> Option<Self> {
        path.canonicalize().ok().map(Self::Path)
    }

    /// The identity of the open file that is called `path`; `None` if it is unknown.
    pub fn of_open(file: &File, path: &Path) -> Option<Self> {
        Self::of(&file.metadata().ok()?, path)
    }
}
