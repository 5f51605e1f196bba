//! A recording in place of a part.

use crate::output::say;
use adis16130::Sample;
use anyhow::Result;
use zerorate_data::capture::CaptureReader;

/// A recording.
pub struct Replay {
    pub reader: CaptureReader,
    warned: bool,
}

impl Replay {
    pub fn new(reader: CaptureReader) -> Self {
        Self { reader, warned: false }
    }

    /// The next sample; `None` at the end.
    #[inline]
    pub fn next(&mut self) -> Result<Option<Sample>> {
        let sample = self.reader.next().transpose()?;
        if sample.is_none() {
            self.warn_once();
        }
        Ok(sample)
    }

    #[cold]
    fn warn_once(&mut self) {
        for warning in self.reader.warnings().into_iter().filter(|_| !self.warned) {
            say(format_args!("warning: {warning}"));
        }
        self.warned = true;
    }
}
