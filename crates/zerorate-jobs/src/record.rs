//! Records the raw codes of a device: [`record`].

use crate::acquisition::Acquisition;
use crate::error::CodedRefusal;
use crate::output::Outputs;
use crate::recorder::Recorder;
use crate::warning::CodedWarning;
use anyhow::{Context, Result};
use serde::Serialize;
use std::path::PathBuf;
use zerorate::SettingNames;
use zerorate::calibration::Notes;
use zerorate::health::{FaultCounts, Health};
use zerorate_input::InputError;
use zerorate_record::{CaptureError, Format, Row, valid};

/// The settings of a recording.
#[derive(Clone, Debug)]
pub struct RecordOptions {
    /// The file to record into.
    pub output: PathBuf,
    /// The format of the file.
    pub format: Format,
    /// The length at which the recording ends.
    pub length: Length,
    /// Serial number of the part; `None` keeps the number that a replayed recording states.
    pub serial: Option<String>,
    /// Circumstances of the recording, as the user describes them.
    pub notes: Notes,
}

/// The duration or the number of samples of a recording.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Duration by the time stamps of the samples, ns.
    Time(u64),
    /// Number of samples.
    Samples(u64),
}

/// The progress of a recording.
#[derive(Clone, Copy, Debug)]
pub struct RecordProgress {
    /// Seconds between the time stamps of the first and the latest sample, or the number of samples, as in [`Length`].
    pub done: f64,
    /// Number of samples so far.
    pub samples: u64,
}

impl Length {
    /// The whole length, in the unit of [`RecordProgress::done`].
    #[must_use]
    pub fn total(self) -> f64 {
        match self {
            Self::Time(ns) => ns as f64 * 1e-9,
            Self::Samples(samples) => samples as f64,
        }
    }

    fn progress(self, elapsed_ns: u64, samples: u64) -> RecordProgress {
        let done = match self {
            Self::Time(_) => elapsed_ns as f64 * 1e-9,
            Self::Samples(_) => samples as f64,
        };
        RecordProgress { done, samples }
    }

    #[inline]
    fn is_reached(self, elapsed_ns: u64, samples: u64) -> bool {
        match self {
            Self::Time(ns) => elapsed_ns >= ns,
            Self::Samples(wanted) => samples >= wanted,
        }
    }
}

/// The result of a recording.
#[derive(Debug, Serialize)]
pub struct RecordReport {
    /// The path of the file.
    pub file: String,
    /// Number of samples in the file.
    pub samples: u64,
    /// Number of samples that were lost and that the file therefore lacks.
    pub lost_samples: u64,
    /// Samples per second.
    pub rate_hz: f64,
    /// Data-ready edges per second.
    pub rdy_hz: f64,
    /// Time from the first sample to the last, s.
    pub duration_s: f64,
    /// True if a stop was requested before the length was reached.
    pub interrupted: bool,
    /// Number of readings that the part cannot produce: bit errors.
    pub impossible_readings: u64,
    /// Number of temperatures that differ too much from the preceding temperatures.
    pub impossible_temps: u64,
    /// Number of readings out of range.
    pub out_of_range: u64,
    /// Number of readings that were not checked: their neighbours are too far away, or the part's limits are unknown.
    pub unjudged: u64,
    /// True if the readings were frozen at the end: the part had stopped measuring.
    pub frozen: bool,
    /// The warnings about the samples.
    pub warnings: Vec<CodedWarning>,
    #[serde(skip)]
    why_frozen: Option<String>,
}

impl RecordReport {
    /// Refuses a recording whose last readings are frozen. The file is complete and stays.
    ///
    /// # Errors
    /// Returns [`CodedRefusal`] if the readings were frozen at the end.
    pub fn refuse_frozen(&self) -> Result<(), CodedRefusal> {
        match &self.why_frozen {
            None => Ok(()),
            Some(why) => {
                let file = &self.file;
                Err(CodedRefusal::new("frozen", format!("{why}; {file} holds the raw codes up to the end")))
            }
        }
    }
}

