//! A column of a log on its way from file to result: its deviations, its noise model, and what is to be said of it.
//!
//! The command line and the page take this way. Python analyses arrays in place, and takes the pieces.

use crate::moving::{moving, shared};
use crate::{Axis, ImuWarning, Kind, Rejection, Rejections, coded};
use crate::{Detrending, DetrendingError};
use std::path::{Path, PathBuf};
use zerorate_allan::{
    self as allan, AllanWarning, Analysis, AnalysisError, Averaging, Density, DetrendedRate, Envelope, Fit, FitError,
    FitOptions, FittedRecord, Input, Line, Options, Point, Prediction, Preparation, Stat, Taus, interval,
};
use zerorate_logs::{Column, LogError, LogWarning, Names, Quantity};

/// A column of a log and what was found in it.
pub struct Record {
    /// The log.
    pub file: PathBuf,
    /// The name of the column.
    pub column: String,
    /// The quantity of the deviations, in the unit of its results; none: nobody stated the unit.
    pub quantity: Option<Quantity>,
    /// Confidence of the intervals.
    pub confidence: f64,
    /// Its deviations.
    pub analysis: Analysis,
    /// The deviations at the averaging times of pictures, where those differ.
    finer: Option<Analysis>,
    /// None where nobody asked for it.
    pub fit: Option<Result<Fit, FitError>>,
    /// The rate in the unit of the results; only where it is fitted once more, and nothing was taken out before.
    pub rate: Option<Vec<f64>>,
    /// The warnings about the log.
    pub notes: Vec<LogWarning>,
    /// The rate follows the temperature, and the record has no model that would say so.
    pub follows: Option<AllanWarning>,
    /// The picture beside its curve; none unless it was asked for, and only of a rate.
    pub plot_data: Option<PlotData>,
    /// The polynomial over temperature that was taken out.
    pub detrended: Option<DetrendedRate>,
    /// The time left out at its beginning, s.
    pub skipped_s: f64,
    /// Where it moves, s from its start; `None` if a valid model describes it.
    moving_s: Option<Vec<(f64, f64)>>,
    /// The names of the settings in messages.
    names: Names,
}

/// A record as one looks at it.
pub struct PlotData {
    /// The samples as they were read.
    pub envelope: Envelope,
    /// Without what was taken out before the fit.
    pub spectrum: Vec<Density>,
}

impl PlotData {
    fn of(column: &Column, file: &Path, cleaned: Option<&[f64]>) -> Result<Self, RecordError> {
        let mut samples = column.points(file)?;
        samples.iter_mut().for_each(|sample| *sample *= column.scale);
        let spectrum = allan::welch(cleaned.unwrap_or(&samples), column.rate_hz)
            .map_err(|why| RecordError::Spectrum(label(file, &column.name), why.to_string()))?;
        Ok(Self { envelope: Envelope::new(&samples, column.rate_hz), spectrum })
    }
}

/// The options of an analysis.
#[derive(Clone, Debug, Default)]
pub struct AnalysisOptions {
    /// It holds a phase, the integral of a rate.
    pub is_phase: bool,
    /// Its gaps are closed up.
    pub closes_gaps: bool,
    /// In the unit of the column.
    pub deviations: Options,
    /// Pictures have more averaging times than the options say.
    pub draws_finely: bool,
    /// Before a fit; none: no fit.
    pub fit: Option<FitOptions>,
    /// Whether the record itself is drawn, and its spectrum.
    pub draws: bool,
    /// The rate is needed for a model of several records.
    pub keeps_rate: bool,
    /// The preparation: time left out, temperature and drift taken out.
    pub detrending: Detrending,
}

