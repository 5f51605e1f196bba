//! A capture as columns, for computations.

use anyhow::Result;
use std::path::Path;
use zerorate::health::Health;
use zerorate::{Scale, Tally};
use zerorate_host::files;
use zerorate_record::{CaptureInfo, CaptureWarning, Layout, Row, valid};

/// The samples of a capture as columns, one row per sample, with the description of the capture.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Time of each sample's data-ready edge, ns.
    pub t_ns: Vec<u64>,
    /// Running number of each sample's data-ready edge.
    pub edge_seq: Vec<u32>,
    /// The type name of the part.
    pub part: String,
    /// The readings of each axis, in the order of the file.
    pub axes: Vec<RecordedAxis>,
    /// Status register of each sample; −1 if it was not read. For an ADIS16130 it is the channel status (F-35).
    pub status: Vec<i64>,
    /// Temperature code of each sample; `None` if it was not read.
    pub temp_code: Vec<Option<i64>>,
    /// The scale of the temperature codes; `Some` for every capture that was read.
    pub temp: Option<Scale>,
    /// Number of samples lost right before each sample.
    pub lost: Vec<u32>,
    /// The keys and values that describe the capture, sorted by key (docs/formats/capture.md).
    pub metadata: Vec<(String, String)>,
    /// The id of the applied calibration; `None` if the capture is not corrected.
    pub calibration_id: Option<String>,
    /// The warnings about the file: a torn tail, rows without checksums, readings that cannot be trusted.
    pub notes: Vec<CaptureWarning>,
}

/// The readings of one axis.
#[derive(Clone, Debug)]
pub struct RecordedAxis {
    /// The name of the axis in the part.
    pub name: String,
    /// The rate code of each sample.
    pub codes: Vec<i64>,
    /// The scale of the codes, in °/s.
    pub scale: Scale,
    /// The fault bits of each reading, 0 if valid: 1 impossible, 2 out of range, 4 frozen, 8 impossible temperature.
    pub flags: Vec<u8>,
    health: Health,
}

/// Reads a capture in any supported format.
///
/// # Errors
/// Returns an error, with the place in the file, if the file cannot be read or its content is not valid.
pub fn read_capture(path: &Path) -> Result<Recording> {
    let mut reader = files::capture(path)?;
    let info = reader.info().clone();
    let mut recording = Recording::of(&info);
    recording.calibration_id = reader.calibration_id().map(str::to_owned);
    let mut tally = Tally::default();
    while let Some(rows) = reader.next_rows()? {
        for row in rows.iter() {
            recording.push(&row, &info.layout);
            info.layout.reading(&row, 0).iter().for_each(|reading| tally.count(reading));
        }
    }
    recording.axes.iter_mut().for_each(RecordedAxis::finish);
    let start_ns = recording.t_ns.first().copied().unwrap_or_default();
    let axes = recording.axes.iter().map(|axis| (axis.name.as_str(), &axis.health));
    let found = valid::of_axes(axes, &tally, start_ns);
    recording.notes = reader.warnings().into_iter().chain(found).collect();
    Ok(recording)
}

impl Recording {
    fn of(info: &CaptureInfo) -> Self {
        let mut metadata: Vec<_> = info.to_metadata().into_iter().collect();
        metadata.sort();
        let known = info.part();
        let axes = known.axes.iter().zip(info.layout.axes()).map(|(named, coded)| RecordedAxis {
            name: coded.name.clone(),
            codes: Vec::new(),
            scale: coded.scale_dps(),
            flags: Vec::new(),
            health: Health::new(&named.axis),
        });
        let part = info.layout.part_name().to_owned();
        Self { part, axes: axes.collect(), temp: Some(*info.layout.temp()), metadata, ..Self::default() }
    }

    fn push(&mut self, row: &Row, layout: &Layout) {
        self.t_ns.push(row.t_ns);
        self.edge_seq.push(row.edge_seq);
        for (index, (axis, code)) in self.axes.iter_mut().zip(row.codes()).enumerate() {
            axis.codes.push(*code);
            let judged = layout.reading(row, index).and_then(|reading| axis.health.push(&reading));
            axis.flags.extend(judged.map(|judged| judged.flags.bits()));
        }
        self.status.push(row.status.map_or(-1, i64::from));
        self.temp_code.push(row.temp_code);
        self.lost.push(row.lost);
    }
}

impl RecordedAxis {
    fn finish(&mut self) {
        while let Some(judged) = self.health.finish() {
            self.flags.push(judged.flags.bits());
        }
    }
}
