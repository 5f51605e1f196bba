//! `zerorate chamber`: a calibration over the temperature range of a chamber.

mod exit_message;
mod text;

use super::earth::EarthArgs;
use super::serial::{NotesArgs, one_line};
use crate::device::{DeviceArgs, SamplingArgs};
use crate::exit::Usage;
use crate::interrupt;
use crate::output::{Outputs, StagedOutput, print_json, print_lines, say, warn};
use crate::picture::{self, Kind};
use crate::progress::Meter;
use crate::wording::{coded, flag};
use anyhow::{Error, Result};
use clap::Args;
use exit_message::ExitMessage;
use std::path::PathBuf;
use std::time::Duration;
use zerorate::chamber::{ChamberProgress, Step, StepEnd};
use zerorate::{EARTH_DPS, SettingNames};
use zerorate_host::{AmbientProfile, ChamberCommands, ChamberSpec, Setup, SimulatedChamber};
use zerorate_jobs::JobWarning;
use zerorate_jobs::calibrate::OutputOptions;
use zerorate_jobs::chamber::{
    ChamberOptions, ChamberResults, Files, Job, PlanFile, SetPointControl, UnusableSteps, Watch, prepare,
};
use zerorate_view::duration::Seconds;
use zerorate_view::report::over_temperature;

/// Calibrate a sensor over the temperatures of a chamber
///
/// The plan lists the temperatures of the chamber: soak points, or ramps by the clock (docs/formats/plan.md). At a
/// soak point the sensor itself shows when it has settled, and its Allan deviation decides how long it is averaged.
/// The whole recording then gives the bias over temperature with its uncertainty, its hysteresis and its lag.
///
/// The command tells you what to set. With --set-temperature and --read-temperature it runs two commands of yours,
/// which control the chamber (docs/chamber.md has an example). However it ends, it sets the safe temperature of the
/// plan. Ctrl-C ends the measurement and keeps the finished steps beside the output, and the same command then goes on
/// from there. For `twin:` the air follows a simulated chamber, as fast as possible.
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

    /// Largest share of lost samples, 0 … 1. Above it the measurement is refused.
    #[arg(long, value_name = "F", default_value_t = 0.001, help_heading = "Procedure")]
    max_lost: f64,

    #[command(flatten)]
    earth: EarthArgs,

    /// Highest order of the bias over temperature to try, 1 to 3. The evidence decides which order is taken.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=3),
        help_heading = "Procedure")]
    max_order: u8,

    #[command(flatten)]
    control: ControlArgs,

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

    #[command(flatten)]
    notes: NotesArgs,

    /// Print the result as one JSON object.
    #[arg(long, help_heading = "Result")]
    json: bool,
}

/// Options that select how the chamber is controlled.
#[derive(Args, Debug)]
#[command(next_help_heading = "Chamber")]
struct ControlArgs {
    /// Set the chamber by this command, in which {temp_c} stands for the temperature in °C.
    ///
    /// `sh -c` runs it, with a number such as -40.0 in place of each {temp_c}. It must end within ten seconds with
    /// exit status 0. Its input is empty. Ctrl-C does not reach it, but after Ctrl-C it has only one second.
    #[arg(long, value_name = "COMMAND", requires = "read_temperature")]
    set_temperature: Option<String>,

    /// Read the chamber by this command, which prints the temperature of the air in °C.
    ///
    /// It is run in the same way. The first line that it prints must be a number and nothing else.
    #[arg(long, value_name = "COMMAND", requires = "set_temperature")]
    read_temperature: Option<String>,

    /// Run a command that fails again for this many seconds, at most 3600. Then the measurement ends.
    #[arg(
        long, value_name = "S", default_value_t = 60, value_parser = clap::value_parser!(u16).range(..=3600),
        requires = "set_temperature"
    )]
    retry_s: u16,

    /// Instead of the commands: hand, or sim:… for twin: [default: hand; sim: for twin:].
    ///
    /// hand: you set the chamber. sim:lag_s=…,overshoot=…,door_at_s=…,door_for_s=…,room_c=…,start_c=…: a simulated
    /// chamber.
    #[arg(long, value_name = "CHAMBER", conflicts_with = "set_temperature")]
    chamber: Option<ChamberSpec>,
}

impl ControlArgs {
    /// The chamber that the options select; `None` without options.
    fn spec(&self) -> Result<Option<ChamberSpec>> {
        let Some((set, read)) = self.set_temperature.as_deref().zip(self.read_temperature.as_deref()) else {
            return Ok(self.chamber.clone());
        };
        let commands = ChamberCommands::new(set, read, Duration::from_secs(self.retry_s.into()));
        Ok(Some(ChamberSpec::Commands(commands.map_err(Usage)?)))
    }
}

