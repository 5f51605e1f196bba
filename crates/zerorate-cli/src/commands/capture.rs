//! `zerorate capture`: records raw codes with timestamps.

use super::serial::{NotesArgs, one_line};
use crate::device::{DeviceArgs, SamplingArgs};
use crate::output::{Outputs, print_json, print_lines, warn};
use crate::progress::Meter;
use crate::wording::{flag, form};
use anyhow::Result;
use clap::Args;
use std::path::PathBuf;
use zerorate_jobs::record::{Length, RecordOptions, RecordProgress, RecordReport, record};
use zerorate_record::Format;
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

pub fn run(args: &CaptureArgs) -> Result<()> {
    let options = RecordOptions {
        output: args.output.clone(),
        format: form(args.format, &args.output)?,
        length: args.samples.map_or(Length::Time(args.duration.nanos()), Length::Samples),
        serial: args.serial.clone(),
        notes: args.notes.clone().into(),
    };
    let mut outputs = Outputs::new(args.force).printing();
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    let mut acquisition = args.device.open(setup)?;
    let meter = Meter::new(options.length.total());
    let mut show = |RecordProgress { done, samples }| meter.show(done, format!("recording, {samples} samples"));
    let report = record(&mut acquisition, &mut outputs, &options, flag, &mut show)?;
    drop(meter);
    if args.json {
        print_json(&report)?
    } else {
        tell(&report)?
    }
    Ok(report.refuse_frozen()?)
}

fn tell(report: &RecordReport) -> Result<()> {
    warn(&report.warnings);
    let RecordReport { file, samples, lost_samples, rate_hz, .. } = report;
    let how = if report.interrupted { " (interrupted)" } else { "" };
    let took = Seconds(report.duration_s);
    print_lines(&format!("{file}: {samples} samples in {took}{how}, {rate_hz:.1} a second, {lost_samples} lost\n"))
}
