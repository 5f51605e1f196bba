//! The standard streams: the reader of stdout may leave, and stderr may be full.

use std::fmt::Display;
use std::io::{self, ErrorKind, StdoutLock, Write};
use zerorate_input::plain;

/// The reader of stdout left, as in `zerorate … | head`. This ends the run but is not a failure.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("the reader of stdout is gone")]
struct ReaderLeft;

/// Prints a line for people to stderr, without control characters. A line that cannot be written must not end the
/// measurement.
pub fn say(line: impl Display) {
    let _ = writeln!(io::stderr().lock(), "{}", plain::line(&line.to_string()));
}

/// Stdout, for data. [`ReaderLeft`] distinguishes its broken pipe from every other one.
#[derive(Debug)]
pub struct Stdout(StdoutLock<'static>);

impl Stdout {
    /// Locks stdout: nothing else prints until this is dropped.
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

/// Whether the error says that the reader of stdout left.
pub fn reader_left(error: &anyhow::Error) -> bool {
    let is_mark = |error: &io::Error| error.get_ref().is_some_and(|inner| inner.is::<ReaderLeft>());
    error.chain().any(|cause| cause.downcast_ref().is_some_and(is_mark))
}
