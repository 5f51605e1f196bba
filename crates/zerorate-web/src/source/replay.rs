//! A recording that was dropped on the page.

use super::{Next, Source};
use crate::session::{About, NoticeText};
use std::path::Path;
use zerorate_input::Input;
use zerorate_record::{CaptureError, CaptureInfo, CaptureReader};

/// A recording that is replayed as fast as its readings are taken.
pub struct Replay {
    about: About,
    reader: CaptureReader,
    notes: Vec<NoticeText>,
}

impl Replay {
    /// Opens a capture of this name.
    ///
    /// # Errors
    /// Returns an error if the file is not a capture, or is damaged.
    pub fn open(name: &str, input: Input) -> Result<Self, String> {
        let reader = CaptureReader::open(Path::new(name), input).map_err(|error| match error {
            CaptureError::NotACapture { .. } => {
                format!("{error}; for a log of other software name its part, as docs/formats/part.md says")
            }
            error => error.to_string(),
        })?;
        let info: CaptureInfo = reader.info().clone();
        let about = About {
            name: format!("replay:{name}"),
            part: info.part(),
            simulated: true,
            nominal_hz: None,
            registers: Vec::new(),
            checks: Vec::new(),
            info,
        };
        Ok(Self { about, reader, notes: Vec::new() })
    }
}

impl Source for Replay {
    fn about(&self) -> About {
        self.about.clone()
    }

    fn next(&mut self) -> Result<Next, String> {
        match self.reader.next() {
            Some(Ok(row)) => Ok(Next::Row(row)),
            Some(Err(error)) => Err(error.to_string()),
            None => {
                self.notes =
                    self.reader.warnings().iter().map(|warning| NoticeText::new(warning.code(), warning)).collect();
                Ok(Next::Ended)
            }
        }
    }

    fn notes(&mut self) -> Vec<NoticeText> {
        std::mem::take(&mut self.notes)
    }
}
