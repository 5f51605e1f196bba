//! A recording in place of a part.

use crate::error::Told;
use crate::kinds::{Address, Parsed};
use crate::source::{Facts, Sampling, Source, nominal_rate_hz};
use crate::{Result, Stop, files};
use adis16130::{MCLK_HZ, Sample};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zerorate_data::capture::CaptureReader;

/// `replay:FILE`; the file may be called what it likes.
#[derive(Clone, Debug)]
pub struct ReplayAddress {
    pub path: PathBuf,
}

impl ReplayAddress {
    pub fn parse(path: &str) -> Parsed {
        match path {
            "" => Err("replay: needs the file, as in replay:unit.arrows".to_owned()),
            path => Ok(Arc::new(Self { path: path.into() })),
        }
    }
}

impl Address for ReplayAddress {
    fn open(&self, _: &str, sampling: Sampling, _: &Stop) -> Result<Box<dyn Source>> {
        if sampling != Sampling::default() {
            let why = "--every-temp and --divider were decided when the recording was made; leave them out";
            return Err(Told::request(why).into());
        }
        Ok(Box::new(Replay { reader: files::capture(&self.path)?, notes: Vec::new() }))
    }

    fn file(&self) -> Option<&Path> {
        Some(&self.path)
    }
}

/// A recording.
struct Replay {
    reader: CaptureReader,
    notes: Vec<String>,
}

impl Source for Replay {
    fn facts(&self) -> Facts {
        let info = self.reader.info().clone();
        let name = format!("recording of {}", info.device);
        let rate_hz = nominal_rate_hz(&info, MCLK_HZ);
        Facts { name, info, framing: None, is_real: false, rate_hz, mclk_hz: MCLK_HZ }
    }

    #[inline]
    fn next(&mut self) -> Result<Option<Sample>> {
        let sample = self.reader.next().transpose()?;
        if sample.is_none() {
            self.notes = self.reader.warnings();
        }
        Ok(sample)
    }

    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}
