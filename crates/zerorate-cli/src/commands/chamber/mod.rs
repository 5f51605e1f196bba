//! `zerorate chamber`: a calibration over the temperatures of a chamber.

mod air;
mod text;

use super::allan::picture::{self, Kind};
use super::serial::one_line;
use crate::device::{DeviceArgs, SamplingArgs};
use crate::exit::Usage;
use crate::interrupt;
use crate::output::{Outputs, Staged, print_json, print_lines, say, warn};
use crate::progress::Meter;
use crate::wording::{coded, flag};
use air::LastWord;
use anyhow::{Error, Result};
use clap::Args;
use std::path::PathBuf;
use zerorate::chamber::{ChamberProgress, Step, StepEnd};
use zerorate::{EARTH_DPS, Names};
use zerorate_host::{Air, ChamberSpec, Setup, SimulatedChamber};
use zerorate_jobs::JobWarning;
use zerorate_jobs::calibrate::Kept;
use zerorate_jobs::chamber::{ChamberOptions, Files, Found, Job, Mover, PlanFile, UnusableSteps, Watch, prepare};
use zerorate_view::duration::Seconds;
use zerorate_view::report::over_temperature;

/// Calibrate a sensor over the temperatures of a chamber
///
/// The plan lists the temperatures of the chamber: soak points, or ramps by the clock (docs/formats/plan.md). At a
/// soak point the sensor itself shows when it has settled, and its Allan deviation decides how long it is averaged.
/// The whole recording then gives the bias over temperature with its uncertainty, its hysteresis and its lag.
///
/// Without --chamber the command tells you what to set. Ctrl-C ends the measurement and keeps the finished steps
/// beside the output, and the same command then goes on from there. For `twin:` the air follows a simulated chamber,
/// as fast as possible.
#[derive(Args, Debug)]
pub struct ChamberArgs {
    /// The plan: a file, f57, or two-point; for a recording also a CSV of what its chamber did.
    ///
    /// f57 takes 210 minutes from 25 over −40 to +85 °C and back; two-point goes to 15, 55 and 15 °C. The CSV has the
    /// columns t_s (from the first sample) and temp_c.
    #[arg(value_name = "PLAN")]
    plan: PathBuf,

    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// How the chamber is controlled: hand, tcp:HOST[:PORT]?…, serial:DEV?… or sim:… [default: hand; sim: for twin:].
    ///
    /// hand: you set the chamber. tcp:HOST[:PORT]?set=espec|f4t|simserv and serial:/dev/ttyUSB0?set=…&baud=N: a
    /// chamber that takes lines of text (docs/chamber.md has the commands). With patience_s=N a lost connection is
    /// retried that long. sim:lag_s=…,overshoot=…,door_at_s=…,door_for_s=…,room_c=…: a simulated chamber, for twin:
    /// only.
    #[arg(long, value_name = "CHAMBER")]
    chamber: Option<ChamberSpec>,

    /// Largest share of lost samples, 0 … 1. Above it the measurement is refused.
    #[arg(long, value_name = "F", default_value_t = 0.001)]
    max_lost: f64,

    /// The Earth's rotation on the sensor's axis, °/s, to subtract from the bias [default: it stays inside PBC, and a
    /// warning says so].
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    earth_dps: Option<f64>,

    /// Highest order of the bias over temperature to try, 1 to 3. The evidence decides which order is taken.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=3))]
    max_order: u8,

    /// Write the calibration to this file, which gets its name only when it is complete. Until then the finished steps
    /// are beside it, in a file with `.chamber` after its name.
    #[arg(short, long, value_name = "FILE", help_heading = "Result")]
    output: Option<PathBuf>,

    /// Overwrite existing files: an older calibration or page only by a good new one, a capture only by --log.
    #[arg(long, help_heading = "Result")]
    force: bool,

    /// Begin anew, although there are finished steps of an interrupted measurement.
    #[arg(long, help_heading = "Result")]
    restart: bool,

    /// Write a page with the result, the remaining error over time and temperature, and the soak points. A .svg or
    /// .png has the error over temperature only.
    #[arg(long, value_name = "FILE", help_heading = "Result")]
    report: Option<PathBuf>,

    /// Record every sample to this file, from which `zerorate chamber PLAN --device replay:FILE` gives the same
    /// result.
    #[arg(long, value_name = "FILE", help_heading = "Result")]
    log: Option<PathBuf>,

    /// The serial number of the sensor, stored in the file.
    #[arg(long, value_name = "SN", value_parser = one_line, help_heading = "Result")]
    serial: Option<String>,

    /// A note on the supply, stored in the file.
    #[arg(long, value_name = "TEXT", value_parser = one_line, help_heading = "Result")]
    supply_note: Option<String>,

    /// Print the result as one JSON object.
    #[arg(long, help_heading = "Result")]
    json: bool,
}

impl ChamberArgs {
    /// How the chamber is controlled.
    fn chamber(&self) -> Result<Option<ChamberSpec>> {
        let is_replayed = self.device.file().is_some();
        let is_simulated = self.device.device.is_simulated();
        match &self.chamber {
            Some(_) if is_replayed => {
                Err(Usage("a recording already states what the chamber did; leave --chamber out".to_owned()).into())
            }
            Some(ChamberSpec::Simulated(_)) if !is_simulated => {
                let why = "--chamber sim: is for twin: only, since it moves the air around a simulated part";
                Err(Usage(why.to_owned()).into())
            }
            Some(spec) => Ok(Some(spec.clone())),
            None if is_replayed => Ok(None),
            None if is_simulated => Ok(Some(ChamberSpec::Simulated(SimulatedChamber::default()))),
            None => Ok(Some(ChamberSpec::Hand)),
        }
    }
}

