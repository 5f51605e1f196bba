//! The errors of outputs.

use std::io;
use std::path::{Path, PathBuf};

/// The reasons why an output is refused or fails.
#[derive(Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the fields are what the text shows")]
pub enum OutputError {
    /// There is a file of that name.
    #[error("{} exists, and is not overwritten by accident: choose another name", path.display())]
    Exists {
        path: PathBuf,
        /// Whether the user could have asked for the file to be replaced.
        has_force: bool,
    },

    /// The run reads that file.
    #[error("{} would be overwritten while it is read, since it is the same file as the input {}: choose \
             another name", path.display(), input.display())]
    IsInput { path: PathBuf, input: PathBuf },

    /// The run writes that file already.
    #[error("{} is the same file as {other}, where other output of this command goes: choose another \
             name", path.display())]
    Twice { path: PathBuf, other: String },

    /// There is a recording of that name, and the new file would not be one.
    #[error("{} is a capture, which cannot be had again, and no option replaces it by a computed file: choose \
             another name, or remove it yourself", path.display())]
    IsCapture { path: PathBuf },

    /// Another process writes that file.
    #[error("{} is being written by another zerorate: choose another name, or wait for it to end", path.display())]
    Busy { path: PathBuf },

    /// Something else took the name since this run claimed it.
    #[error("{} was written by something else meanwhile, and is left as it is", path.display())]
    TakenMeanwhile { path: PathBuf },

    /// A link to nothing: its maker may have wanted the file elsewhere than the user thinks.
    #[error("{} is a symbolic link to {}, which does not exist; a file is not made through a \
             link: name the file itself, or remove the link", path.display(), target.display())]
    Dangling { path: PathBuf, target: PathBuf },

    /// A link that somebody else made, in a folder that is not theirs.
    #[error("{} is a symbolic link that another user (uid {uid}) made, to {}: it is not followed; name the \
             file itself", path.display(), target.display())]
    ForeignLink { path: PathBuf, target: PathBuf, uid: u32 },

    /// `-` was given as the output. Other programs write to stdout then; this one prints results for people there.
    #[error("`-` is not a file, and stdout is for what the command prints; give the file a name")]
    Dash,

    /// The output is a PDF, which the program does not write.
    #[error("{}: zerorate writes no PDF; name a page .html, and print it from a browser", path.display())]
    Pdf { path: PathBuf },

    /// A file that must be read again later needs a place that can be read.
    #[error("{} is not a file: name a file, or one that does not exist yet", path.display())]
    NotAFile { path: PathBuf },

    /// No file can have that name.
    #[error("cannot write {}: it is a folder", path.display())]
    Folder { path: PathBuf },

    /// A file cannot be put into a folder that does not exist.
    #[error(
        "cannot write {}: the folder {} does not exist; make it, or choose another",
        path.display(),
        folder.display()
    )]
    NoFolder { path: PathBuf, folder: PathBuf },

    /// The file system said no.
    #[error("cannot {action} {}", path.display())]
    Io { action: &'static str, path: PathBuf, source: io::Error },
}

impl OutputError {
    /// Whether another name, or leave to replace the file, is all that it takes.
    #[must_use]
    pub fn is_refusal(&self) -> bool {
        !matches!(self, Self::Io { .. } | Self::Folder { .. } | Self::NoFolder { .. } | Self::TakenMeanwhile { .. })
    }

    /// An I/O error, with what was being done to which file.
    pub(super) fn io(action: &'static str, path: &Path, source: io::Error) -> Self {
        Self::Io { action, path: path.to_owned(), source }
    }
}
