//! Output files. They never overwrite an input. They overwrite an existing file only with `--force`, or if it is a
//! state file ([`Outputs::slot`]). A computed file never appears half-written under its final name.
//!
//! A command opens every file through [`Outputs`], which therefore knows all files of a run. [`Outputs`] refuses an
//! output that is an input or another output of the same run, under any name (hard links, symbolic links, `./x`,
//! `/dev/stdout`). It refuses an output that exists, unless `--force` is given. Even with `--force`, results that can
//! be computed again never replace a capture. docs/reference/files.md states the rules for users.

mod disk;
mod error;
mod identity;
mod place;
mod recording;
mod rescue;
mod slot;
mod staged;
mod streams;
mod temporary;

pub use disk::{is_being_recorded, opens_stream};
pub use error::OutputError;
pub use recording::Recording;
pub use rescue::rescue;
pub use slot::Slot;
pub use staged::StagedOutput;
pub use temporary::remove_all_for_good;

use anyhow::Context;
use identity::Identity;
use place::Place;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use zerorate_host::files;
use zerorate_input::InputError;
use zerorate_input::limits::Bytes;
use zerorate_record::CaptureError;
use zerorate_record::CaptureReader;

/// The files of one run of a command.
#[derive(Debug)]
pub struct Outputs {
    /// True if `--force` was given. `None` if the command has no such option.
    force: Option<bool>,
    inputs: Vec<(Identity, PathBuf)>,
    /// Outputs claimed so far, and the files behind stdout and stderr, each with its name for messages.
    claimed: Vec<(Identity, String)>,
}

impl Outputs {
    /// The files of a run that may overwrite existing files if `force` is true.
    pub fn new(force: bool) -> Self {
        let streams = streams::files().into_iter().map(|(identity, name)| (identity, name.to_owned()));
        Self { force: Some(force), inputs: Vec::new(), claimed: streams.collect() }
    }

    /// The files of a run whose command has no `--force` option and overwrites nothing.
    pub fn without_force() -> Self {
        Self { force: None, ..Self::new(false) }
    }

    /// Declares that the run also prints data. Outputs are then refused in the pipe of stdout, as always in its file.
    pub fn printing(mut self) -> Self {
        self.claimed.extend(streams::stdout_pipe().map(|identity| (identity, streams::STDOUT.to_owned())));
        self
    }