impl ChamberArgs {
    /// The chamber of the measurement; `None` for a recording.
    fn chamber(&self) -> Result<Option<ChamberSpec>> {
        let is_replayed = self.device.file().is_some();
        let is_simulated = self.device.device.is_simulated();
        match self.control.spec()? {
            Some(_) if is_replayed => {
                let why = "a recording already states what the chamber did; leave out --chamber and the commands";
                Err(Usage(why.to_owned()).into())
            }
            Some(ChamberSpec::Simulated(_)) if !is_simulated => {
                let why = "--chamber sim: is for twin: only, since it moves the air around a simulated part";
                Err(Usage(why.to_owned()).into())
            }
            Some(spec) => Ok(Some(spec)),
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
    let ChamberArgs { output, log, serial, notes, .. } = args;
    let (output, log, serial, notes) = (output.clone(), log.clone(), serial.clone(), notes.clone().into());
    let options = OutputOptions { output, log, serial, notes, saves: false };
    let files = Files::claim(outputs, options, args.report.as_deref(), args.device.file().is_some())?;
    let kind = args.report.as_deref().map(Kind::of).transpose()?.flatten();
    let job = ready(args, chamber, setup, plan, files)?;
    if kind.is_some() && job.part().axes.len() > 1 {
        let why = "a picture shows one axis, and this part has several: write a page (.html) as --report";
        return Err(Usage(why.to_owned()).into());
    }
    let mut watch = Looking { meter: Meter::new(job.left_s()), kind };
    let done = job.run(&mut watch)?;
    drop(watch);
    done.delivery.map_err(|failure| failure.error(""))?;
    let report = &done.results.report;
    if args.json {
        return print_json(report);
    }
    let printed = print_lines(&text::text(report, args.output.as_deref()));
    warn(&report.warnings);
    printed
}

fn limits(args: &ChamberArgs) -> Result<()> {
    if !(0.0..=1.0).contains(&args.max_lost) {
        return Err(Usage(format!("--max-lost {}: give a share from 0 to 1", args.max_lost)).into());
    }
    match args.earth.dps() {
        Some(dps) if !(-EARTH_DPS..=EARTH_DPS).contains(&dps) => {
            Err(Usage(format!("--earth-dps {dps}: give a number from -{EARTH_DPS} to {EARTH_DPS} °/s (F-16)")).into())
        }
        _ => Ok(()),
    }
}

/// Prepares the measurement. First starts the chamber, so that a chamber that does not respond is reported at once.
fn ready(args: &ChamberArgs, chamber: Option<ChamberSpec>, setup: Setup, plan: PlanFile, files: Files) -> Result<Job> {
    // now the first Ctrl-C only requests a stop, since the chamber must be set to its safe temperature
    interrupt::listen();
    let is_simulated = args.device.device.is_simulated();
    let (safe_c, stop) = (plan.plan.safe_c, interrupt::stop());
    let mut control = SetPointControl::new(chamber.as_ref(), is_simulated, safe_c, stop, Box::new(ExitMessage))?;
    control.start()?;
    let (ambient, writer) = is_simulated.then(AmbientProfile::with_writer).unzip();
    let acquisition = args.device.open(Setup { ambient, ..setup })?;
    let options = ChamberOptions {
        max_lost: args.max_lost,
        earth_dps: args.earth.dps(),
        max_order: args.max_order.into(),
        restart: args.restart,
        moves_air: chamber.is_some(),
    };
    prepare(acquisition, (control, writer), plan, files, options).map_err(worded)
}

/// Adds advice to the error about a file of finished steps that is damaged or belongs to another measurement.
fn worded(error: Error) -> Error {
    match error.downcast::<UnusableSteps>() {
        Ok(unusable) => Usage(format!("{unusable}; take another -o, or --restart to begin anew")).into(),
        Err(error) => error,
    }
}

/// Shows the progress, and writes the page or plot.
struct Looking {
    meter: Meter,
    /// The format of the plot that was requested in place of the page; `None` if no plot was requested.
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

    fn page(&mut self, results: &ChamberResults, file: StagedOutput) -> Result<()> {
        match self.kind {
            Some(kind) => {
                picture::write(kind, file, &results.outcomes.first().map_or(String::new(), over_temperature))
            }
            None => Ok(file.fill(text::page(results)?.as_bytes())?),
        }
    }

    fn names(&self) -> SettingNames {
        flag
    }
}
