//! Calibration by the procedure of F-51 or another method, on a part or a recording: [`prepare`], then [`Job::run`].

mod measurement;
mod report;
mod target;

pub use measurement::Watch;
pub use report::{
    AxisNumbers, AxisReport, CalibrationReport, CurvePoint, CurveTerms, POINTS, RescuedCalibration, StepReport,
    TruthReport,
};

use crate::acquisition::Acquisition;
use crate::error::InvalidOptions;
use crate::output::{Outputs, StagedOutput, rescue};
use crate::recorder::Recorder;
use anyhow::Result;
use measurement::Measurement;
use std::path::{Path, PathBuf};
use zerorate::calibration::Notes;
use zerorate::{Calibration, Method, Part, PartProcedure, Plan, SettingNames, Wording};
use zerorate_record::{CaptureInfo, Format};

/// Output files, and the facts that are written into them.
#[derive(Clone, Debug, Default)]
pub struct OutputOptions {
    /// The file of the calibration; `None` if none was requested.
    pub output: Option<PathBuf>,
    /// True if a calibration of a real part is saved as `calibration-<id>.toml` in the current folder when `output` is
    /// `None`.
    pub saves: bool,
    /// The file that records every sample; `None` to record nothing.
    pub log: Option<PathBuf>,
    /// Serial number of the part; `None` keeps the number that a recording states.
    pub serial: Option<String>,
    /// Circumstances of the measurement, as the user describes them.
    pub notes: Notes,
}

/// The settling time with which a method without steps uses all of a recording of up to a day, s.
const LONGEST_S: f64 = 86_400.0;

/// The default of [`Plan::settle_s`], s: a day if a method other than AN-1042 reads a recording, to use all of it.
#[must_use]
pub fn settle_s(method: Method, is_recorded: bool) -> f64 {
    if is_recorded && method != Method::An1042 { LONGEST_S } else { Plan::default().settle_s }
}

/// The requested output files. The file of the calibration is claimed before the measurement, which may take an hour.
#[derive(Debug)]
pub struct Files {
    pub(crate) outputs: Outputs,
    pub(crate) calibration: Option<StagedOutput>,
    pub(crate) options: OutputOptions,
}

impl Files {
    /// Claims the file of the calibration, so that no other run can write to it. The log is claimed by the run.
    ///
    /// # Errors
    /// Returns an [`OutputError`](crate::output::OutputError) if a file is refused or cannot be written, or
    /// [`InvalidOptions`] if the name of the calibration has the ending of a capture.
    pub fn claim(mut outputs: Outputs, options: OutputOptions) -> Result<Self> {
        let calibration = options.output.as_deref().map(|path| outputs.derived(path)).transpose()?;
        let is_for_samples = |path: &&PathBuf| path.extension().is_some() && Format::choose(None, path).is_ok();
        if let Some(path) = options.output.as_ref().filter(is_for_samples) {
            let why = format!("{}: a calibration is TOML; end its name in .toml", path.display());
            return Err(InvalidOptions(why).into());
        }
        Ok(Self { outputs, calibration, options })
    }

    pub(crate) fn log(&mut self, info: &CaptureInfo) -> Result<Option<Recorder>> {
        let start = |path: &PathBuf| {
            let format = Format::choose(None, path)?;
            Ok(Recorder::create(self.outputs.recording(path)?, format, info)?)
        };
        self.options.log.as_ref().map(start).transpose()
    }

    pub(crate) fn fill(mut self, calibration: &Calibration) -> Result<()> {
        let file = match (self.calibration, &self.options.output) {
            (None, Some(path)) => Some(self.outputs.derived(path)?),
            (claimed, _) => claimed,
        };
        Ok(file.map_or(Ok(()), |file| file.fill(calibration.to_toml().as_bytes()))?)
    }

    /// The requested file names, the calibration first.
    fn wanted(&self) -> Vec<PathBuf> {
        self.options.output.iter().chain(&self.options.log).cloned().collect()
    }
}

/// A measurement that is ready to run.
pub struct Job {
    acquisition: Acquisition,
    procedure: PartProcedure,
    files: Files,
}

/// Prepares a measurement. Messages use `names` for the settings. If the plan does not state the Earth's rotation, the
/// value in the recording is used.
///
/// # Errors
/// Returns [`InvalidOptions`] if the plan does not fit the part.
pub fn prepare(acquisition: Acquisition, plan: Plan, files: Files, names: SettingNames) -> Result<Job> {
    let plan = Plan { earth_dps: plan.earth_dps.or(acquisition.facts().info.earth_dps), ..plan };
    let procedure =
        PartProcedure::new(acquisition.part(), plan).map_err(|error| InvalidOptions(error.with(names).to_string()))?;
    Ok(Job { acquisition, procedure, files })
}

