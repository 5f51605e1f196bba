//! The errors of outputs.

use std::io;
use std::path::{Path, PathBuf};

/// The reasons why an output is refused or cannot be written.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the texts say what the variants and fields are")]
pub enum OutputError {
    #[error("{} exists, and is not overwritten by accident: choose another name", path.display())]
    Exists {
        path: PathBuf,
        /// True if the command has an option to replace the file.
        has_force: bool,
    },

    #[error("{} would be overwritten while it is read, since it is the same file as the input {}: choose \
             another name", path.display(), input.display())]
    IsInput { path: PathBuf, input: PathBuf },

    #[error("{} is the same file as {other}, where other output of this command goes: choose another \
             name", path.display())]
    Twice { path: PathBuf, other: String },

    #[error("{} is a capture, which cannot be had again, and no option replaces it by a computed file: choose \
             another name, or remove it yourself", path.display())]
    IsCapture { path: PathBuf },

    #[error("{} is being written by another zerorate: choose another name, or wait for it to end", path.display())]
    Busy { path: PathBuf },

    /// Another program created or replaced the file after the run had claimed its name.
    #[error("{} was written by something else meanwhile, and is left as it is", path.display())]
    TakenMeanwhile { path: PathBuf },

    /// The path is a symbolic link to a file that does not exist. The link may lead to an unexpected place.
    #[error("{} is a symbolic link to {}, which does not exist; a file is not made through a \
             link: name the file itself, or remove the link", path.display(), target.display())]
    Dangling { path: PathBuf, target: PathBuf },

    /// The path is a link that another user made, in a folder that is not that user's.
    #[error("{} is a symbolic link that another user (uid {uid}) made, to {}: it is not followed; name the \
             file itself", path.display(), target.display())]
    ForeignLink { path: PathBuf, target: PathBuf, uid: u32 },

    /// `-` was given as the output. Many programs then write to stdout, but zerorate prints its results there.
    #[error("`-` is not a file, and stdout is for what the command prints; give the file a name")]
    Dash,

    #[error("{}: zerorate writes no PDF; name a page .html, and print it from a browser", path.display())]
    Pdf { path: PathBuf },

    /// The output is a pipe or a device, but the file must be read again later.
    #[error("{} is not a file: name a file, or one that does not exist yet", path.display())]
    NotAFile { path: PathBuf },

    /// The path cannot name a file, for example because it is a folder.
    #[error("cannot write {}: it is a folder", path.display())]
    Folder { path: PathBuf },

    #[error(
        "cannot write {}: the folder {} does not exist; make it, or choose another",
        path.display(),
        folder.display()
    )]
    NoFolder { path: PathBuf, folder: PathBuf },

    #[error("cannot {action} {}", path.display())]
    Io { action: &'static str, path: PathBuf, source: io::Error },
}

impl OutputError {
    /// True if the run refuses the path itself, as it refuses a file that exists. False for errors of the file system,
    /// for a path that is a folder or lies in a missing one, and for a file that appeared after the claim.
    #[must_use]
    pub fn is_refusal(&self) -> bool {
        !matches!(self, Self::Io { .. } | Self::Folder { .. } | Self::NoFolder { .. } | Self::TakenMeanwhile { .. })
    }

    pub(super) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }
}
