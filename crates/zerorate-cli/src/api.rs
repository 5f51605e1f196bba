//! What another program, such as the Python package, takes from this one: the measurement without its terminal.
//!
//! Nothing here prints or changes how the process handles signals.

pub use crate::exit::{Refused, Usage};

use crate::cli::{Cli, Command};
use crate::commands::calibrate;
use crate::exit;
use crate::output::Outputs;
use crate::progress::Watch;
use adis16130::Sample;
use anyhow::Result;
use clap::Parser;
use std::path::Path;
use zerorate::health::{Health, Judged};
use zerorate::{Calibration, Names, Progress, Reading, Tally};
use zerorate_data::believed;
use zerorate_host::files;

/// A calibration with its report.
#[derive(Clone, Debug)]
pub struct Calibrated {
    /// The object that `calibrate --json` prints.
    pub report_json: String,
    /// The calibration file (docs/formats/calibration.md).
    pub calibration_toml: String,
}

/// Runs the procedure of F-51 with the options of `zerorate calibrate`, as on the command line but for `--realtime`,
/// `--json` and progress. `keep_going` is asked with every 4096th sample (1.4 times a second of part time). What is
/// said calls settings by `names`.
///
/// # Errors
/// [`Usage`] where the options make no sense, [`Refused`] where the samples must not become a calibration, or why the
/// device or a file failed.
pub fn calibrate(options: &[String], names: Names, keep_going: impl FnMut() -> bool) -> Result<Calibrated> {
    let words = ["zerorate", "calibrate"].into_iter().chain(options.iter().map(String::as_str));
    match Cli::try_parse_from(words) {
        Ok(Cli { command: Command::Calibrate(args), .. }) => {
            let (report, calibration) = calibrate::measured(&args, &mut Caller { keep_going, names })?;
            let report_json = serde_json::to_string(&report)?;
            Ok(Calibrated { report_json, calibration_toml: calibration.to_toml() })
        }
        Ok(_) => Err(Usage("not the options of a calibration".to_owned()).into()),
        Err(error) => Err(Usage(error.to_string()).into()),
    }
}

/// Whoever called, looking on.
struct Caller<F> {
    keep_going: F,
    names: Names,
}

impl<F: FnMut() -> bool> Watch for Caller<F> {
    fn see(&mut self, _: &Progress) -> bool {
        (self.keep_going)()
    }

    fn names(&self) -> Names {
        self.names
    }
}

/// The samples of a capture as columns, one row per sample, with how they were taken.
#[derive(Clone, Debug, Default)]
pub struct Recording {
    /// Time of the data-ready edge, ns.
    pub t_ns: Vec<u64>,
    /// Number of the edge.
    pub edge_seq: Vec<u32>,
    /// Rate code, of [`Recording::width_bits`] bits.
    pub rate_code: Vec<u32>,
    /// Status register of the channel (F-35); −1 where it was not read.
    pub status: Vec<i16>,
    /// Temperature code, of the same width; −1 where it was not read.
    pub temp_code: Vec<i32>,
    /// Samples lost right before this one.
    pub lost: Vec<u32>,
    /// What is wrong with it, 0 for nothing: 1 impossible for the part, 2 out of range, 4 frozen, 8 impossible
    /// temperature.
    pub flags: Vec<u8>,
    /// Width of both codes, 16 or 24.
    pub width_bits: u32,
    /// The description in the file (docs/formats/capture.md).
    pub metadata: Vec<(String, String)>,
    /// The calibration that was applied, if the capture is a corrected one; its raw columns are untouched.
    pub calibration_id: Option<String>,
    /// What is to be said of the file: a torn tail, rows that nothing checks, readings that are not to be believed.
    pub warning: Option<String>,
}

/// Reads a capture, in any of its forms.
///
/// # Errors
/// Why the file cannot be read, or what in it is wrong and where.
pub fn read_capture(path: &Path) -> Result<Recording> {
    let mut reader = files::capture(path)?;
    let mut recording = Recording {
        width_bits: reader.info().width.bits(),
        metadata: reader.info().to_metadata().into_iter().collect(),
        calibration_id: reader.calibration_id().map(str::to_owned),
        ..Recording::default()
    };
    let (mut health, mut tally) = (Health::new(&reader.info().axis()), Tally::default());
    let flag = |judged: Judged| judged.flags.bits();
    while let Some(rows) = reader.next_rows()? {
        for sample in rows.samples() {
            recording.push(&sample);
            let reading = Reading::from(&sample);
            tally.count(&reading);
            recording.flags.extend(health.push(&reading).map(flag));
        }
    }
    recording.flags.extend(std::iter::from_fn(|| health.finish()).map(flag));
    let start_ns = recording.t_ns.first().copied().unwrap_or_default();
    let found = believed::warnings(&health, &tally, start_ns);
    recording.metadata.sort();
    let said: Vec<String> = reader.warnings().into_iter().chain(found).collect();
    recording.warning = (!said.is_empty()).then(|| said.join("; "));
    Ok(recording)
}

impl Recording {
    fn push(&mut self, sample: &Sample) {
        self.t_ns.push(sample.t_ns);
        self.edge_seq.push(sample.seq);
        self.rate_code.push(sample.rate.code());
        self.status.push(sample.status.map_or(-1, |status| status.bits().into()));
        // a code has 24 bits at most
        self.temp_code.push(sample.temp.map_or(-1, |temp| temp.code() as i32));
        self.lost.push(sample.lost);
    }
}

/// Writes the text of a calibration file, as `zerorate calibrate -o` does: whole, onto the disk, and over another only
/// if `force`.
///
/// # Errors
/// Why it is refused ([`refuses_output`]), or why it cannot be written.
pub fn save_calibration(path: &Path, text: &str, force: bool) -> Result<()> {
    Ok(Outputs::new(force).derived(path)?.fill(text.as_bytes())?)
}

/// Whether the error is that of a file that is there, and stays as it is: another name, or `--force`, is all that it
/// takes.
#[must_use]
pub fn refuses_output(error: &anyhow::Error) -> bool {
    exit::refuses_output(error)
}

/// What to say where temperatures from `low_c` to `high_c` leave the span of a calibration.
#[must_use]
pub fn extrapolation(calibration: &Calibration, low_c: f64, high_c: f64) -> Option<String> {
    calibration.validity?.warning(low_c, high_c).map(|warning| warning.to_string())
}
