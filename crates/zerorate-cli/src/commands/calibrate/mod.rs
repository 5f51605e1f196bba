//! `zerorate calibrate` and `recalibrate`: the procedure of F-51, on a part or on its recording.

mod plan;
mod report;

use super::{print, print_json, warn};
use crate::acquire::Acquisition;
use crate::capture::output::Staged;
use crate::capture::{CaptureInfo, CaptureWriter, Format, SampleHash};
use crate::cli::{DeviceArgs, SamplingArgs};
use crate::device::{Device, DeviceSpec};
use crate::duration::Seconds;
use crate::exit::{Refused, Usage};
use crate::interrupt;
use crate::progress::{Meter, Watch};
use adis16130::Sample;
use adis16130_twin::Truth;
use anyhow::{Context, Result, ensure};
use clap::{Args, ValueEnum};
use plan::PlanArgs;
pub use report::Report;
use std::fs;
use std::path::{Path, PathBuf};
use zerorate::calibration::Origin;
use zerorate::{Action, Calibration, Event, Outcome, Procedure, Refusal, State};

/// Finds the bias of a part and how it changes with temperature.
///
/// The procedure of the application note AN-1042: two averages with a warm-up between them give the temperature
/// coefficient BTC, a long average after settling gives the bias correction PBC at the temperature T3:
///
/// corrected rate = RATE + PBC + (TEMP − T3) · BTC
///
/// Fix the part to a still platform, supply it from a linear 5 V supply, and let it have been off for an hour.
/// A part that moves, freezes, hardly changes its temperature or loses too many samples is refused (exit code 3).
#[derive(Args, Debug)]
pub struct CalibrateArgs {
    #[command(flatten)]
    device: DeviceArgs,

    #[command(flatten)]
    sampling: SamplingArgs,

    #[command(flatten)]
    plan: PlanArgs,

    #[command(flatten)]
    result: ResultArgs,

    /// Record every sample to this file, from which `zerorate recalibrate` gives the same result.
    #[arg(long, value_name = "FILE", help_heading = "Result")]
    log: Option<PathBuf>,

    /// Overwrite an existing --log file.
    #[arg(long, requires = "log", help_heading = "Result")]
    force: bool,
}

/// Computes the calibration again from a recorded capture.
///
/// The same samples give the same numbers, bit for bit, if the durations are those it was recorded for.
#[derive(Args, Debug)]
pub struct RecalibrateArgs {
    /// The capture, from `zerorate calibrate --log` or `zerorate capture`.
    #[arg(value_name = "CAPTURE")]
    capture: PathBuf,

    #[command(flatten)]
    plan: PlanArgs,

    #[command(flatten)]
    result: ResultArgs,
}

/// What becomes of the result.
#[derive(Args, Debug)]
#[command(next_help_heading = "Result")]
struct ResultArgs {
    /// Write the calibration file; an older one of that name is replaced only by a good new one.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// The procedure.
    #[arg(long, value_enum, default_value = "an1042")]
    method: Method,

    /// Serial number of the part, stored in the file.
    #[arg(long, value_name = "SN")]
    serial: Option<String>,

    /// A note on the supply, stored in the file.
    #[arg(long, value_name = "TEXT")]
    supply_note: Option<String>,

    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

/// Ways to calibrate.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Method {
    /// Two temperatures by self-heating, as in AN-1042.
    An1042,
}

pub fn run(args: &CalibrateArgs) -> Result<()> {
    let acquisition = Acquisition::open(&args.device, args.sampling)?;
    calibrate(acquisition, &args.plan, &args.result, args.log())
}

pub fn run_again(args: &RecalibrateArgs) -> Result<()> {
    interrupt::listen()?;
    let device = Device::open(&DeviceSpec::replay(args.capture.clone()), SamplingArgs::AS_RECORDED)?;
    calibrate(Acquisition::unpaced(device), &args.plan, &args.result, None)
}

/// The measurement alone, for another program: prints nothing, leaves Ctrl-C alone, and ends when `watch` says so.
pub fn measured(args: &CalibrateArgs, watch: &mut dyn Watch) -> Result<(Report, Calibration)> {
    let device = Device::open(&args.device.device, args.sampling)?;
    let procedure = procedure(&args.plan)?;
    measure(Acquisition::unpaced(device), procedure, &args.result, args.log(), watch)
}

impl CalibrateArgs {
    fn log(&self) -> Option<Log<'_>> {
        self.log.as_deref().map(|path| Log { path, force: self.force })
    }
}

/// Where the samples are recorded.
#[derive(Clone, Copy)]
struct Log<'a> {
    path: &'a Path,
    force: bool,
}

fn calibrate(acquisition: Acquisition, plan: &PlanArgs, result: &ResultArgs, log: Option<Log>) -> Result<()> {
    let procedure = procedure(plan)?;
    let mut meter = Meter::new(procedure.plan().total_s());
    let (report, _) = measure(acquisition, procedure, result, log, &mut meter)?;
    drop(meter);
    if result.json {
        return print_json(&report);
    }
    warn(&report.warnings);
    print(&report.text(result.output.as_deref()))
}

fn procedure(plan: &PlanArgs) -> Result<Procedure> {
    Procedure::new(plan.plan()).map_err(|error| Usage(error.to_string()).into())
}

