//! Finds where an output path leads.

use super::OutputError;
use super::identity::Identity;
use std::ffi::{OsStr, OsString};
use std::fs::{self, Metadata};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// The most links in a row that are followed, as in Linux.
const MOST_LINKS: usize = 40;

/// The destination of an output.
#[derive(Clone, Debug)]
pub enum Place {
    /// A name in a folder, with or without an existing file. Links have been followed.
    Name {
        folder: PathBuf,
        name: OsString,
        /// The regular file that has this name now; `None` if the name is free.
        replaces: Option<Identity>,
    },
    /// A pipe, terminal or device. It has no content to lose, and no file can be renamed onto it.
    Stream { path: PathBuf, identity: Option<Identity> },
}

impl Place {
    /// Follows the links of `path`. Refuses links that cannot be trusted.
    pub fn of(path: &Path) -> Result<Self, OutputError> {
        let mut at = path.to_owned();
        for _ in 0..MOST_LINKS {
            match fs::symlink_metadata(&at) {
                Ok(metadata) if metadata.is_symlink() => match follow(path, &at, &metadata)? {
                    LinkTarget::Stream(identity) => return Ok(Self::Stream { path: path.to_owned(), identity }),
                    LinkTarget::To(next) => at = next,
                },
                Ok(metadata) if metadata.is_dir() => return Err(OutputError::Folder { path: path.to_owned() }),
                Ok(metadata) if metadata.is_file() => return Self::named(path, &at, Identity::of(&metadata, &at)),
                Ok(metadata) => {
                    return Ok(Self::Stream { path: path.to_owned(), identity: pipe(&metadata, &at) });
                }
                Err(error) if error.kind() == ErrorKind::NotFound => return Self::named(path, &at, None),
                Err(error) => return Err(OutputError::io("write", path, error)),
            }
        }
        Err(OutputError::io("write", path, io::Error::other("too many symbolic links in a row")))
    }

    fn named(path: &Path, at: &Path, replaces: Option<Identity>) -> Result<Self, OutputError> {
        let name = at.file_name().ok_or_else(|| OutputError::Folder { path: path.to_owned() })?;
        let folder = folder_of(at).canonicalize().map_err(|error| match error.kind() {
            ErrorKind::NotFound => OutputError::NoFolder { path: path.to_owned(), folder: folder_of(at).to_owned() },
            _ => OutputError::io("write", path, error),
        })?;
        Ok(Self::Name { folder, name: name.to_owned(), replaces })
    }

    /// True if a regular file exists at the destination and would be overwritten.
    pub fn exists(&self) -> bool {
        matches!(self, Self::Name { replaces: Some(_), .. })
    }

    /// The identity of the destination; `None` for a device, which several outputs may share.
    pub fn identity(&self) -> Option<Identity> {
        match self {
            Self::Name { replaces: Some(file), .. } => Some(file.clone()),
            Self::Name { folder, name, .. } => Some(Identity::Name(folder.clone(), name.clone())),
            Self::Stream { identity, .. } => identity.clone(),
        }
    }
}

pub fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| *folder != OsStr::new("")).unwrap_or(Path::new("."))
}

/// The identity of a pipe or socket, where two outputs would be mixed; `None` for a device, which may be shared.
pub fn pipe(metadata: &Metadata, path: &Path) -> Option<Identity> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::FileTypeExt;
        let kind = metadata.file_type();
        (kind.is_fifo() || kind.is_socket()).then(|| Identity::of(metadata, path)).flatten()
    }
    #[cfg(not(unix))]
    {
        let _ = (metadata, path);
        None
    }
}

enum LinkTarget {
    Stream(Option<Identity>),
    To(PathBuf),
}

/// Follows one symbolic link in `path`.
fn follow(path: &Path, link: &Path, metadata: &Metadata) -> Result<LinkTarget, OutputError> {
    let target = fs::read_link(link).map_err(|error| OutputError::io("write", path, error))?;
    refuse_foreign(path, link, metadata, &target)?;
    match fs::metadata(link) {
        Ok(end) if !end.is_file() && !end.is_dir() => Ok(LinkTarget::Stream(pipe(&end, link))),
        Ok(_) => Ok(LinkTarget::To(folder_of(link).join(target))),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            Err(OutputError::Dangling { path: path.to_owned(), target })
        }
        Err(error) => Err(OutputError::io("write", path, error)),
    }
}

/// Refuses a link by the rule of Linux (`fs.protected_symlinks`), in every folder: the link must belong to the user,
/// to root or to the folder's owner.
#[cfg(unix)]
fn refuse_foreign(path: &Path, link: &Path, metadata: &Metadata, target: &Path) -> Result<(), OutputError> {
    use std::os::unix::fs::MetadataExt;
    let uid = metadata.uid();
    let owns_folder = || fs::metadata(folder_of(link)).is_ok_and(|folder| folder.uid() == uid);
    // a new file shows the user id under which this process creates files
    let is_mine = || tempfile::tempfile().and_then(|file| file.metadata()).is_ok_and(|mine| mine.uid() == uid);
    if uid == 0 || owns_folder() || is_mine() {
        return Ok(());
    }
    Err(OutputError::ForeignLink { path: path.to_owned(), target: target.to_owned(), uid })
}

#[cfg(not(unix))]
fn refuse_foreign(_: &Path, _: &Path, _: &Metadata, _: &Path) -> Result<(), OutputError> {
    Ok(())
}