/// Why a column cannot be analysed.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The preparation failed.
    #[error(transparent)]
    Detrending(#[from] DetrendingError),
    /// Its numbers must not become a result, or cannot be written out.
    #[error(transparent)]
    Log(#[from] LogError),
    /// Too few samples for a deviation.
    #[error("{0}: {1} samples are too few, at least 2 are needed")]
    TooFew(String, usize),
    /// The options ask for what there is not.
    #[error("cannot analyse {0}: {1}")]
    Analysis(String, AnalysisError),
    /// It has no spectrum.
    #[error("{0}: {1}")]
    Spectrum(String, String),
}

impl Record {
    /// Analyses a column of the log `file`. Its temperature is another column.
    ///
    /// # Errors
    /// Returns an error if the record has nothing to analyse, or its numbers must not become a result.
    pub fn of(
        mut column: Column,
        file: &Path,
        options: &AnalysisOptions,
        temperature: Option<&Column>,
    ) -> Result<Self, RecordError> {
        let mut notes = column.warnings.clone();
        let settled = options.detrending.apply(&mut column, file, temperature)?;
        notes.extend(gaps(options, file, &mut column));
        let (samples, skipped_s) = (column.series.len(), column.skipped_s);
        if samples < 2 {
            return Err(RecordError::TooFew(label(file, &column.name), samples));
        }
        // a lost phase point is a point that is not there
        let phase = options.is_phase.then(|| column.points(file)).transpose()?;
        let input = phase.as_deref().map_or_else(|| column.input(), Input::Phase);
        notes.extend(column.stopped(file)?);
        let analysed = FittedRecord::new(input, column.rate_hz, column.scale, options.fit, &settled);
        let analyse = |taus: &Taus| {
            let deviations = Options { taus: taus.clone(), ..options.deviations };
            let failed = |why| RecordError::Analysis(file.display().to_string(), why);
            analysed.deviations(&deviations).map_err(failed)
        };
        let analysis = analyse(&options.deviations.taus)?;
        let finer = options.draws_finely.then(|| analyse(&Taus::Fine)).transpose()?;
        let rate = (options.keeps_rate && analysed.cleaned().is_none()).then(|| analysed.rates());
        let draws = options.draws && !options.is_phase;
        let plot_data = draws.then(|| PlotData::of(&column, file, analysed.cleaned())).transpose()?;
        let mut fit = analysed.into_fit();
        if let (Some(Ok(fit)), false) = (&mut fit, options.keeps_rate) {
            fit.cleaned.rate = None;
        }
        let Preparation { detrended, follows } = settled;
        let follows = follows.filter(|_| !matches!(fit, Some(Ok(_))));
        let is_sound = match &fit {
            Some(Ok(fit)) => !fit.is_rejected && !stands_out(fit),
            Some(Err(_)) => false,
            None => true,
        };
        let moving_s = if is_sound { None } else { Some(moving(&column.points(file)?, column.rate_hz)) };
        Ok(Self {
            file: file.to_owned(),
            column: column.name,
            quantity: column.quantity,
            confidence: options.deviations.confidence,
            analysis,
            finer,
            fit,
            rate,
            notes,
            follows,
            plot_data,
            detrended,
            skipped_s,
            moving_s,
            names: options.detrending.names,
        })
    }

    /// Records of one type as one: the mean of the curves, each weighed by its terms, with the common model.
    pub fn together(used: &[&Self], fit: Fit, notes: Vec<LogWarning>) -> Self {
        let first = used[0];
        let samples = used.iter().map(|record| record.analysis.samples).max().unwrap_or(0);
        let longest = used.iter().find(|record| record.analysis.samples == samples).unwrap_or(&first);
        let point = |point: &Point| {
            let same = used.iter().filter_map(|record| record.analysis.points.iter().find(|other| other.m == point.m));
            let same: Vec<&Point> = same.collect();
            let n = same.iter().map(|point| point.n).sum::<u64>();
            let square = same.iter().map(|point| point.n as f64 * point.dev * point.dev).sum::<f64>() / n as f64;
            let (dev, edf) = (square.sqrt(), same.iter().map(|point| point.edf).sum::<f64>());
            let (lo, hi) = interval(dev, edf, first.confidence);
            Point { dev, lo, hi, edf, n, ..*point }
        };
        let analysis =
            Analysis { points: longest.analysis.points.iter().map(point).collect(), ..longest.analysis.clone() };
        Self {
            file: PathBuf::from("pool"),
            column: first.column.clone(),
            quantity: first.quantity,
            confidence: first.confidence,
            analysis,
            finer: None,
            fit: Some(Ok(fit)),
            rate: None,
            notes,
            follows: None,
            plot_data: None,
            detrended: None,
            skipped_s: 0.0,
            moving_s: None,
            names: first.names,
        }
    }

    /// The warnings about the model.
    pub fn of_model(&self) -> &[AllanWarning] {
        self.model().map_or(&[], |fit| &fit.warnings)
    }

    /// The warnings about its noise: that it follows the temperature, and the warnings about the model.
    pub fn of_noise(&self) -> impl Iterator<Item = &AllanWarning> {
        self.follows.iter().chain(self.of_model())
    }

    /// All its warnings as scripts read them, `code: text`, those about the log first.
    pub fn warnings(&self) -> Vec<String> {
        self.notes.iter().map(LogWarning::coded).chain(self.noise_warnings()).collect()
    }

    /// The warnings about its noise as scripts read them.
    pub fn noise_warnings(&self) -> impl Iterator<Item = String> {
        self.of_noise().map(|warning| coded(warning, self.names))
    }

    /// The label that tells this log from others: the file, and the column.
    pub fn label(&self) -> String {
        label(&self.file, &self.column)
    }

    /// Whether it is of the part that AN-1042 is about, as the columns of captures and corrections of it are called.
    pub fn is_of_adis16130(&self) -> bool {
        matches!(self.column.as_str(), "rate_code" | "rate_corrected_dps")
    }

    /// The name of the deviation.
    pub fn title(&self) -> &'static str {
        self.analysis.stat.title()
    }

    /// The analysis that pictures show.
    pub fn drawn(&self) -> &Analysis {
        self.finer.as_ref().unwrap_or(&self.analysis)
    }

    /// The model, if there is one.
    pub fn model(&self) -> Option<&Fit> {
        self.fit.as_ref()?.as_ref().ok()
    }

    /// The frequency up to which its model holds, Hz, if the sensor's filter shapes the noise above.
    pub fn max_freq_hz(&self) -> Option<f64> {
        let max_freq_hz = self.model()?.max_freq_hz;
        (max_freq_hz < 0.499 * self.analysis.rate_hz).then_some(max_freq_hz)
    }

    /// The lines in its spectrum.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.model().into_iter().flat_map(Fit::lines)
    }

    /// The model, if it is not rejected: what may be called a result and go into files.
    ///
    /// # Errors
    /// Returns a [`Rejection`] if there is no model, or the model is rejected.
    pub fn valid_model(&self) -> Result<&Fit, Rejection> {
        match &self.fit {
            Some(Ok(fit)) => Rejection::about(fit).map_or(Ok(fit), Err),
            Some(Err(why)) => Err(Rejection::NoModel(why.to_string())),
            None => Err(Rejection::NoModel("no noise model was asked for".to_owned())),
        }
    }

    /// The kind of axis of an IMU, if it is one.
    pub fn kind(&self) -> Option<Kind> {
        Kind::of(self.quantity?)
    }

    /// Itself with its model, where it has one and is an axis of an IMU.
    pub fn axis(&self) -> Option<Axis<'_>> {
        let (kind, fit, rate_hz) = (self.kind()?, self.model()?, self.analysis.rate_hz);
        Some(Axis { name: &self.column, kind, rate_hz, fit, scale: 1.0 })
    }

    /// The axes of an IMU among these records. Records without a noise model are left out.
    pub fn axes(records: &[Self]) -> Vec<Axis<'_>> {
        records.iter().filter_map(Self::axis).collect()
    }

    /// Why axes of an IMU among several records have no result.
    pub fn doubts(records: &[Self]) -> Rejections {
        let axes = records.iter().filter(|record| record.kind().is_some());
        Rejections::about(axes.map(|record| (record.column.as_str(), record.valid_model().err())))
    }

    /// The models of several records, each by the name of its column.
    pub fn models(records: &[Self]) -> Vec<(&str, &Fit)> {
        records.iter().filter_map(|record| Some((record.column.as_str(), record.model()?))).collect()
    }

    /// The warnings about motion that several axes of one log show.
    pub fn motion(axes: &[Self]) -> Vec<ImuWarning> {
        let Some(first) = axes.first() else { return Vec::new() };
        let (start_s, end_s) =
            (first.skipped_s, first.skipped_s + first.analysis.samples as f64 / first.analysis.rate_hz);
        let spans: Vec<&[(f64, f64)]> = axes.iter().filter_map(|axis| axis.moving_s.as_deref()).collect();
        let moving = shared(&spans).into_iter().map(|(from_s, to_s)| (start_s + from_s, start_s + to_s)).collect();
        let moves = ImuWarning::of_moving(moving, (start_s, end_s), first.names);
        moves.into_iter().chain(ImuWarning::of_motion(&Self::models(axes), start_s, first.names)).collect()
    }

    /// The value of the model at a point, if a model exists and describes this statistic.
    pub fn expected(&self, point: &Point) -> Option<Prediction> {
        self.model()?.expected(&self.analysis, point)
    }

    /// The band in which another record of this sensor lies at a point, of the same length; none beyond what the model
    /// predicts.
    pub fn predicted(&self, point: &Point) -> Option<Prediction> {
        let model = self.model().filter(|_| self.analysis.stat == Stat::Oadev)?;
        model.predicted(point.m, self.analysis.samples)
    }

    /// Averaging time and deviation of the minimum: from the fit, or from the points where the fit describes another
    /// statistic.
    pub fn minimum(&self) -> Option<(f64, f64)> {
        if let (true, Ok(fit)) = (self.analysis.stat.is_allan(), self.valid_model()) {
            return match allan::advice(fit)?.averaging {
                Averaging::Minimum { tau_s, dev } => Some((tau_s, dev)),
                _ => None,
            };
        }
        if self.follows_temperature() {
            return None;
        }
        let points = &self.analysis.points;
        let least = points.iter().min_by(|a, b| a.dev.total_cmp(&b.dev))?;
        let inside = least.m > points.first()?.m && least.m < points.last()?.m;
        inside.then_some((least.tau_s, least.dev))
    }

    /// Whether it is of a part whose rate follows its temperature.
    fn follows_temperature(&self) -> bool {
        self.of_noise().any(|warning| matches!(warning, AllanWarning::FollowsTemperature { .. }))
    }
}

/// Closes the gaps if asked to, and gives the warning about them.
fn gaps(options: &AnalysisOptions, file: &Path, column: &mut Column) -> Option<LogWarning> {
    let missing = column.missing();
    if missing == 0 {
        return None;
    }
    let (path, among, are_closed) = (file.display().to_string(), column.series.len(), options.closes_gaps);
    if are_closed {
        column.close_gaps();
    }
    Some(LogWarning::Gaps { path, missing, among, are_closed })
}

/// Whether so many samples stand out of the noise that they are no glitches: the sensor may move.
fn stands_out(fit: &Fit) -> bool {
    fit.warnings.iter().any(|warning| matches!(warning, AllanWarning::ManyGlitches { .. }))
}

/// The label that tells a column from the columns of other logs.
fn label(file: &Path, column: &str) -> String {
    format!("{}, column {column}", file.display())
}
