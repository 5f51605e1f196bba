//! `zerorate chamber`: a calibration over the temperatures of a chamber.

mod drive;
mod kept;
mod mover;
mod plan;
mod result;

use super::allan::picture::Kind;
use super::serial::one_line;
use crate::device::{DeviceArgs, SamplingArgs};
use crate::exit::Usage;
use crate::interrupt;
use crate::output::{Outputs, Slot, Staged, say, warn};
use anyhow::Result;
use clap::Args;
use drive::{Drive, Driven, Ready, TICK_NS};
use kept::Kept;
use mover::Mover;
use plan::PlanFile;
use std::path::PathBuf;
use zerorate::chamber::{ChamberPlan, ChamberProcedure};
use zerorate::{EARTH_DPS, Part};
use zerorate_host::{Air, ChamberSpec, DeviceInfo, Setup, SimulatedChamber};
use zerorate_jobs::Acquisition;
use zerorate_jobs::Recorder;
use zerorate_record::{CaptureInfo, Format};
use zerorate_view::duration::Seconds;

/// Calibrates a part over the temperatures of a chamber.
///
/// The plan says where the chamber goes: soak points, at which the part itself tells when it has settled and is
/// averaged as long as its Allan deviation says, or ramps by the clock (docs/formats/plan.md). The whole recording
/// then gives the bias over temperature with its uncertainty, its hysteresis and its lag.
///
/// Without --chamber you are told what to set. Ctrl-C ends the measurement, keeps the steps that are finished beside
/// the output, and the same command goes on from there. Of `twin:` the air follows a simulated chamber, as fast as it
/// goes.
#[derive(Args, Debug)]
pub struct ChamberArgs {
    /// The plan: a file, or f57 (210 minutes from 25 over −40 to +85 °C and back) or two-point (15, 55 and 15 °C); or,
    /// of a recording, a CSV of what its chamber did, with the columns t_s (from its first sample) and temp_c.
    #[arg(value_name = "PLAN")]
    plan: PathBuf,

    #[command(flatten)]
    pub device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    /// What moves the air: hand (you do), tcp:HOST[:PORT]?set=espec|f4t|simserv or serial:/dev/ttyUSB0?set=…&baud=N (a
    /// chamber that takes lines of text; docs/chamber.md has the commands; patience_s=N: how long a lost connection is
    /// made anew), sim:lag_s=…,overshoot=…,door_at_s=…,door_for_s=…,room_c=… (a simulated one, for twin:)
    /// [default: hand; sim: for twin:].
    #[arg(long, value_name = "CHAMBER")]
    chamber: Option<ChamberSpec>,

    /// Largest share of lost samples, 0 … 1; above it the measurement is refused.
    #[arg(long, value_name = "F", default_value_t = 0.001)]
    max_lost: f64,

    /// The component of the Earth's rotation on the part's axis, °/s, to subtract from the bias [default: it stays
    /// inside PBC, and a warning says so].
    #[arg(long, value_name = "X", allow_negative_numbers = true)]
    earth_dps: Option<f64>,

    /// Highest order of the bias over temperature that is tried, 1 to 3; the evidence decides which is taken.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u8).range(1..=3))]
    max_order: u8,

    /// Write the calibration file. It gets its name only when it is complete. Until then, the finished steps stand
    /// beside it in a file with `.chamber` after its name.
    #[arg(short, long, value_name = "FILE", help_heading = "Result")]
    output: Option<PathBuf>,

    /// Overwrite existing files: an older calibration or page only by a good new one, a capture only by --log.
    #[arg(long, help_heading = "Result")]
    force: bool,

    /// Begin anew where finished steps of an interrupted measurement are found.
    #[arg(long, help_heading = "Result")]
    restart: bool,

    /// Write a page with the result, what the correction leaves over time and temperature, and the soak points; or
    /// that over temperature alone, as .svg or .png.
    #[arg(long, value_name = "FILE", help_heading = "Result")]
    report: Option<PathBuf>,

    /// Record every sample to this file, from which `zerorate chamber PLAN --device replay:FILE` gives the same
    /// result.
    #[arg(long, value_name = "FILE", help_heading = "Result")]
    log: Option<PathBuf>,