pub fn run(args: &ChamberArgs) -> Result<()> {
    let chamber = args.chamber()?;
    let mut outputs = Outputs::new(args.force).printing();
    let plan = PlanFile::read(&args.plan, args.device.file().is_some(), &mut outputs, flag)?;
    limits(args)?;
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    let ChamberArgs { output, log, serial, supply_note, .. } = args;
    let (output, log, serial, supply_note) = (output.clone(), log.clone(), serial.clone(), supply_note.clone());
    let kept = Kept { output, log, serial, supply_note };
    let files = Files::claim(outputs, kept, args.report.as_deref(), args.device.file().is_some())?;
    let kind = args.report.as_deref().map(Kind::of).transpose()?.flatten();
    let job = ready(args, chamber, setup, plan, files)?;
    if kind.is_some() && job.part().axes.len() > 1 {
        let why = "a picture shows one axis, and this part has several: write a page (.html) as --report";
        return Err(Usage(why.to_owned()).into());
    }
    let mut watch = Looking { meter: Meter::new(job.left_s()), kind };
    let done = job.run(&mut watch)?;
    drop(watch);
    done.kept.map_err(|undelivered| undelivered.error(""))?;
    let report = &done.found.report;
    if args.json {
        return print_json(report);
    }
    warn(&report.warnings);
    print_lines(&text::text(report, args.output.as_deref()))
}

fn limits(args: &ChamberArgs) -> Result<()> {
    if !(0.0..=1.0).contains(&args.max_lost) {
        return Err(Usage(format!("--max-lost {}: give a share from 0 to 1", args.max_lost)).into());
    }
    match args.earth_dps {
        Some(dps) if !(-EARTH_DPS..=EARTH_DPS).contains(&dps) => {
            Err(Usage(format!("--earth-dps {dps}: give a number from -{EARTH_DPS} to {EARTH_DPS} °/s (F-16)")).into())
        }
        _ => Ok(()),
    }
}

/// Makes the measurement ready. The chamber comes first: no hour begins with a chamber that does not answer.
fn ready(args: &ChamberArgs, chamber: Option<ChamberSpec>, setup: Setup, plan: PlanFile, files: Files) -> Result<Job> {
    // from here on Ctrl-C only asks for an end, since the chamber must be stopped
    interrupt::listen();
    let is_simulated = args.device.device.is_simulated();
    let mut mover =
        Mover::new(chamber.as_ref(), is_simulated, plan.plan.safe_c, interrupt::stop(), Box::new(LastWord))?;
    mover.start()?;
    let air = is_simulated.then(Air::default);
    let lead = air.as_ref().map(Air::lead);
    let acquisition = args.device.open(Setup { air, ..setup })?;
    let options = ChamberOptions {
        max_lost: args.max_lost,
        earth_dps: args.earth_dps,
        max_order: args.max_order.into(),
        restart: args.restart,
        moves_air: chamber.is_some(),
    };
    prepare(acquisition, (mover, lead), plan, files, options).map_err(worded)
}

/// Adds how to begin anew.
fn worded(error: Error) -> Error {
    match error.downcast::<UnusableSteps>() {
        Ok(unusable) => Usage(format!("{unusable}; take another -o, or --restart to begin anew")).into(),
        Err(error) => error,
    }
}

/// Shows the progress.
struct Looking {
    meter: Meter,
    /// The form of the picture, where one replaces the page.
    kind: Option<Kind>,
}

impl Watch for Looking {
    fn see(&mut self, progress: &ChamberProgress) {
        if !self.meter.is_hidden() {
            let temp = progress.temp_c.map_or(String::new(), |temp_c| format!(", part at {temp_c:.1} °C"));
            let text = format!("step {}/{}: {}{temp}", progress.step + 1, progress.steps, progress.state);
            self.meter.show_left(progress.elapsed_s, progress.left_s, text);
        }
    }

    fn resume(&mut self, steps: usize, all: usize, gap_s: f64) {
        say(format_args!("going on after step {steps} of {all}, which ended {} before", Seconds(gap_s)));
    }

    fn step(&mut self, progress: &ChamberProgress, step: &Step) {
        let how = step.c_per_min.map_or(String::new(), |c_per_min| format!(", at {c_per_min} °C a minute"));
        let then = match step.end {
            StepEnd::Hold(hold_s) => format!("and leave it there for {}", Seconds(hold_s)),
            StepEnd::Average(_) => "and leave it there: the part tells when it has settled".to_owned(),
        };
        let (number, all, to_c) = (progress.step + 1, progress.steps, step.to_c);
        say(format_args!("step {number} of {all}: set the chamber to {to_c:.1} °C{how}, {then}"));
    }

    fn warn(&mut self, warning: JobWarning) {
        warn(&[coded(warning)]);
    }

    fn page(&mut self, found: &Found, file: Staged) -> Result<()> {
        match self.kind {
            Some(kind) => picture::write(kind, file, &found.outcomes.first().map_or(String::new(), over_temperature)),
            None => Ok(file.fill(text::page(found)?.as_bytes())?),
        }
    }

    fn names(&self) -> Names {
        flag
    }
}
