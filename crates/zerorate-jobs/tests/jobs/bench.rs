//! Devices, files and listeners of the tests.

use anyhow::Result;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use zerorate::health::Flags;
use zerorate::{Calibration, Plan, Progress, Setting, SettingNames};
use zerorate_host::{Pace, Sampling, Setup, Stop};
use zerorate_jobs::calibrate::{AxisNumbers, Files, OutputOptions, RunResult, Watch, prepare};
use zerorate_jobs::correct;
use zerorate_jobs::output::Outputs;
use zerorate_jobs::stream::{LearnedAxis, Listener, StreamOptions, StreamRow, stream};
use zerorate_jobs::{Acquisition, CodedWarning, JobWarning};
use zerorate_record::{CaptureWriter, Format};

pub use zerorate_jobs::refusal_code as refusal;

pub struct Folder(TempDir);

impl Folder {
    pub fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> PathBuf {
        fs::write(self.path(name), content).unwrap();
        self.path(name)
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    pub fn names(&self) -> Vec<String> {
        let entries = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<_> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

pub fn replay(path: &Path) -> String {
    format!("replay:{}", path.display())
}

pub fn open(device: &str) -> Acquisition {
    sampled(device, Sampling::default())
}

pub fn sampled(device: &str, sampling: Sampling) -> Acquisition {
    let setup = Setup { sampling, ..Setup::default() };
    Acquisition::open(&device.parse().unwrap(), setup, Pace::Free, &Stop::default(), Box::new(|_| {})).unwrap()
}

/// A plan of less than four minutes of simulated time. It allows a large uncertainty of the BTC.
pub fn short() -> Plan {
    let (warmup_s, settle_s, max_u_btc_dps_per_c) = (60.0, 120.0, 0.2);
    Plan { average_s: 2.0, warmup_s, settle_s, offset_s: 20.0, max_u_btc_dps_per_c, ..Plan::default() }
}

struct Quiet;

impl Watch for Quiet {
    fn see(&mut self, _: &Progress) -> bool {
        true
    }

    fn warn(&mut self, _: JobWarning) {}

    fn names(&self) -> SettingNames {
        Setting::name
    }
}

/// Calibrates, and overwrites output files that exist.
pub fn keep(device: &str, plan: Plan, kept: OutputOptions) -> Result<RunResult> {
    let files = Files::claim(Outputs::new(true), kept)?;
    let done = prepare(open(device), plan, files, Setting::name)?.run(&mut Quiet)?;
    done.delivery.as_ref().unwrap();
    Ok(done)
}

pub fn calibrate(device: &str, plan: Plan) -> Result<RunResult> {
    keep(device, plan, OutputOptions::default())
}

/// The numbers of a part with one axis.
pub fn only(done: &RunResult) -> &AxisNumbers {
    done.report.only.as_ref().unwrap()
}

/// Records `seconds` of the device into `path`. Returns the finished acquisition.
pub fn record(device: &str, sampling: Sampling, seconds: f64, path: &Path) -> Acquisition {
    let mut acquisition = sampled(device, sampling);
    acquisition.initialise().unwrap();
    let format = Format::choose(None, path).unwrap();
    let out = Box::new(File::create(path).unwrap());
    let mut writer = CaptureWriter::create(path, out, format, &acquisition.facts().info).unwrap();
    while let Some(row) = acquisition.next_row().unwrap() {
        writer.push(&row).unwrap();
        acquisition.look_at(&row);
        if acquisition.tally().duration_s() >= seconds {
            break;
        }
    }
    writer.finish().unwrap();
    acquisition
}

/// A calibration with the coefficients PBC, BTC and T3, from a file that ends with the lines `more`.
pub fn calibration(schema: u32, coefficients: [f64; 3], more: &str) -> Calibration {
    let [pbc, btc, t3] = coefficients;
    let text = format!(
        "schema = {schema}\npart = \"ADIS16130\"\n[correction]\npbc_dps = {pbc:?}\nbtc_dps_per_c = {btc:?}\n\
         t3_c = {t3:?}\n{more}"
    );
    Calibration::parse(&text).unwrap().0
}

pub fn corrected(capture: &Path, calibration: &Calibration, output: &Path) -> Result<Vec<JobWarning>> {
    let mut outputs = Outputs::new(true);
    let reader = outputs.capture(capture)?;
    let part = reader.info().part();
    let job = correct::Job::new(capture, reader, &part, calibration)?;
    let (staged, format) = (outputs.derived(output)?, Format::choose(None, output)?);
    let mut warnings = Vec::new();
    job.run(staged, format, &Stop::default(), Setting::name, &mut |warning| warnings.push(warning))?;
    Ok(warnings)
}

/// The cells of a CSV, without its head.
pub fn cells(text: &str) -> Vec<Vec<&str>> {
    text.lines().filter(|line| !line.starts_with('#')).skip(1).map(|line| line.split(',').collect()).collect()
}

#[derive(Default)]
pub struct StreamLog {
    pub rows: Vec<StreamRow>,
    pub warnings: Vec<JobWarning>,
}

impl Listener for StreamLog {
    fn row(&mut self, row: &StreamRow) -> Result<()> {
        self.rows.push(row.clone());
        Ok(())
    }

    fn end(&mut self) -> Result<()> {
        Ok(())
    }

    fn warn(&mut self, warning: JobWarning) {
        self.warnings.push(warning);
    }

    fn kept_again(&mut self, _: &Path) {}

    fn learned(&mut self, _: &LearnedAxis<'_>) {}
}

impl StreamLog {
    pub fn with(&self, flags: Flags) -> usize {
        self.rows.iter().filter(|row| row.flags.has(flags)).count()
    }
}

/// Streams for `seconds`, with a row every `every_s` seconds, or a row for each sample if `every_s` is 0.
pub fn streamed(device: &str, calibration: &Calibration, seconds: f64, every_s: f64) -> (StreamLog, Result<()>) {
    let acquisition = open(device);
    acquisition.initialise().unwrap();
    let ns = |s: f64| Some((s * 1e9) as u64).filter(|ns| *ns > 0);
    let options = StreamOptions { period_ns: ns(every_s), duration_ns: ns(seconds) };
    let mut streamed = StreamLog::default();
    let ended = stream(acquisition, calibration, options, None, &mut streamed);
    (streamed, ended)
}

pub fn codes(warnings: &[JobWarning]) -> Vec<&'static str> {
    warnings.iter().map(JobWarning::code).collect()
}

pub fn has(warnings: &[CodedWarning], code: &str) -> bool {
    warnings.iter().any(|warning| warning.to_string().starts_with(&format!("{code}: ")))
}
