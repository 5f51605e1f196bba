//! The standard streams. Writing may fail: the reader of stdout may close the pipe, and stderr may be full.

use clap::builder::styling::{AnsiColor, Style};
use indicatif::ProgressBar;
use std::fmt::Display;
use std::io::{self, ErrorKind, IsTerminal, StdoutLock, Write};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};
use zerorate_input::plain;

/// The reader of stdout closed the pipe, as in `zerorate … | head`. This error ends the run but is not a failure.
#[derive(Clone, Copy, Debug, thiserror::Error)]
#[error("the reader of stdout is gone")]
struct ReaderLeft;

/// The progress bar on stderr, if there is one.
static BAR: Mutex<Option<ProgressBar>> = Mutex::new(None);

fn bar() -> MutexGuard<'static, Option<ProgressBar>> {
    BAR.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Shows a progress bar. Lines that [`say`] prints afterwards appear above it.
pub fn show(new: &ProgressBar) {
    *bar() = Some(new.clone());
}

pub fn clear() {
    if let Some(bar) = bar().take() {
        bar.finish_and_clear();
    }
}

/// Prints a line for people to stderr, without control characters. A failure to write is ignored, since the
/// measurement must go on.
pub fn say(line: impl Display) {
    let line = line.to_string();
    let line = painted(&plain::line(&line));
    let write = || drop(writeln!(io::stderr().lock(), "{line}"));
    match &*bar() {
        Some(bar) => bar.suspend(write),
        None => write(),
    }
}

/// The first words of lines, with their styles on a terminal.
const LABELS: [(&str, Style); 4] = [
    ("error:", AnsiColor::Red.on_default().bold()),
    ("refused:", AnsiColor::Red.on_default().bold()),
    ("warning:", AnsiColor::Yellow.on_default().bold()),
    ("  tip:", AnsiColor::Green.on_default()),
];

fn painted(line: &str) -> String {
    static IS_COLOURED: OnceLock<bool> = OnceLock::new();
    let set = |name| std::env::var_os(name).filter(|value| !value.is_empty());
    let understands = || match cfg!(windows) {
        true => set("WT_SESSION").is_some(),
        false => set("TERM").is_some_and(|term| term != "dumb"),
    };
    let wanted = || io::stderr().is_terminal() && set("NO_COLOR").is_none() && understands();
    let label = LABELS.iter().find_map(|(label, style)| Some((label, style, line.strip_prefix(label)?)));
    match label {
        Some((label, style, rest)) if *IS_COLOURED.get_or_init(wanted) => format!("{style}{label}{style:#}{rest}"),
        _ => line.to_owned(),
    }
}

/// The error where data cannot be written to stdout, without its cause.
pub const CANNOT_WRITE: &str = "cannot write to stdout";

/// Stdout for data. If the reader closes the pipe, the error is [`ReaderLeft`], unlike that of any other closed pipe.
#[derive(Debug)]
pub struct Stdout(StdoutLock<'static>);

impl Stdout {
    /// Locks stdout until the returned value is dropped. Removes the progress bar, which would be mixed with the data.
    pub fn lock() -> Self {
        clear();
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

pub fn reader_left(error: &anyhow::Error) -> bool {
    let is_mark = |error: &io::Error| error.get_ref().is_some_and(|inner| inner.is::<ReaderLeft>());
    error.chain().any(|cause| cause.downcast_ref().is_some_and(is_mark))
}
