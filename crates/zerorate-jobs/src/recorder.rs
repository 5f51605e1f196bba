//! Recordings on disk.

use crate::output::Recording;
use std::io;
use zerorate::Calibration;
use zerorate_host::{DeviceInfo, clock};
use zerorate_record::{CaptureError, CaptureInfo, CaptureSummary, CaptureWriter, Format, RobotLog, Row, Stamps};

/// Records samples into a file, and puts it onto the disk. Dropping it closes the file as well, but only
/// [`Recorder::finish`] tells whether that worked.
pub struct Recorder {
    writer: CaptureWriter,
    file: Recording,
}

impl Recorder {
    /// Starts a capture of this device in an empty file. What robots read in a bag is corrected with `calibration`, if
    /// there is one; rows are codes in any form.
    pub fn create(
        file: Recording,
        format: Format,
        facts: &DeviceInfo,
        info: &CaptureInfo,
        calibration: Option<Calibration>,
    ) -> Result<Self, CaptureError> {
        let out = Box::new(file.file().map_err(|error| CaptureError::io("write", file.path(), error))?);
        let writer = match format {
            Format::Mcap => {
                let log = RobotLog { part: facts.part.clone(), calibration, stamps: stamps(facts, info) };
                CaptureWriter::create_robot_log(file.path(), out, info, log)
            }
            format => CaptureWriter::create(file.path(), out, format, info),
        };
        Ok(Self { writer: writer?, file })
    }

    /// Records a sample. Whole batches go to the system at once.
    pub fn push(&mut self, row: &Row) -> Result<(), CaptureError> {
        self.writer.push(row)
    }

    /// Writes the rest and puts the file onto the disk.
    pub fn finish(self) -> Result<CaptureSummary, CaptureError> {
        let path = self.file.path().to_owned();
        let put = |error: io::Error| CaptureError::io("put onto the disk:", &path, error);
        let summary = self.writer.finish();
        let synced = self.file.finish().map_err(put);
        let summary = summary?;
        synced.map(|()| summary)
    }
}

/// The time of day of a part that is here; a recording began when it says, and the twin has no such time.
fn stamps(facts: &DeviceInfo, info: &CaptureInfo) -> Stamps {
    let created: Option<jiff::Timestamp> = info.created.parse().ok();
    let ns = |time: jiff::Timestamp| u64::try_from(time.as_nanosecond()).ok();
    let now = move || clock::now().and_then(ns);
    // a time that no stamp can state, before 1970 or after 2554, is not stated as another
    match (created.and_then(ns), now()) {
        (_, Some(began)) if facts.is_real => Stamps::Now(Box::new(move || now().unwrap_or(began))),
        (Some(created), _) if !facts.is_real => Stamps::From(created),
        _ => Stamps::OfPart,
    }
}
