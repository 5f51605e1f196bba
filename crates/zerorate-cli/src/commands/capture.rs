//! `zerorate capture`: records raw codes with timestamps.

use super::serial::{NotesArgs, one_line};
use crate::device::{DeviceArgs, SamplingArgs};
use crate::exit::CodedRefusal;
use crate::interrupt;
use crate::output::{Outputs, print_json, print_lines, warn};
use crate::progress::Meter;
use crate::wording::{coded, form};
use anyhow::{Context, Result};
use clap::Args;
use serde::Serialize;
use std::path::PathBuf;
use zerorate::health::{FaultCounts, Health};
use zerorate_jobs::{Acquisition, CodedWarning, Recorder};
use zerorate_record::valid;
use zerorate_record::{Format, Row};
use zerorate_view::duration::{self, Seconds};

/// Record raw codes with timestamps to a file
///
/// Every code is recorded as it was read. Impossible readings (bit errors), readings out of range and a sensor that
/// stopped are counted and reported. If the sensor had stopped at the end, the exit code is 3.
///
/// Ctrl-C ends a recording early, and the file is complete. An .arrows file can be read up to its last whole batch
/// even after a power cut.
#[derive(Args, Debug)]
pub struct CaptureArgs {
    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// The file to record to.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Time to record: 10s, 10m, 1h30m, or seconds.
    #[arg(long, value_name = "TIME", default_value = "10m", conflicts_with = "samples")]
    #[arg(value_parser = duration::above_zero)]
    duration: Seconds,

    /// Record this many samples instead.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    samples: Option<u64>,

    /// The form of the file [default: as its ending states, or arrows without an ending].
    #[arg(long, value_enum)]
    format: Option<Format>,

    /// The serial number of the sensor, stored with the samples.
    #[arg(long, value_name = "SN", value_parser = one_line)]
    serial: Option<String>,

    #[command(flatten)]
    notes: NotesArgs,

    /// Overwrite an existing file, but never the file that is replayed.
    #[arg(long)]
    force: bool,

    /// Print the summary as one JSON object.
    #[arg(long)]
    json: bool,
}

/// The summary of a recording.
#[derive(Serialize)]
struct Summary {
    file: String,
    samples: u64,
    lost_samples: u64,
    rate_hz: f64,
    rdy_hz: f64,
    duration_s: f64,
    interrupted: bool,
    /// Readings that the part cannot have made: bit errors.
    impossible_readings: u64,
    /// Temperatures that the part cannot have measured.
    impossible_temps: u64,
    out_of_range: u64,
    /// Readings too far apart to be judged.
    unjudged: u64,
    /// Whether the part had stopped at the end.
    frozen: bool,
    warnings: Vec<CodedWarning>,
}

pub fn run(args: &CaptureArgs) -> Result<()> {
    let format = form(args.format, &args.output)?;
    let mut outputs = Outputs::new(args.force).printing();
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    let mut acquisition = args.device.open(setup)?;
    let info = acquisition.info(args.serial.as_deref(), &args.notes.clone().into())?;
    acquisition.initialise()?;
    let file = outputs.recording(&args.output)?;
    let mut writer = Recorder::create(file, format, &info)?;
    let recorded = record(args, &mut acquisition, |row| Ok(writer.push(row)?));
    let saved = writer.finish()?.samples;
    recorded.with_context(|| format!("{} ends after {saved} samples", args.output.display()))?;
    summarise(args, &mut acquisition)?;
    refuse_frozen(args, &acquisition)
}

/// Hands on samples until there are enough, the replay ends, or the user presses Ctrl-C.
fn record(args: &CaptureArgs, acquisition: &mut Acquisition, mut take: impl FnMut(&Row) -> Result<()>) -> Result<()> {
    let wanted = args.samples.unwrap_or(u64::MAX);
    let ends_after_ns = args.samples.map_or(args.duration.nanos(), |_| u64::MAX);
    let meter = Meter::new(args.samples.map_or(args.duration.0, |n| n as f64));
    let mut first_ns = None;
    while let Some(row) = acquisition.next_row()? {
        take(&row)?;
        acquisition.look_at(&row);
        let elapsed_ns = row.t_ns - *first_ns.get_or_insert(row.t_ns);
        let read = acquisition.tally().samples;
        if read >= wanted || elapsed_ns >= ends_after_ns {
            break;
        }
        if acquisition.is_time_to_show() {
            let done = args.samples.map_or(elapsed_ns as f64 * 1e-9, |_| read as f64);
            meter.show(done, format!("recording, {read} samples"));
        }
    }
    Ok(())
}

fn summarise(args: &CaptureArgs, acquisition: &mut Acquisition) -> Result<()> {
    let warnings = acquisition.warnings().into_iter().map(coded).collect();
    let counts: Vec<&FaultCounts> = acquisition.healths().map(Health::fault_counts).collect();
    let sum = |count: fn(&FaultCounts) -> u64| counts.iter().copied().map(count).sum();
    let tally = acquisition.tally();
    let summary = Summary {
        file: args.output.display().to_string(),
        samples: tally.samples,
        lost_samples: tally.lost,
        rate_hz: tally.rate_hz(),
        rdy_hz: tally.rdy_hz(),
        duration_s: tally.duration_s(),
        interrupted: interrupt::asked(),
        impossible_readings: sum(|counts| counts.impossible),
        impossible_temps: sum(|counts| counts.impossible_temps),
        out_of_range: sum(|counts| counts.out_of_range),
        unjudged: sum(|counts| counts.unjudged),
        frozen: acquisition.frozen_at_end().is_some(),
        warnings,
    };
    if args.json {
        return print_json(&summary);
    }
    warn(&summary.warnings);
    let Summary { file, samples, lost_samples, rate_hz, .. } = &summary;
    let how = if summary.interrupted { " (interrupted)" } else { "" };
    let took = Seconds(summary.duration_s);
    print_lines(&format!("{file}: {samples} samples in {took}{how}, {rate_hz:.1} a second, {lost_samples} lost\n"))
}

/// Refuses a recording whose end is not a measurement. The file is complete and stays.
fn refuse_frozen(args: &CaptureArgs, acquisition: &Acquisition) -> Result<()> {
    match acquisition.frozen_at_end() {
        None => Ok(()),
        Some(frozen) => {
            let why = valid::frozen_text(&frozen, acquisition.start_ns());
            Err(CodedRefusal::new(
                "frozen",
                format!("{why}; {} holds the raw codes up to the end", args.output.display()),
            )
            .into())
        }
    }
}