    /// Registers these logs as inputs. A log that does not exist fails later, with a better message.
    ///
    /// # Errors
    /// Returns the errors of [`Outputs::reads`].
    pub fn reading<'a>(mut self, inputs: impl IntoIterator<Item = &'a Path>) -> Result<Self, OutputError> {
        inputs.into_iter().try_for_each(|path| self.reads(path))?;
        Ok(self)
    }

    /// Registers an input: a file, all files of a folder, or standard input for `-`.
    ///
    /// # Errors
    /// Returns [`OutputError::IsInput`] if an output, stdout or stderr goes into one of these files.
    pub fn reads(&mut self, path: &Path) -> Result<(), OutputError> {
        let piped = streams::stdin_file().filter(|_| path == Path::new(files::STDIN));
        let listed = files::listed(path).into_iter().filter_map(|file| Some((Identity::of_file(&file)?, file)));
        self.inputs.extend(listed.chain(piped.map(|identity| (identity, path.to_owned()))));
        self.claimed.iter().try_for_each(|(output, name)| self.refuse_input(output, Path::new(name)))
    }

    /// Reads a whole text file of at most `most` bytes.
    ///
    /// # Errors
    /// Returns the errors of [`Outputs::reads`], or an error if the file cannot be read.
    pub fn text(&mut self, path: &Path, most: Bytes) -> anyhow::Result<String> {
        self.try_text(path, most)?.with_context(|| format!("cannot read {}", path.display()))
    }

    /// Reads a text file like `text`, but returns the I/O error for callers that have their own messages.
    ///
    /// # Errors
    /// Returns the errors of [`Outputs::reads`].
    pub fn try_text(&mut self, path: &Path, most: Bytes) -> Result<io::Result<String>, OutputError> {
        self.reads(path)?;
        Ok(files::text(path, most))
    }

    /// Registers a capture as an input and opens it.
    ///
    /// # Errors
    /// Returns the errors of [`Outputs::reads`], or an error if the file cannot be opened as a capture.
    pub fn capture(&mut self, path: &Path) -> anyhow::Result<CaptureReader> {
        self.reads(path)?;
        Ok(files::capture(path)?)
    }

    /// Claims a file for a result that can be computed again. The file takes its name when it is complete.
    ///
    /// # Errors
    /// Returns an error if the file is refused ([`OutputError::is_refusal`]) or cannot be written.
    pub fn derived(&mut self, path: &Path) -> Result<StagedOutput, OutputError> {
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("pdf")) {
            return Err(OutputError::Pdf { path: path.to_owned() });
        }
        let place = self.claim(path)?;
        if place.exists() {
            refuse_capture(path)?;
        }
        StagedOutput::new(path, place)
    }

    /// Claims a file to record into, under its final name, so that the samples survive a power cut.
    ///
    /// # Errors
    /// Returns the errors of [`Outputs::derived`].
    pub fn recording(&mut self, path: &Path) -> Result<Recording, OutputError> {
        let place = self.claim(path)?;
        Recording::new(path, place)
    }

    /// Claims a file that the run rewrites repeatedly. It may exist: the run continues from an earlier run's content.
    ///
    /// # Errors
    /// Returns the errors of [`Outputs::derived`].
    pub fn slot(&mut self, path: &Path) -> Result<Slot, OutputError> {
        let place = self.claim_over(path, true)?;
        if place.exists() {
            refuse_capture(path)?;
        }
        Slot::new(path, place)
    }

    fn claim(&mut self, path: &Path) -> Result<Place, OutputError> {
        self.claim_over(path, self.force == Some(true))
    }

    fn claim_over(&mut self, path: &Path, may_exist: bool) -> Result<Place, OutputError> {
        if path == Path::new("-") {
            return Err(OutputError::Dash);
        }
        let place = Place::of(path)?;
        let Some(identity) = place.identity() else {
            return Ok(place);
        };
        self.refuse_input(&identity, path)?;
        if let Some((_, other)) = self.claimed.iter().find(|(claimed, _)| *claimed == identity) {
            return Err(OutputError::Twice { path: path.to_owned(), other: other.clone() });
        }
        if place.exists() && !may_exist {
            return Err(OutputError::Exists { path: path.to_owned(), has_force: self.force.is_some() });
        }
        self.claimed.push((identity, path.display().to_string()));
        Ok(place)
    }

    fn refuse_input(&self, output: &Identity, path: &Path) -> Result<(), OutputError> {
        match self.inputs.iter().find(|(input, _)| input == output) {
            Some((_, input)) => Err(OutputError::IsInput { path: path.to_owned(), input: input.clone() }),
            None => Ok(()),
        }
    }
}

/// True if the error is an output refusal in the sense of [`OutputError::is_refusal`].
#[must_use]
pub fn is_refusal(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| cause.downcast_ref().is_some_and(OutputError::is_refusal))
}

/// True if the file could be replaced with the `--force` option. Each front end names that option in its own words.
#[must_use]
pub fn could_be_forced(error: &anyhow::Error) -> bool {
    error.chain().any(|cause| matches!(cause.downcast_ref(), Some(OutputError::Exists { has_force: true, .. })))
}

/// Refuses to replace a capture, which cannot be recorded again. A corrected capture may be replaced: it can be
/// computed again from its source.
fn refuse_capture(path: &Path) -> Result<(), OutputError> {
    let failed = |source| OutputError::io("look at", path, source);
    let is_capture = match files::capture(path) {
        Ok(reader) => reader.calibration_id().is_none(),
        Err(CaptureError::NotACapture { .. }) => was_capture(path).map_err(failed)?,
        Err(CaptureError::Input(InputError::Io { source, .. })) => return Err(failed(source)),
        // a damaged capture, or one of a later version
        Err(_) => true,
    };
    if is_capture { Err(OutputError::IsCapture { path: path.to_owned() }) } else { Ok(()) }
}

/// Number of bytes at the start of a file that are searched for [`NAME`]. Every capture has a key there.
const HEAD: u64 = 1 << 16;

/// True if a file that cannot be read as a capture still starts like one.
fn was_capture(path: &Path) -> io::Result<bool> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    let starts_like_one =
        [&b"\xFF\xFF\xFF\xFF"[..], b"PAR1", b"# zerorate."].iter().any(|mark| head.starts_with(mark));
    Ok(starts_like_one && head.windows(NAME.len()).any(|window| window == NAME))
}

/// The start of every key in a capture's description.
const NAME: &[u8] = b"zerorate.";

#[cfg(test)]
mod tests;