    /// Serial number of the part, stored in the file.
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
    /// What moves the air.
    fn chamber(&self) -> Result<Option<ChamberSpec>> {
        let is_replayed = self.device.file().is_some();
        let is_simulated = self.device.device.is_simulated();
        match &self.chamber {
            Some(_) if is_replayed => {
                Err(Usage("the recording has decided what the chamber did; leave --chamber out".to_owned()).into())
            }
            Some(ChamberSpec::Simulated(_)) if !is_simulated => {
                let why =
                    "a simulated chamber moves the air around a simulated part only: --chamber sim: is for twin:";
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
    let plan = PlanFile::read(&args.plan, args.device.file().is_some(), &mut outputs)?;
    limits(args)?;
    let mut files = Files::claim(args, outputs)?;
    let driven = drive(args, chamber, &plan, &mut files)?;
    result::deliver(args, &plan, driven, files)
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

fn drive(args: &ChamberArgs, chamber: Option<ChamberSpec>, plan: &PlanFile, files: &mut Files) -> Result<Driven> {
    // from here on Ctrl-C is a wish: what was started must be stopped
    interrupt::listen();
    let mut mover = Mover::new(chamber.as_ref(), args.device.device.is_simulated(), plan.plan.safe_c)?;
    // the chamber first: no hour is begun with one that does not answer
    mover.start()?;
    let air = args.device.device.is_simulated().then(Air::default);
    let lead = air.as_ref().map(Air::lead);
    let ready = ready(args, plan, files, air, chamber.is_some())?;
    Drive::new(ready, mover, lead).run()
}

/// The part and the files, before the first sample.
fn ready(args: &ChamberArgs, plan: &PlanFile, files: &mut Files, air: Option<Air>, moves_air: bool) -> Result<Ready> {
    let is_simulated = air.is_some();
    let mut acquisition = args.device.open(Setup { air, ..files.setup.clone() })?;
    if moves_air {
        spares(&plan.plan, acquisition.part())?;
    }
    if files.report_kind.is_some() && acquisition.part().axes.len() > 1 {
        let why = "a picture shows one axis, and this part has several: write a page (.html) as --report";
        return Err(Usage(why.to_owned()).into());
    }
    let info = acquisition.info(args.serial.as_deref(), args.supply_note.as_deref());
    let procedure = ChamberProcedure::new(acquisition.part(), plan.plan.clone(), args.max_lost);
    let mut procedure = procedure.map_err(|error| Usage(error.to_string()))?;
    let kept = Kept::new(files.steps.take(), &plan.text, acquisition.part(), &info.device, info.serial.as_deref());
    let kept = kept.in_real_time(acquisition.facts().is_real);
    if let Some((saved, gap_s)) = kept.found(args.restart)? {
        let (steps, all) = (saved.steps, plan.plan.steps.len());
        say(format_args!("going on after step {steps} of {all}, which ended {} before", Seconds(gap_s)));
        procedure = procedure.resumed(saved.record, saved.steps, gap_s);
    }
    if is_simulated {
        mark_ticks(&mut acquisition, &procedure);
    }
    let log = files.log(acquisition.facts(), &info)?;
    Ok(Ready { acquisition, procedure, kept, log })
}

/// Holds the plan against the limits of the part.
fn spares(plan: &ChamberPlan, part: &Part) -> Result<()> {
    plan.spares(part).map_err(|error| Usage(error.to_string()))?;
    if part.operating_c.is_none() {
        let why =
            "the file of the part does not state operating_c, so only the plan keeps the chamber from harming it";
        warn(&[format!("limits-unknown: {why}")]);
    }
    Ok(())
}

/// Batches of a simulated part end where its chamber has moved the air: for as long as the plan can take at most.
fn mark_ticks(acquisition: &mut Acquisition, procedure: &ChamberProcedure) {
    /// Two weeks: no simulated measurement takes longer.
    const MOST_S: f64 = 14.0 * 86_400.0;
    let plan = procedure.plan();
    let slack_s = 5.0 * (plan.settle_timeout_s + 3600.0) * plan.steps.len() as f64;
    let most_s = (plan.least_s(0, procedure.part()) + slack_s).min(MOST_S) as u64;
    (0..=most_s).for_each(|second| acquisition.mark(second * TICK_NS));
}

/// The files that were asked for, claimed before hours are spent on their content.
struct Files {
    outputs: Outputs,
    calibration: Option<Staged>,
    report: Option<Staged>,
    /// A picture in place of a page.
    report_kind: Option<Kind>,
    log: Option<PathBuf>,
    /// Where finished steps are kept.
    steps: Option<Slot>,
    /// How the part is to be read, which may need a file as well.
    setup: Setup,
}

impl Files {
    fn claim(args: &ChamberArgs, mut outputs: Outputs) -> Result<Self> {
        let setup = args.device.setup(args.sampling, &mut outputs)?;
        let is_replayed = args.device.file().is_some();
        // beside a device there is no place for files
        let output = args.output.as_deref().filter(|path| !is_replayed && (!path.exists() || path.is_file()));
        Ok(Self {
            calibration: args.output.as_deref().map(|path| outputs.derived(path)).transpose()?,
            report: args.report.as_deref().map(|path| outputs.derived(path)).transpose()?,
            report_kind: args.report.as_deref().map(Kind::of).transpose()?.flatten(),
            log: args.log.clone(),
            steps: output.map(|path| outputs.slot(&Kept::beside(path))).transpose()?,
            setup,
            outputs,
        })
    }

    /// Starts the log, once there is something to record.
    fn log(&mut self, facts: &DeviceInfo, info: &CaptureInfo) -> Result<Option<Recorder>> {
        let Some(path) = self.log.take() else { return Ok(None) };
        let format = Format::choose(None, &path)?;
        Ok(Some(Recorder::create(self.outputs.recording(&path)?, format, facts, info, None)?))
    }
}