/// Initialises the part and records its samples until the length is reached, the replayed recording ends, or a stop
/// is requested. `show` receives the progress every 4096 samples. Warnings use `names` for the settings.
///
/// # Errors
/// Returns an error if the device or the file fails. A file that was started holds the samples up to that point.
pub fn record(
    acquisition: &mut Acquisition,
    outputs: &mut Outputs,
    options: &RecordOptions,
    names: SettingNames,
    show: &mut dyn FnMut(RecordProgress),
) -> Result<RecordReport> {
    let info = acquisition.info(options.serial.as_deref(), &options.notes)?;
    acquisition.initialise()?;
    let file = outputs.recording(&options.output)?;
    let mut writer = Recorder::create(file, options.format, &info)?;
    let recorded = follow(acquisition, options.length, show, |row| Ok(writer.push(row)?));
    let saved = writer.finish().map_err(|error| with_rescue(error, options))?.samples;
    let is_whole = recorded.with_context(|| format!("{} ends after {saved} samples", options.output.display()))?;
    Ok(report(acquisition, options, is_whole, names))
}

/// Adds how to keep the samples of a file that could not be written further, as on a full disk.
fn with_rescue(error: CaptureError, options: &RecordOptions) -> anyhow::Error {
    let is_cut = matches!(error, CaptureError::Input(InputError::Io { action: "write", .. }));
    let error = anyhow::Error::from(error);
    // nothing can be read of a Parquet file without its end
    if !is_cut || options.format == Format::Parquet || !options.output.is_file() {
        return error;
    }
    let file = options.output.display();
    error.context(format!(
        "{file} is not complete (`zerorate repair {file} -o NEW.arrows` keeps the whole seconds before, if any)"
    ))
}

/// Returns true if the length was reached.
fn follow(
    acquisition: &mut Acquisition,
    length: Length,
    show: &mut dyn FnMut(RecordProgress),
    mut take: impl FnMut(&Row) -> Result<()>,
) -> Result<bool> {
    let mut first_ns = None;
    while let Some(row) = acquisition.next_row()? {
        take(&row)?;
        acquisition.look_at(&row);
        let elapsed_ns = row.t_ns.saturating_sub(*first_ns.get_or_insert(row.t_ns));
        let samples = acquisition.tally().samples;
        if length.is_reached(elapsed_ns, samples) {
            return Ok(true);
        }
        if acquisition.is_time_to_show() {
            show(length.progress(elapsed_ns, samples));
        }
    }
    Ok(false)
}

fn report(
    acquisition: &mut Acquisition,
    options: &RecordOptions,
    is_whole: bool,
    names: SettingNames,
) -> RecordReport {
    let warnings = acquisition.warnings().into_iter().map(|warning| warning.coded(names)).collect();
    let counts: Vec<&FaultCounts> = acquisition.healths().map(Health::fault_counts).collect();
    let sum = |count: fn(&FaultCounts) -> u64| counts.iter().copied().map(count).sum();
    let tally = acquisition.tally();
    let frozen = acquisition.frozen_at_end();
    RecordReport {
        file: options.output.display().to_string(),
        samples: tally.samples,
        lost_samples: tally.lost,
        rate_hz: tally.rate_hz(),
        rdy_hz: tally.rdy_hz(),
        duration_s: tally.duration_s(),
        interrupted: !is_whole && acquisition.is_stopped(),
        impossible_readings: sum(|counts| counts.impossible),
        impossible_temps: sum(|counts| counts.impossible_temps),
        out_of_range: sum(|counts| counts.out_of_range),
        unjudged: sum(|counts| counts.unjudged),
        frozen: frozen.is_some(),
        warnings,
        why_frozen: frozen.map(|frozen| valid::frozen_text(&frozen, acquisition.start_ns())),
    }
}
