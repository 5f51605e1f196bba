//! A recording in place of a part.

use crate::error::Told;
use crate::kinds::{Address, Parsed};
use crate::source::{Facts, Sampling, Source, nominal_rate_hz};
use crate::{Result, Stop, files};
use adis16130::{ChannelStatus, MCLK_HZ, RateCode, Sample, TempCode};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use zerorate_data::capture::{CaptureReader, Converter, Row};

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
        let reader = files::capture(&self.path)?;
        let Some(converter) = reader.info().converter else {
            let part = reader.info().layout.part_name();
            return Err(
                Told::request(format!("a capture of an ADIS16130 is replayed, and that is one of an {part}")).into()
            );
        };
        Ok(Box::new(Replay { reader, converter, notes: Vec::new() }))
    }

    fn file(&self) -> Option<&Path> {
        Some(&self.path)
    }
}

/// A recording.
struct Replay {
    reader: CaptureReader,
    converter: Converter,
    notes: Vec<String>,
}

impl Source for Replay {
    fn facts(&self) -> Facts {
        let info = self.reader.info().clone();
        let name = format!("recording of {}", info.device);
        let rate_hz = nominal_rate_hz(&info, self.converter, MCLK_HZ);
        Facts { name, info, framing: None, is_real: false, rate_hz, mclk_hz: MCLK_HZ }
    }

    #[inline]
    fn next(&mut self) -> Result<Option<Sample>> {
        let row = self.reader.next().transpose()?;
        if row.is_none() {
            self.notes = self.reader.warnings();
        }
        Ok(row.map(|row| sample(&row, self.converter)))
    }

    fn take_notes(&mut self) -> Vec<String> {
        std::mem::take(&mut self.notes)
    }
}

/// The codes of an ADIS16130 have 24 bits at most, its status 8.
#[inline]
fn sample(row: &Row, Converter { width, .. }: Converter) -> Sample {
    Sample {
        t_ns: row.t_ns,
        seq: row.edge_seq,
        rate: RateCode::new(row.codes().first().map_or(0, |code| *code as u32), width),
        status: row.status.map(|status| ChannelStatus::new(status as u8)),
        temp: row.temp_code.map(|code| TempCode::new(code as u32, width)),
        lost: row.lost,
    }
}
