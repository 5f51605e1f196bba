//! Calibration over the temperature range of a chamber: [`SetPointControl::new`], [`prepare`], then [`Job::run`].

mod chamber_loop;
mod finished_steps;
mod plan;
mod report;
mod set_point_control;

pub use plan::PlanFile;
pub use report::{AxisReport, ChamberReport};
pub use set_point_control::{AirListener, AirState, SetPointControl};

use crate::acquisition::{Acquisition, aliasing};
use crate::calibrate::{self, DeliveryFailure, OutputOptions};
use crate::error::{CodedRefusal, InvalidOptions};
use crate::output::{Outputs, Slot, StagedOutput};
use crate::warning::{CodedWarning, JobWarning};
use anyhow::Result;
use chamber_loop::{ChamberLoop, LoopResult, TICK_NS};
use finished_steps::FinishedSteps;
use std::path::{Path, PathBuf};
use zerorate::calibration::ChamberRun;
use zerorate::chamber::{ChamberOutcome, ChamberProcedure, ChamberProgress, ChamberRefusal, Record, Step};
use zerorate::{Calibration, Part, SettingNames, Warning};
use zerorate_host::ProfileWriter;
use zerorate_record::CaptureInfo;
use zerorate_view::SessionWarning;
use zerorate_view::report::wide_loop;

/// Receives the events of a measurement in a chamber.
pub trait Watch {
    /// Receives the progress, every 4096 samples.
    fn see(&mut self, progress: &ChamberProgress);

    /// Called when a resumed measurement continues after `steps` of `all` steps, `gap_s` seconds after their end.
    fn resume(&mut self, steps: usize, all: usize, gap_s: f64);

    /// Called when a person has to set the chamber for this step.
    fn step(&mut self, progress: &ChamberProgress, step: &Step);

    /// Receives a warning while the measurement goes on.
    fn warn(&mut self, warning: JobWarning);

    /// Writes the requested HTML page.
    ///
    /// # Errors
    /// Returns an error if the page cannot be made or written.
    fn page(&mut self, results: &ChamberResults, file: StagedOutput) -> Result<()>;

    /// The names that the front end uses for the settings.
    fn names(&self) -> SettingNames;
}

/// Settings that decide what is refused and how the samples are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct ChamberOptions {
    /// Largest allowed share of lost samples, 0 to 1.
    pub max_lost: f64,
    /// The Earth's rotation on the axis, which is subtracted, °/s; `None` for the value in a recording, or else 0.
    pub earth_dps: Option<f64>,
    /// Highest polynomial order of the bias over temperature.
    pub max_order: usize,
    /// True to start anew although finished steps were saved.
    pub restart: bool,
    /// True if the program or a person changes the air temperature, which then must stay within the part's limits.
    pub moves_air: bool,
}

/// The error for saved steps that are damaged or belong to another measurement.
#[derive(Debug, thiserror::Error)]
#[error("{} does not go on with this measurement: {why}", path.display())]
pub struct UnusableSteps {
    /// The file of the finished steps.
    pub path: PathBuf,
    /// The reason why the saved steps cannot be used.
    pub why: String,
}

/// The requested output files. All except the log are claimed before the measurement, which may take hours.
#[derive(Debug)]
pub struct Files {
    of_calibration: calibrate::Files,
    page: Option<StagedOutput>,
    steps: Option<Slot>,
}

impl Files {
    /// Claims the files of the calibration and of the finished steps and, if requested, a `page`. Finished steps of a
    /// replayed recording are not kept.
    ///
    /// # Errors
    /// Returns an [`OutputError`](crate::output::OutputError) if a file is refused or cannot be written, or
    /// [`InvalidOptions`] if the name of the calibration has the ending of a capture.
    pub fn claim(outputs: Outputs, options: OutputOptions, page: Option<&Path>, is_replayed: bool) -> Result<Self> {
        // no file is put beside a device, such as /dev/null
        let output = options.output.clone().filter(|path| !is_replayed && (!path.exists() || path.is_file()));
        let mut of_calibration = calibrate::Files::claim(outputs, options)?;
        let outputs = &mut of_calibration.outputs;
        let page = page.map(|path| outputs.derived(path)).transpose()?;
        let steps = output.map(|path| outputs.slot(&FinishedSteps::beside(&path))).transpose()?;
        Ok(Self { of_calibration, page, steps })
    }
}

