//! The identity of a file, under any name.

use std::ffi::OsString;
use std::fs::{self, File, Metadata};
use std::path::{Path, PathBuf};

/// A file that exists, or a name in a folder.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Identity {
    /// Device and inode: the same through hard links.
    #[cfg(unix)]
    Inode(u64, u64),
    /// The path stands in where nothing better tells files apart.
    #[cfg(not(unix))]
    Path(PathBuf),
    /// No file yet.
    Name(PathBuf, OsString),
}

impl Identity {
    /// The regular file that is found there; none if there is nothing, or what has no content to lose.
    pub fn of_file(path: &Path) -> Option<Self> {
        let metadata = fs::metadata(path).ok().filter(Metadata::is_file)?;
        Self::of(&metadata, path)
    }

    /// The identity of anything at that path, a pipe as well.
    #[cfg(unix)]
    pub fn of(metadata: &Metadata, _: &Path) -> Option<Self> {
        use std::os::unix::fs::MetadataExt;
        Some(Self::Inode(metadata.dev(), metadata.ino()))
    }

    /// The identity of anything at that path.
    #[cfg(not(unix))]
    pub fn of(_: &Metadata, path: &Path) -> Option<Self> {
        path.canonicalize().ok().map(Self::Path)
    }

    /// The identity of the open file that is called `path`.
    pub fn of_open(file: &File, path: &Path) -> Option<Self> {
        Self::of(&file.metadata().ok()?, path)
    }
}
