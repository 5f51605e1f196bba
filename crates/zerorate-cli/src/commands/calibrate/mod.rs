//! `zerorate calibrate` and `recalibrate`: the procedure of F-51, on a part or on its recording.

mod deliver;
mod plan;
mod report;
mod target;

use super::serial::one_line;
use crate::acquire::Acquisition;
use crate::device::{DeviceArgs, SamplingArgs};
use crate::exit::{Refused, Usage};
use crate::interrupt;
use crate::output::{Outputs, Staged, say, warn};
use crate::part::PartArgs;
use crate::progress::{Meter, Watch};
use crate::recorder::Recorder;
use crate::wording::flag;
use adis16130_twin::Truth;
use anyhow::Result;
use clap::Args;
pub(super) use deliver::Undelivered;
use plan::PlanArgs;
pub use report::{CurvePoint, POINTS, Report};
use std::path::{Path, PathBuf};
use target::Target;
use zerorate::{
    Action, AxisRefusal, Calibration, Event, Names, Outcome, Part, PartProcedure, Plan, Say, Scan, State, Warning,
};
use zerorate_data::capture::{CaptureInfo, Format, Layout, Row, SampleHash};
use zerorate_host::{DeviceSpec, Facts, Setup, Stop};
use zerorate_view::duration::Seconds;

/// Finds the bias of a part and how it changes with temperature.
///
/// The procedure of the application note AN-1042: two averages with a warm-up between them give the temperature
/// coefficient BTC, a long average after settling gives the bias correction PBC at the temperature T3:
///
/// corrected rate = RATE + PBC + (TEMP − T3) · BTC
///
/// Which method: `an1042` is the note to the letter. `warmup` takes every sample of the same hour: a curve of order 0
/// to 3 over temperature, known at every temperature, with the part's own noise, steps of the supply and a lag in it.
/// `cycle` does so while you heat and cool the part, and leaves the least on a table. For the temperatures that the
/// part will see take `zerorate chamber`; to keep any of them good, `zerorate stream --track`.
///
/// Fix the part to a still platform, supply it from a linear 5 V supply, and let it have been off for an hour.
/// A part that moves, freezes, hardly changes its temperature or loses too many samples is refused (exit code 3).
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
}

/// Computes the calibration again from a recorded capture.
///
/// The same samples give the same numbers, bit for bit, if the durations are those it was recorded for.
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

/// What becomes of the result.
#[derive(Args, Debug)]
#[command(next_help_heading = "Result")]
struct ResultArgs {
    /// Write the calibration file. It gets its name only when it is complete.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Overwrite existing files: an older calibration only by a good new one, a capture only by --log.
    #[arg(long)]
    force: bool,

    /// Serial number of the part, stored in the file.
    #[arg(long, value_name = "SN", value_parser = one_line)]
    serial: Option<String>,

