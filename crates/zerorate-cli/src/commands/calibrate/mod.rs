//! `zerorate calibrate` and `recalibrate`: the procedure of AN-1042 (F-51) or another method, on a part or a
//! recording.

mod deliver;
mod forecast;
mod plan;
mod text;

use super::serial::{NotesArgs, one_line};
use crate::device::{self, DeviceArgs, SamplingArgs};
use crate::output::{Outputs, say, warn};
use crate::part::PartArgs;
use crate::progress::Meter;
use crate::wording::flag;
use anyhow::Result;
use clap::Args;
use plan::PlanArgs;
use std::path::PathBuf;
pub use text::remarks;
use zerorate::Plan;
use zerorate_host::{DeviceSpec, Pace, Setup, Stop};
use zerorate_jobs::Acquisition;
use zerorate_jobs::calibrate::{Files, Job, OutputOptions, prepare};

/// Find the bias of a sensor and how it changes with temperature
///
/// The procedure follows the application note AN-1042. Two averages with a warm-up between them give the temperature
/// coefficient BTC. A long average after settling gives the bias correction PBC at the temperature T3:
///
/// corrected rate = RATE + PBC + (TEMP − T3) · BTC
///
/// Method `an1042` follows the note to the letter. Method `warmup` uses every sample of the same hour. It gives a
/// curve of order 0 to 3 over temperature with an uncertainty at every temperature, and allows for the sensor's own
/// noise, steps of the supply and a lag. Method `cycle` does the same while you heat and cool the sensor, and leaves
/// the smallest error of a sensor on a table. For the full range of temperatures use `zerorate chamber`. To keep a
/// calibration good afterwards, use `zerorate stream --track`.
///
/// Before you start: fix the sensor to a still platform, use a linear 5 V supply, and keep the sensor off for an hour.
/// A sensor that moves, freezes, hardly changes its temperature or loses too many samples is refused (exit code 3).
#[derive(Args, Debug)]
pub struct CalibrateArgs {
    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    #[command(flatten)]
    plan: PlanArgs,

    #[command(flatten)]
    result: ResultArgs,

    /// Record every sample to this file, from which `zerorate recalibrate` gives the same result.
    #[arg(long, value_name = "FILE", help_heading = "Result")]
    log: Option<PathBuf>,

    /// Do not save the calibration. Without this and -o, the calibration of a real part goes to calibration-<id>.toml.
    #[arg(long, conflicts_with = "output", help_heading = "Result")]
    no_save: bool,
}

/// Compute a calibration again from a recorded capture
///
/// The same samples give the same numbers, bit for bit, if the durations match the recording.
#[derive(Args, Debug)]
pub struct RecalibrateArgs {
    /// The capture, from `zerorate calibrate --log` or `zerorate capture`.
    #[arg(value_name = "CAPTURE")]
    pub capture: PathBuf,

    #[command(flatten)]
    part: PartArgs,

    #[command(flatten)]
    plan: PlanArgs,

    #[command(flatten)]
    result: ResultArgs,
}

/// Options for the result.
#[derive(Args, Clone, Debug)]
#[command(next_help_heading = "Result")]
struct ResultArgs {
    /// Write the calibration to this file, which gets its name only when it is complete.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Overwrite existing files: an older calibration only by a good new one, a capture only by --log.
    #[arg(long)]
    force: bool,

    /// The serial number of the sensor, stored in the file.
    #[arg(long, value_name = "SN", value_parser = one_line)]
    serial: Option<String>,

    #[command(flatten)]
    notes: NotesArgs,

    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

impl ResultArgs {
    fn output_options(&self, log: Option<PathBuf>, saves: bool) -> OutputOptions {
        let Self { output, serial, notes, .. } = self.clone();
        OutputOptions { output, log, serial, notes: notes.into(), saves }
    }

    fn outputs(&self) -> Outputs {
        Outputs::new(self.force).printing()
    }
}

pub fn run(args: &CalibrateArgs) -> Result<()> {
    let plan = args.plan.plan(args.device.file().is_some())?;
    let mut outputs = args.result.outputs();
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    let files = Files::claim(outputs, args.result.output_options(args.log.clone(), !args.no_save))?;
    let acquisition = args.device.open(setup)?;
    calibrate(acquisition, plan, &args.result, files)
}

pub fn run_again(args: &RecalibrateArgs) -> Result<()> {
    let plan = args.plan.plan(true)?;
    let mut outputs = args.result.outputs().reading([&*args.capture])?;
    let setup = Setup { part: args.part.named(&mut outputs)?, names: flag, ..Setup::default() };
    let files = Files::claim(outputs, args.result.output_options(None, false))?;
    // nothing is recorded, so a signal ends the run at once, and no stop is asked for
    let recording = DeviceSpec::replay(args.capture.clone());
    let acquisition = Acquisition::open(&recording, setup, Pace::Free, &Stop::default(), device::tell())?;
    calibrate(acquisition, plan, &args.result, files)
}

/// Tells, before the measurement, where the result will be saved.
fn whereto(job: &Job) -> &'static str {
    match job.saves() {
        true => "the result will be saved as calibration-<id>.toml in this folder; -o FILE names it",
        false => "the result will only be printed; -o FILE saves it",
    }
}

fn calibrate(acquisition: Acquisition, plan: Plan, result: &ResultArgs, files: Files) -> Result<()> {
    let job = prepare(acquisition, plan, files, flag)?;
    if !result.json {
        if result.output.is_none() {
            say(whereto(&job));
        }
        plan::durations(job.plan()).iter().for_each(say);
        forecast::lines(job.part(), job.plan()).iter().for_each(|line| say(format_args!("{line}")));
    }
    let mut meter = Meter::new(job.plan().total_s());
    let done = job.run(&mut meter)?;
    drop(meter);
    let warnings = if result.json { Vec::new() } else { text::warnings(&done.report) };
    let printed = match done.delivery {
        Ok(()) => deliver::print_result(&done.report, &done.calibration, result),
        Err(failure) => deliver::print_undelivered(failure, done.report, &done.calibration, result.json),
    };
    warn(&warnings);
    printed
}
