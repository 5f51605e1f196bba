//! Replays a recording as a device.

use crate::address::Address;
use crate::error::UserError;
use crate::source::{DeviceInfo, Sampling, Setup, Source, nominal_rate_hz, part_of};
use crate::warning::SourceWarning;
use crate::{Result, RowReader, Stop, files};
use adis16130::MCLK_HZ;
use std::path::{Path, PathBuf};
use zerorate::{Part, Setting};
use zerorate_record::Row;

/// The address `replay:FILE`, where FILE may have any name.
#[derive(Clone, Debug)]
pub struct ReplayAddress {
    pub path: PathBuf,
}

impl ReplayAddress {
    pub fn read(path: &str) -> Result<Self, String> {
        match path {
            "" => Err("replay: needs the file, as in replay:unit.arrows".to_owned()),
            path => Ok(Self { path: path.into() }),
        }
    }
}

impl Address for ReplayAddress {
    fn open(&self, _: &str, setup: &Setup, _: &Stop) -> Result<Box<dyn Source>> {
        if setup.sampling != Sampling::default() {
            let [every_temp, divider] = [Setting::EveryTemp, Setting::Divider].map(setup.names);
            let why = "were decided when the recording was made; leave them out";
            return Err(UserError::request(format!("{every_temp} and {divider} {why}")).into());
        }
        let reader = files::rows(&self.path, setup.part.as_ref())?;
        let part = part_of(reader.info(), setup.part.as_ref())?;
        Ok(Box::new(Replay { reader, part, notes: Vec::new() }))
    }

    fn file(&self) -> Option<&Path> {
        Some(&self.path)
    }
}

struct Replay {
    reader: RowReader,
    part: Part,
    notes: Vec<SourceWarning>,
}

impl Source for Replay {
    fn facts(&self) -> DeviceInfo {
        let info = self.reader.info().clone();
        let name = format!("recording of {}", info.device);
        let rate_hz = nominal_rate_hz(&info, MCLK_HZ);
        DeviceInfo { name, info, part: self.part.clone(), framing: None, is_real: false, rate_hz, mclk_hz: MCLK_HZ }
    }

    #[inline]
    fn next(&mut self) -> Result<Option<Row>> {
        let row = self.reader.next().transpose()?;
        if row.is_none() {
            self.notes = self.reader.warnings().into_iter().map(SourceWarning::Log).collect();
        }
        Ok(row)
    }

    fn take_notes(&mut self) -> Vec<SourceWarning> {
        std::mem::take(&mut self.notes)
    }
}