    /// A note on the supply, stored in the file.
    #[arg(long, value_name = "TEXT", value_parser = one_line)]
    supply_note: Option<String>,

    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

impl ResultArgs {
    /// Before anything is read.
    fn outputs(&self) -> Outputs {
        Outputs::new(self.force).printing()
    }
}

pub fn run(args: &CalibrateArgs) -> Result<()> {
    let mut outputs = args.result.outputs();
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    let files = Files::claim(outputs, &args.result, args.log.as_deref())?;
    let acquisition = Acquisition::open(&args.device, setup)?;
    calibrate(acquisition, args.plan.plan(args.device.file().is_some()), &args.result, files)
}

pub fn run_again(args: &RecalibrateArgs) -> Result<()> {
    interrupt::listen();
    let mut outputs = args.result.outputs().reading([&*args.capture])?;
    let setup = Setup { part: args.part.named(&mut outputs)?, ..Setup::default() };
    let files = Files::claim(outputs, &args.result, None)?;
    let recording = DeviceSpec::replay(args.capture.clone());
    let acquisition = Acquisition::unpaced(&recording, setup, interrupt::stop())?;
    calibrate(acquisition, args.plan.plan(true), &args.result, files)
}

/// The measurement alone, for another program: prints nothing, leaves Ctrl-C alone, and ends when `watch` says so.
pub fn measured(args: &CalibrateArgs, watch: &mut dyn Watch) -> Result<(Report, Calibration)> {
    let mut outputs = args.result.outputs();
    let setup = args.device.setup(args.sampling, &mut outputs)?;
    let files = Files::claim(outputs, &args.result, args.log.as_deref())?;
    let acquisition = Acquisition::unpaced(&args.device.device, setup, &Stop::default())?;
    let procedure = procedure(acquisition.part(), args.plan.plan(args.device.file().is_some()), watch.names())?;
    let Done { report, calibration, kept } = measure(acquisition, procedure, &args.result, files, watch)?;
    kept.map_err(Undelivered::into_error)?;
    Ok((report, calibration))
}

fn calibrate(acquisition: Acquisition, plan: Plan, result: &ResultArgs, files: Files) -> Result<()> {
    let procedure = procedure(acquisition.part(), plan, flag)?;
    if !result.json {
        let (part, plan) = (procedure.part(), procedure.plan());
        target::forecasts(part, plan).iter().for_each(|line| say(format_args!("{line}")));
    }
    let mut meter = Meter::new(procedure.plan().total_s());
    let done = measure(acquisition, procedure, result, files, &mut meter)?;
    drop(meter);
    if !result.json {
        warn(&done.report.warnings());
    }
    match done.kept {
        Ok(()) => deliver::print_result(&done.report, &done.calibration, result),
        Err(undelivered) => undelivered.print(done.report, &done.calibration, result.json),
    }
}

fn procedure(part: &Part, plan: Plan, names: Names) -> Result<PartProcedure> {
    PartProcedure::new(part, plan).map_err(|error| Usage(error.with(names).to_string()).into())
}

fn measure(
    mut acquisition: Acquisition,
    procedure: PartProcedure,
    result: &ResultArgs,
    mut files: Files,
    watch: &mut dyn Watch,
) -> Result<Done> {
    target::marks_ns(procedure.plan()).for_each(|after_ns| acquisition.mark(after_ns));
    let info = acquisition.info(result.serial.as_deref(), result.supply_note.as_deref());
    let names = watch.names();
    let log = files.log(acquisition.facts(), &info)?;
    let mut measured = Measurement::new(acquisition, procedure, log, watch).run()?;
    measured.outcomes.iter_mut().for_each(|outcome| outcome.warnings.extend(measured.resonance));
    let calibration = Calibration::new(&measured.part, &measured.outcomes, info.origin(measured.capture_sha256));
    let report = Report::new(&measured.outcomes, &calibration, &measured.truths, names);
    let kept = match measured.log_failed {
        Some(error) => Err(error),
        None => {
            files.calibration.map_or(Ok(()), |file| file.fill(calibration.to_toml().as_bytes())).map_err(Into::into)
        }
    };
    let kept = kept.map_err(|why| Undelivered::rescue(why, &files.wanted, &calibration));
    Ok(Done { report, calibration, kept })
}

/// A measurement that came to a result.
struct Done {
    report: Report,
    calibration: Calibration,
    /// Whether all files that were asked for are there.
    kept: Result<(), Undelivered>,
}

/// The files that were asked for, claimed before an hour is spent on their content.
struct Files {
    outputs: Outputs,
    calibration: Option<Staged>,
    log: Option<PathBuf>,
    /// What they were to be called, that of the calibration first.
    wanted: Vec<PathBuf>,
}

impl Files {
    fn claim(mut outputs: Outputs, result: &ResultArgs, log: Option<&Path>) -> Result<Self> {
        Ok(Self {
            calibration: result.output.as_deref().map(|path| outputs.derived(path)).transpose()?,
            log: log.map(Path::to_owned),
            wanted: result.output.as_deref().into_iter().chain(log).map(Path::to_owned).collect(),
            outputs,
        })
    }

    /// Starts the log, once there is something to record.
    fn log(&mut self, facts: &Facts, info: &CaptureInfo) -> Result<Option<Recorder>> {
        let start = |path: PathBuf| {
            let file = self.outputs.recording(&path)?;
            Ok(Recorder::create(file, Format::choose(None, &path), facts, info, None)?)
        };
        self.log.take().map(start).transpose()
    }
}

/// The procedure, being fed.
struct Measurement<'a> {
    acquisition: Acquisition,
    layout: Layout,
    procedure: PartProcedure,
    log: Option<Recorder>,
    log_failed: Option<anyhow::Error>,
    hash: SampleHash,
    /// The twin's truth at the end of step 8, or of the recording, of each axis.
    truths: Vec<Truth>,
    target: Target,
    watch: &'a mut dyn Watch,
}

/// What it came to.
struct Measured {
    part: Part,
    /// Of each axis.
    outcomes: Vec<Outcome>,
    capture_sha256: String,
    truths: Vec<Truth>,
    /// F-07: whether the resonance looks like a bias at the rate that was measured.
    resonance: Option<Warning>,
    log_failed: Option<anyhow::Error>,
}

impl<'a> Measurement<'a> {
    fn new(
        acquisition: Acquisition,
        procedure: PartProcedure,
        log: Option<Recorder>,
        watch: &'a mut dyn Watch,
    ) -> Self {
        let layout = acquisition.facts().info.layout.clone();
        let hash = SampleHash::new(&layout);
        Self {
            acquisition,
            layout,
            procedure,
            log,
            log_failed: None,
            hash,
            truths: Vec::new(),
            target: Target::default(),
            watch,
        }
    }

