//! The standard streams: stdout, whose reader may leave, and stderr, which may be full.

use super::identity::Identity;
use std::fmt::Display;
use std::io::{self, ErrorKind, StdoutLock, Write};
#[cfg(unix)]
use std::path::Path;
use zerorate_data::plain;

/// What stdout is called in messages.
pub const STDOUT: &str = "stdout";

/// The reader of stdout went away, as in `zerorate … | head`: the end of the run, and no failure.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("the reader of stdout is gone")]
struct ReaderLeft;

/// Prints a line for people to stderr, whatever stands in it. One that cannot be written must not end what the user
/// came for.
pub fn say(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{}", plain::line(&line.to_string()));
}

/// Stdout, for data. A pipe without reader is told from every other broken pipe by [`ReaderLeft`].
#[derive(Debug)]
pub struct Stdout(StdoutLock<'static>);

impl Stdout {
    /// Nobody else prints until this is dropped.
    pub fn lock() -> Self {
        Self(io::stdout().lock())
    }
}

impl Write for Stdout {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.write(bytes).map_err(marked)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.flush().map_err(marked)
    }
}

fn marked(error: io::Error) -> io::Error {
    match error.kind() {
        ErrorKind::BrokenPipe => io::Error::new(ErrorKind::BrokenPipe, ReaderLeft),
        _ => error,
    }
}

/// Whether the error is that of a reader of stdout that left.
pub fn reader_left(error: &anyhow::Error) -> bool {
    let is_mark = |error: &io::Error| error.get_ref().is_some_and(|inner| inner.is::<ReaderLeft>());
    error.chain().any(|cause| cause.downcast_ref().is_some_and(is_mark))
}

/// The standard streams that go into regular files, by name.
#[cfg(unix)]
pub fn files() -> Vec<(Identity, &'static str)> {
    let streams = [(metadata(io::stdout()), STDOUT), (metadata(io::stderr()), "stderr")];
    let file = |(metadata, name): (Option<std::fs::Metadata>, _)| {
        Some((Identity::of(&metadata.filter(std::fs::Metadata::is_file)?, Path::new(name))?, name))
    };
    streams.into_iter().filter_map(file).collect()
}

/// The pipe that stdout goes into.
#[cfg(unix)]
pub fn stdout_pipe() -> Option<Identity> {
    super::place::pipe(&metadata(io::stdout())?, Path::new(STDOUT))
}

/// The file that comes in through stdin, where it is one.
#[cfg(unix)]
pub fn stdin_file() -> Option<Identity> {
    Identity::of(&metadata(io::stdin()).filter(std::fs::Metadata::is_file)?, Path::new("stdin"))
}

#[cfg(unix)]
fn metadata(stream: impl std::os::fd::AsFd) -> Option<std::fs::Metadata> {
    let owned = stream.as_fd().try_clone_to_owned().ok()?;
    std::fs::File::from(owned).metadata().ok()
}

/// Elsewhere the streams have no names as files.
#[cfg(not(unix))]
pub fn files() -> Vec<(Identity, &'static str)> {
    Vec::new()
}

/// Elsewhere the streams have no names as files.
#[cfg(not(unix))]
pub fn stdout_pipe() -> Option<Identity> {
    None
}

/// Elsewhere the streams have no names as files.
#[cfg(not(unix))]
pub fn stdin_file() -> Option<Identity> {
    None
}