/// A measurement that is ready to run. `writer` is the first field, so it is dropped first: the simulated part waits
/// for the temperatures that `writer` sends.
pub struct Job {
    writer: Option<ProfileWriter>,
    control: SetPointControl,
    acquisition: Acquisition,
    procedure: ChamberProcedure,
    steps: FinishedSteps,
    files: Files,
    info: CaptureInfo,
    plan: PlanFile,
    options: ChamberOptions,
    resumed: Option<(usize, f64)>,
}

/// Prepares a measurement. The writer sets the ambient temperature of a simulated sensor.
///
/// # Errors
/// Returns [`InvalidOptions`] if the plan does not fit the part, [`UnusableSteps`] if saved steps are damaged or
/// belong to another measurement, or an error if the recording is of another part or a file cannot be read.
pub fn prepare(
    acquisition: Acquisition,
    (control, writer): (SetPointControl, Option<ProfileWriter>),
    plan: PlanFile,
    mut files: Files,
    mut options: ChamberOptions,
) -> Result<Job> {
    let (part, facts) = (acquisition.part(), acquisition.facts());
    if options.moves_air {
        plan.plan.spares(part).map_err(|error| InvalidOptions(error.to_string()))?;
    }
    let OutputOptions { serial, notes, .. } = &files.of_calibration.options;
    let mut info = acquisition.info(serial.as_deref(), notes)?;
    options.earth_dps = options.earth_dps.or(info.earth_dps);
    info.earth_dps = options.earth_dps;
    let procedure = ChamberProcedure::new(part, plan.plan.clone(), options.max_lost);
    let mut procedure = procedure.map_err(|error| InvalidOptions(error.to_string()))?;
    let steps = FinishedSteps {
        slot: files.steps.take(),
        plan_text: plan.text.clone(),
        part: part.clone(),
        device: info.device.clone(),
        serial: info.serial.clone().unwrap_or_default(),
        is_real: facts.is_real,
    };
    let mut resumed = None;
    if let Some((saved, gap_s)) = steps.found(options.restart)? {
        resumed = Some((saved.steps, gap_s));
        procedure = procedure.resumed(saved.record, saved.steps, gap_s);
    }
    Ok(Job { writer, control, acquisition, procedure, steps, files, info, plan, options, resumed })
}

impl Job {
    /// The part to measure.
    #[must_use]
    pub fn part(&self) -> &Part {
        self.acquisition.part()
    }

    /// The minimum remaining duration, s.
    #[must_use]
    pub fn left_s(&self) -> f64 {
        self.procedure.progress().left_s
    }

    /// Runs the measurement. `watch` receives the events.
    ///
    /// # Errors
    /// Returns [`CodedRefusal`] if the samples must not become a calibration, or another error if the part or the
    /// chamber fails, or the log cannot be started.
    pub fn run(mut self, watch: &mut dyn Watch) -> Result<RunResult> {
        if self.options.moves_air && self.part().operating_c.is_none() {
            watch.warn(JobWarning::LimitsUnknown);
        }
        if let Some((steps, gap_s)) = self.resumed {
            watch.resume(steps, self.plan.plan.steps.len(), gap_s);
        }
        if self.writer.is_some() {
            mark_ticks(&mut self.acquisition, &self.procedure);
        }
        let log = self.files.of_calibration.log(&self.info)?;
        let Self { writer, control, acquisition, procedure, steps, files, info, plan, options, resumed } = self;
        let running = ChamberLoop::new((control, writer), acquisition, procedure, steps, log, &mut *watch);
        let (mut result, mut steps) = running.run()?;
        let log_failed = result.log_failed.take();
        let results = ChamberResults::new(result, info, &plan, options, resumed.is_some(), watch.names())?;
        let wanted: Vec<PathBuf> = files.of_calibration.options.output.iter().cloned().collect();
        let delivery = match log_failed {
            Some(error) => Err(error),
            None => files
                .page
                .map_or(Ok(()), |file| watch.page(&results, file))
                .and_then(|()| files.of_calibration.fill(&results.calibration)),
        };
        let delivery = delivery.map_err(|why| DeliveryFailure::rescue(why, &wanted, &results.calibration));
        if delivery.is_ok() {
            steps.forget();
        }
        Ok(RunResult { results, delivery })
    }
}