impl Job {
    /// The part to measure.
    #[must_use]
    pub fn part(&self) -> &Part {
        self.procedure.part()
    }

    /// The plan of the measurement.
    #[must_use]
    pub fn plan(&self) -> &Plan {
        self.procedure.plan()
    }

    /// True if the calibration will be saved although no file was named for it.
    #[must_use]
    pub fn saves(&self) -> bool {
        let options = &self.files.options;
        options.output.is_none() && options.saves && !self.acquisition.facts().info.is_simulated()
    }

    /// Runs the measurement. `watch` receives the events and may end it.
    ///
    /// # Errors
    /// Returns [`CodedRefusal`](crate::CodedRefusal) if the samples must not become a calibration. Returns another
    /// error if the recording is of another part, the device fails, the log cannot start, or `watch` ends the run.
    pub fn run(self, watch: &mut dyn Watch) -> Result<RunResult> {
        let saves = self.saves();
        let Self { mut acquisition, procedure, mut files } = self;
        target::marks_ns(procedure.plan()).for_each(|after_ns| acquisition.mark(after_ns));
        let stated = acquisition.info(files.options.serial.as_deref(), &files.options.notes)?;
        let info = CaptureInfo { earth_dps: procedure.plan().earth_dps, ..stated };
        let names = watch.names();
        let log = files.log(&info)?;
        let mut measured = Measurement::new(acquisition, procedure, log, watch).run()?;
        let at_rest = info.twin_at_rest(info.earth_dps);
        let of_all = measured.resonance.into_iter().chain(at_rest);
        measured.outcomes.iter_mut().for_each(|outcome| outcome.warnings.extend(of_all.clone()));
        let calibration = Calibration::new(&measured.part, &measured.outcomes, info.origin(measured.capture_sha256));
        let mut report = CalibrationReport::new(&measured.outcomes, &calibration, &measured.truths, names);
        if saves {
            files.options.output = Some(format!("calibration-{}.toml", calibration.id()).into());
        }
        let wanted = files.wanted();
        let delivery = match measured.log_failed {
            Some(error) => Err(error),
            None => {
                let output = files.options.output.clone();
                files.fill(&calibration).inspect(|()| report.file = output)
            }
        };
        let delivery = delivery.map_err(|why| DeliveryFailure::rescue(why, &wanted, &calibration));
        Ok(RunResult { report, calibration, delivery })
    }
}

/// A completed measurement.
pub struct RunResult {
    /// The results in numbers.
    pub report: CalibrationReport,
    /// The calibration that follows from the measurement.
    pub calibration: Calibration,
    /// An error if the calibration or the log could not be written.
    pub delivery: Result<(), DeliveryFailure>,
}

/// The name of a rescued calibration, unless the first requested file ends in `.toml`.
const UNNAMED: &str = "calibration.toml";

/// The failure to write a requested file of a calibration, or to print a calibration that no file holds.
#[derive(Debug)]
pub struct DeliveryFailure {
    /// The error of writing or printing.
    pub why: anyhow::Error,
    /// The rescue file that holds the calibration; `None` if no folder could be written.
    pub rescued: Option<PathBuf>,
}

impl DeliveryFailure {
    /// Saves the calibration beside one of the `wanted` files, or in the folder for temporary files.
    #[must_use]
    pub fn rescue(why: anyhow::Error, wanted: &[PathBuf], calibration: &Calibration) -> Self {
        let wanted: Vec<&Path> = wanted.iter().map(PathBuf::as_path).collect();
        let name = wanted.first().copied().filter(|path| path.extension().is_some_and(|ending| ending == "toml"));
        let name = name.unwrap_or(Path::new(UNNAMED));
        Self { why, rescued: rescue(name, &wanted, calibration.to_toml().as_bytes()) }
    }

    /// Makes the error that states why a file could not be written and where the calibration is instead. `also` is
    /// appended to the place of the calibration.
    #[must_use]
    pub fn error(self, also: &str) -> anyhow::Error {
        let place = match self.rescued {
            Some(file) => format!("the calibration is not lost, it stands in {}{also}", file.display()),
            None => format!("no folder takes the calibration{also}"),
        };
        self.why.context(place)
    }
}
