//! Where results go: never onto what is read, never over what is there, never half a file under its final name.
//!
//! [`Outputs`] knows all files of a run. It refuses an output that is an input or another output of the same run, by
//! whatever name (hard links, symbolic links, `./x`, `/dev/stdout`), and one that exists, unless `--force`; a capture
//! is not even then replaced by what can be computed again. docs/reference/files.md states the rules for users.

mod disk;
mod error;
mod identity;
mod place;
mod recording;
mod rescue;
mod staged;
mod stdio;
mod temporary;

pub use error::OutputError;
pub use recording::Recording;
pub use rescue::rescue;
pub use staged::Staged;
pub use stdio::{Stdout, reader_left, say};
pub use temporary::remove_all_for_good;

use identity::Identity;
use place::Place;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use zerorate_data::CaptureError;
use zerorate_host::files;

/// The files of one run of a command.
#[derive(Debug)]
pub struct Outputs {
    force: bool,
    inputs: Vec<(Identity, PathBuf)>,
    /// Outputs so far, and the standard streams.
    claimed: Vec<(Identity, String)>,
}

impl Outputs {
    /// A run that may overwrite files if `force`.
    pub fn new(force: bool) -> Self {
        let streams = stdio::files().into_iter().map(|(identity, name)| (identity, name.to_owned()));
        Self { force, inputs: Vec::new(), claimed: streams.collect() }
    }

    /// The run prints data as well, so that no file may be where stdout goes, be it a pipe.
    pub fn printing(mut self) -> Self {
        self.claimed.extend(stdio::stdout_pipe().map(|identity| (identity, stdio::STDOUT.to_owned())));
        self
    }

    /// The run reads these files. What does not exist fails when it is read, with a better message.
    ///
    /// # Errors
    /// [`OutputError::IsInput`] where stdout or stderr go into one of them.
    pub fn reading<'a>(mut self, inputs: impl IntoIterator<Item = &'a Path>) -> Result<Self, OutputError> {
        let known = inputs.into_iter().filter_map(|path| Some((Identity::of_file(path)?, path.to_owned())));
        self.inputs.extend(known);
        for (stream, name) in &self.claimed {
            self.refuse_input(stream, Path::new(name))?;
        }
        Ok(self)
    }

    /// Claims a file for what can be computed again: it takes its name when it is complete.
    ///
    /// # Errors
    /// Why it is refused ([`OutputError::is_refusal`]), or why it cannot be written.
    pub fn derived(&mut self, path: &Path) -> Result<Staged, OutputError> {
        let place = self.claim(path)?;
        if place.exists() {
            refuse_capture(path)?;
        }
        Staged::new(path, place)
    }

    /// Claims a file to record into, under its final name from the start, so that what was recorded survives a power
    /// cut.
    ///
    /// # Errors
    /// As [`Outputs::derived`].
    pub fn recording(&mut self, path: &Path) -> Result<Recording, OutputError> {
        let place = self.claim(path)?;
        Recording::new(path, place)
    }

    fn claim(&mut self, path: &Path) -> Result<Place, OutputError> {
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
        if place.exists() && !self.force {
            return Err(OutputError::Exists { path: path.to_owned() });
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

/// A capture cannot be had again. One that carries a calibration's id can: from the capture that it was made from.
fn refuse_capture(path: &Path) -> Result<(), OutputError> {
    let failed = |source| OutputError::io("look at", path, source);
    let is_capture = match files::capture(path) {
        Ok(reader) => reader.calibration_id().is_none(),
        Err(CaptureError::NotACapture { .. }) => was_capture(path).map_err(failed)?,
        Err(CaptureError::Io { source, .. }) => return Err(failed(source)),
        // damaged, or of a later version
        Err(_) => true,
    };
    if is_capture { Err(OutputError::IsCapture { path: path.to_owned() }) } else { Ok(()) }
}

/// Bytes at the start of a file, in which every form of a capture names itself.
const HEAD: u64 = 1 << 16;

/// Whether a file that cannot be read as a capture starts like one all the same.
fn was_capture(path: &Path) -> io::Result<bool> {
    let mut head = Vec::new();
    File::open(path)?.take(HEAD).read_to_end(&mut head)?;
    let starts_like_one =
        [&b"\xFF\xFF\xFF\xFF"[..], b"PAR1", b"# zerorate."].iter().any(|mark| head.starts_with(mark));
    Ok(starts_like_one && head.windows(NAME.len()).any(|window| window == NAME))
}

/// What begins the keys of a capture's description.
const NAME: &[u8] = b"zerorate.";
