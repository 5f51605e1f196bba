//! Where the readings of a calibration come from: a device, or a capture of any part.

use super::super::warn;
use crate::acquire::Acquisition;
use adis16130_twin::Truth;
use anyhow::{Context, Result, ensure};
use std::path::Path;
use zerorate::{Part, Tally, Warning, resonance};
use zerorate_data::capture::{CaptureInfo, CaptureReader, Layout, Row};
use zerorate_host::{Stop, files};

/// Rows of all axes, one after the other.
pub enum Feed {
    /// A device that is read by the driver, or its recording.
    Device(Box<Acquisition>),
    /// A capture of another part.
    Capture(Box<Replayed>),
}

/// A capture that is read to its end.
pub struct Replayed {
    reader: CaptureReader,
    info: CaptureInfo,
    part: Part,
    tally: Tally,
    stop: Stop,
}

impl Feed {
    /// The capture of a part that no driver reads; none where it is of the part that one does. `known` is what is known
    /// of the part beside its codes.
    pub fn of_another_part(path: &Path, known: Option<&Part>, stop: &Stop) -> Result<Option<Self>> {
        let reader = files::capture(path)?;
        let info = reader.info().clone();
        if info.converter.is_some() {
            return Ok(None);
        }
        let part = match known {
            Some(known) => info.part_from(known).with_context(|| path.display().to_string())?,
            None => info.part(),
        };
        let replayed = Replayed { reader, info, part, tally: Tally::default(), stop: stop.clone() };
        Ok(Some(Self::Capture(Box::new(replayed))))
    }

    /// A device, of which everything is known.
    pub fn device(acquisition: Acquisition, known: Option<&Part>) -> Result<Self> {
        let part = acquisition.part();
        ensure!(
            known.is_none_or(|known| known.name == part.name),
            "--part describes an {}, but what is read is an {}",
            known.map_or_else(String::new, |known| known.name.to_string()),
            part.name
        );
        Ok(Self::Device(Box::new(acquisition)))
    }

    /// What is measured, as far as it is known.
    pub fn part(&self) -> Part {
        match self {
            Self::Device(acquisition) => acquisition.part(),
            Self::Capture(replayed) => replayed.part.clone(),
        }
    }

    /// What the codes of a row mean.
    pub fn layout(&self) -> Layout {
        match self {
            Self::Device(acquisition) => acquisition.facts().info.layout.clone(),
            Self::Capture(replayed) => replayed.info.layout.clone(),
        }
    }

    /// How the rows were taken; serial number and note are those given, or else those of the recording.
    pub fn info(&self, serial: Option<&str>, supply_note: Option<&str>) -> CaptureInfo {
        let info = match self {
            Self::Device(acquisition) => return acquisition.info(serial, supply_note),
            Self::Capture(replayed) => replayed.info.clone(),
        };
        let or = |given: Option<&str>, recorded| given.map(str::to_owned).or(recorded);
        CaptureInfo { serial: or(serial, info.serial), supply_note: or(supply_note, info.supply_note), ..info }
    }

    /// Asks for the twin's truth so many ns after the first row.
    pub fn mark(&mut self, after_ns: u64) {
        if let Self::Device(acquisition) = self {
            acquisition.mark(after_ns);
        }
    }

    /// The twin's truth at the row that was taken last, if it was marked.
    pub fn truth(&self) -> Option<Truth> {
        match self {
            Self::Device(acquisition) => acquisition.truth(),
            Self::Capture(_) => None,
        }
    }

    /// Resets the part and initialises it, where there is one.
    pub fn initialise(&self) -> Result<()> {
        match self {
            Self::Device(acquisition) => acquisition.initialise().map(|_| ()),
            Self::Capture(_) => Ok(()),
        }
    }

    /// The next row; `None` at the end of a recording or where the reading was stopped.
    #[inline]
    pub fn next(&mut self) -> Result<Option<Row>> {
        match self {
            Self::Device(acquisition) => Ok(acquisition.next()?.as_ref().map(Row::from)),
            Self::Capture(replayed) => replayed.next(),
        }
    }

    /// F-07: whether the resonance of the first axis looks like a bias at the rate that was measured, in means over
    /// `average_s`.
    pub fn resonance(&self, average_s: f64) -> Option<Warning> {
        match self {
            Self::Device(acquisition) => acquisition.resonance(average_s),
            Self::Capture(replayed) => replayed.resonance(average_s),
        }
    }

    /// Whether progress is to be shown with this row.
    #[inline]
    pub fn is_time_to_show(&self) -> bool {
        match self {
            Self::Device(acquisition) => acquisition.is_time_to_show(),
            Self::Capture(replayed) => replayed.tally.samples.is_multiple_of(4096),
        }
    }
}

impl Replayed {
    fn next(&mut self) -> Result<Option<Row>> {
        if self.stop.asked() {
            return Ok(None);
        }
        let row = self.reader.next().transpose()?;
        match &row {
            Some(row) => {
                if let Some(reading) = self.info.layout.reading(row, 0) {
                    self.tally.count(&reading);
                }
            }
            None => warn(&self.reader.warnings()),
        }
        Ok(row)
    }

    fn resonance(&self, average_s: f64) -> Option<Warning> {
        let axis = self.part.axes.first().filter(|_| self.tally.samples > 1)?.axis;
        resonance::warning(&axis, self.tally.sampling_hz(), self.info.edges_per_reading(), average_s)
    }
}