    fn run(mut self) -> Result<Measured> {
        let fed = self.feed();
        // Whatever happened, the log stays whole.
        if let Some(Err(error)) = self.log.take().map(Recorder::finish) {
            self.lose_log(error.into());
        }
        fed?;
        let (plan, names) = (self.procedure.plan(), self.watch.names());
        let resonance = self.acquisition.resonance(plan.average_s.min(plan.offset_s));
        Ok(Measured {
            resonance,
            part: self.procedure.part().clone(),
            outcomes: self.procedure.finish().map_err(|refusal| refused(&refusal, names))?,
            capture_sha256: self.hash.hex(),
            truths: self.truths,
            log_failed: self.log_failed,
        })
    }

    fn feed(&mut self) -> Result<()> {
        loop {
            match self.procedure.next() {
                Action::Initialise => self.initialise()?,
                Action::Read => match self.acquisition.next()? {
                    Some(row) => self.take(&row)?,
                    None => self.end()?,
                },
                Action::Done => return Ok(()),
            }
        }
    }

    /// The procedure's time starts with the first row, so that a recording of the rows is all there is to know.
    fn initialise(&mut self) -> Result<()> {
        self.acquisition.initialise()?;
        let Some(first) = self.acquisition.next()? else { return Err(self.ended_early()) };
        self.handle(Event::Initialised { t_ns: first.t_ns })?;
        self.take(&first)
    }

    /// There are no more samples: a recording of any length will do where the method takes no steps.
    fn end(&mut self) -> Result<()> {
        let names = self.watch.names();
        let whole =
            !interrupt::asked() && self.procedure.end_recording().map_err(|refusal| refused(&refusal, names))?;
        if whole { Ok(()) } else { Err(self.ended_early()) }
    }

    #[inline]
    fn take(&mut self, row: &Row) -> Result<()> {
        self.hash.update(row);
        if let Some(Err(error)) = self.log.as_mut().map(|log| log.push(row)) {
            self.lose_log(error.into());
        }
        let before = self.procedure.progress().state;
        self.handle(Event::Reading(&self.layout.scan(row)))?;
        if before == State::Recording || before == State::Offset && self.procedure.progress().state != State::Offset {
            self.mark()?;
        }
        if self.acquisition.is_time_to_show() && !self.watch.see(&self.procedure.progress()) {
            return Err(self.interrupted());
        }
        Ok(())
    }

    /// Where the twin was asked for its truth, it is kept; and with a target, looked at whether that is reached.
    #[inline]
    fn mark(&mut self) -> Result<()> {
        let truths = self.acquisition.truths();
        if !truths.is_empty() {
            self.truths = truths;
        }
        if self.procedure.plan().target_dps.is_some() && self.target.is_due(&self.procedure) {
            let names = self.watch.names();
            if self.target.is_reached(&self.procedure) {
                self.procedure.end_recording().map_err(|refusal| refused(&refusal, names))?;
            }
            self.watch.note(self.target.left());
        }
        Ok(())
    }

    #[inline]
    fn handle(&mut self, event: Event<'_, Scan>) -> Result<()> {
        self.procedure.handle(event).map_err(|refusal| refused(&refusal, self.watch.names()))
    }

    /// A log that fails is a failure, but no reason to throw away the measurement.
    #[cold]
    fn lose_log(&mut self, error: anyhow::Error) {
        let elapsed = Seconds(self.procedure.progress().elapsed_s);
        warn(&[format!("log-failed: the log failed after {elapsed}, the measurement goes on: {error:#}")]);
        self.log = None;
        self.log_failed = Some(error);
    }

    #[cold]
    fn ended_early(&self) -> anyhow::Error {
        if interrupt::asked() {
            return self.interrupted();
        }
        let progress = self.procedure.progress();
        let (elapsed, total) = (Seconds(progress.elapsed_s), Seconds(progress.total_s));
        anyhow::anyhow!(
            "the recording ends after {elapsed}, during {}, but the procedure takes {total}: give the durations it \
             was recorded for (--average, --warmup, --settle, --offset)",
            progress.state
        )
    }

    #[cold]
    fn interrupted(&self) -> anyhow::Error {
        anyhow::anyhow!("interrupted after {}; nothing written", Seconds(self.procedure.progress().elapsed_s))
    }
}

fn refused(refusal: &AxisRefusal, names: Names) -> anyhow::Error {
    Refused::new(refusal.refusal.code(), refusal.with(names).to_string()).into()
}
