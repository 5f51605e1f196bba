//! The standard streams: stdout, whose reader may leave, and stderr, which may be full.

use std::fmt::Display;
use std::io::{self, ErrorKind, StdoutLock, Write};
use zerorate_record::plain;

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