/// Makes batches of the simulated part end at each second, where its chamber changes the air temperature. This covers
/// the longest duration of the plan.
fn mark_ticks(acquisition: &mut Acquisition, procedure: &ChamberProcedure) {
    /// The longest duration that is covered, s: two weeks. No simulated measurement takes longer.
    const MOST_S: f64 = 14.0 * 86_400.0;
    let plan = procedure.plan();
    let slack_s = 5.0 * (plan.settle_timeout_s + 3600.0) * plan.steps.len() as f64;
    let most_s = (plan.least_s(0, procedure.part()) + slack_s).min(MOST_S) as u64;
    (0..=most_s).for_each(|second| acquisition.mark(second * TICK_NS));
}

/// A completed measurement.
pub struct RunResult {
    /// The calibration, and the numbers behind it.
    pub results: ChamberResults,
    /// An error if a requested file could not be written.
    pub delivery: Result<(), DeliveryFailure>,
}

/// The results of a measurement.
pub struct ChamberResults {
    /// The results in numbers.
    pub report: ChamberReport,
    /// The calibration that follows from the measurement.
    pub calibration: Calibration,
    /// The means of rate and temperature over each second, and over each soak.
    pub record: Record,
    /// The outcome of each axis.
    pub outcomes: Vec<ChamberOutcome>,
}

impl ChamberResults {
    fn new(
        result: LoopResult,
        info: CaptureInfo,
        plan: &PlanFile,
        options: ChamberOptions,
        is_resumed: bool,
        names: SettingNames,
    ) -> Result<Self> {
        let LoopResult { procedure, acquisition, capture_sha256, truths, .. } = result;
        let ChamberOptions { max_lost, earth_dps, max_order, .. } = options;
        let (part, tally) = (procedure.part().clone(), *procedure.tally());
        let refused = |refusal: ChamberRefusal| CodedRefusal::new(refusal.code(), refusal.to_string());
        let record = procedure.finish().map_err(refused)?;
        let outcomes = record.outcomes(&part, earth_dps, max_order).map_err(refused)?;
        let aliased = part.axes.first().and_then(|axis| aliasing(&axis.axis, &tally));
        let of_device = aliased.into_iter().chain(info.twin_at_rest(earth_dps));
        let warnings: Vec<Warning> = record.warnings(earth_dps).chain(of_device).collect();
        let run = ChamberRun { tally: &tally, max_lost, earth_dps, warnings: &warnings };
        // samples before the interruption are not in this run's recording
        let capture_sha256 = if is_resumed { String::new() } else { capture_sha256 };
        let calibration = Calibration::of_chamber(&part, &record, &outcomes, &run, info.origin(capture_sha256));
        let (remarks, mut warnings) = JobWarning::remarks_apart(warnings, names);
        let of_run = acquisition.disbelief().chain(is_resumed.then_some(JobWarning::Resumed));
        warnings.extend(of_run.map(|warning| warning.coded(names)).chain(of_axes(&outcomes, &part, names)));
        let report = ChamberReport::new(&plan.name, &calibration, &record, &outcomes, &truths, (remarks, warnings));
        Ok(Self { report, calibration, record, outcomes })
    }
}

/// The warnings of all axes. With several axes, each warning has the name of its axis.
fn of_axes(outcomes: &[ChamberOutcome], part: &Part, names: SettingNames) -> impl Iterator<Item = CodedWarning> {
    let several = part.axes.len() > 1;
    let axes = || outcomes.iter().zip(part.axes.iter());
    let own = axes().flat_map(move |(outcome, axis)| {
        let coded = move |warning: Warning| JobWarning::from(warning).coded(names);
        let of_axis = move |one: CodedWarning| if several { one.of_axis(&axis.name) } else { one };
        outcome.warnings(&axis.axis).map(coded).map(of_axis)
    });
    let wide = axes().filter_map(|(outcome, axis)| wide_loop(outcome, &axis.name));
    own.chain(wide.map(move |text| JobWarning::from(SessionWarning::WideLoop(text)).coded(names)))
}