fn measure(
    mut acquisition: Acquisition,
    procedure: Procedure,
    result: &ResultArgs,
    log: Option<Log>,
    watch: &mut dyn Watch,
) -> Result<(Report, Calibration)> {
    let file = result.output.as_deref().map(claim).transpose()?;
    let device = acquisition.device();
    let info = device.info(result.serial.as_deref(), result.supply_note.as_deref());
    let writer = log.map(|log| CaptureWriter::create(log.path, Format::choose(None, log.path), &info, log.force));
    let measured = Measurement::new(acquisition, procedure, writer.transpose()?, watch).run()?;
    let calibration = Calibration::new(&measured.outcome, origin(info, measured.capture_sha256));
    if let Some(file) = file {
        fs::write(file.path(), calibration.to_toml()).with_context(|| format!("writing {}", file.path().display()))?;
        file.publish()?;
    }
    Ok((Report::new(&measured.outcome, &calibration, measured.truth.as_ref()), calibration))
}

/// Makes sure that the file can be written before an hour is spent on its content.
fn claim(path: &Path) -> Result<Staged> {
    ensure!(!path.is_dir(), "cannot write {}: it is a folder", path.display());
    let file = Staged::new(path, true)?;
    if file.path() != path {
        fs::write(file.path(), "").with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(file)
}

fn origin(info: CaptureInfo, capture_sha256: String) -> Origin {
    let CaptureInfo { width, rate_conversion, temp_conversion, every_temp, divider, .. } = info;
    Origin {
        config: format!(
            "{} bit, RATECONV {rate_conversion:02X}h, TEMPCONV {temp_conversion:02X}h, every_temp {every_temp}, divider {divider}",
            width.bits()
        ),
        serial: info.serial,
        created: Some(info.created).filter(|created| !created.is_empty()),
        software: crate::SOFTWARE.to_owned(),
        device: info.device,
        capture_sha256,
        supply_note: info.supply_note,
    }
}

/// The procedure, being fed.
struct Measurement<'a> {
    acquisition: Acquisition,
    procedure: Procedure,
    log: Option<CaptureWriter>,
    hash: SampleHash,
    /// The twin's truth at the end of step 8.
    truth: Option<Truth>,
    watch: &'a mut dyn Watch,
}

/// What it came to.
struct Measured {
    outcome: Outcome,
    capture_sha256: String,
    truth: Option<Truth>,
}

impl<'a> Measurement<'a> {
    fn new(
        acquisition: Acquisition,
        procedure: Procedure,
        log: Option<CaptureWriter>,
        watch: &'a mut dyn Watch,
    ) -> Self {
        Self { acquisition, procedure, log, hash: SampleHash::new(), truth: None, watch }
    }

    fn run(mut self) -> Result<Measured> {
        let fed = self.feed();
        // Whatever happened, the log stays whole.
        if let Some(log) = self.log.take() {
            log.finish()?;
        }
        fed?;
        Ok(Measured {
            outcome: self.procedure.finish().map_err(refused)?,
            capture_sha256: self.hash.hex(),
            truth: self.truth,
        })
    }

    fn feed(&mut self) -> Result<()> {
        loop {
            match self.procedure.next() {
                Action::Initialise => self.initialise()?,
                Action::Sample => {
                    let sample = self.sample()?;
                    self.take(&sample)?;
                }
                Action::Done => return Ok(()),
            }
        }
    }

    /// The procedure's time starts with the first sample, so that a recording of the samples is all there is to know.
    fn initialise(&mut self) -> Result<()> {
        self.acquisition.device().initialise()?;
        let first = self.sample()?;
        self.procedure.handle(Event::Initialised { t_ns: first.t_ns }).map_err(refused)?;
        self.take(&first)
    }

    #[inline]
    fn sample(&mut self) -> Result<Sample> {
        match self.acquisition.next()? {
            Some(sample) => Ok(sample),
            None => Err(self.ended_early()),
        }
    }

    #[inline]
    fn take(&mut self, sample: &Sample) -> Result<()> {
        self.hash.update(sample);
        if let Some(log) = &mut self.log {
            log.push(sample)?;
        }
        let in_step_8 = self.procedure.progress().state == State::Offset;
        self.procedure.handle(Event::Sample(sample)).map_err(refused)?;
        if in_step_8 && self.procedure.progress().state != State::Offset {
            self.truth = self.acquisition.device().truth();
        }
        if self.acquisition.is_time_to_show() && !self.watch.see(&self.procedure.progress()) {
            return Err(self.interrupted());
        }
        Ok(())
    }

    #[cold]
    fn ended_early(&self) -> anyhow::Error {
        if interrupt::asked() {
            return self.interrupted();
        }
        let progress = self.procedure.progress();
        let (elapsed, total) = (Seconds(progress.elapsed_s), Seconds(progress.total_s));
        anyhow::anyhow!(
            "the recording ends after {elapsed}, during {}, but the procedure takes {total}: give the durations it was recorded for (--average, --warmup, --settle, --offset)",
            progress.state
        )
    }

    #[cold]
    fn interrupted(&self) -> anyhow::Error {
        anyhow::anyhow!("interrupted after {}; nothing written", Seconds(self.procedure.progress().elapsed_s))
    }
}

fn refused(refusal: Refusal) -> anyhow::Error {
    Refused(refusal.to_string()).into()
}
