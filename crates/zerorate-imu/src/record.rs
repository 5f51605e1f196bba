//! A column of a log with its results: deviations, noise model and warnings.
//!
//! The command line and the page analyse columns in this way. Python analyses arrays, by the same functions.

use crate::jumps;
use crate::moving::{moving, shared};
use crate::{Axis, Detrending, DetrendingError, ImuWarning, Kind, Rejection, Rejections, Rest, coded};
use std::path::{Path, PathBuf};
use zerorate_allan::{
    self as allan, AllanWarning, Analysis, AnalysisError, Averaging, Density, DetrendedRate, Envelope, Fit, FitError,
    FitOptions, FittedRecord, Input, Line, Options, Point, Prediction, Preparation, Stat, Taus, interval,
};
use zerorate_logs::{Column, LogError, LogWarning, Names, Quantity};

/// A column of a log with its results.
pub struct Record {
    /// The path of the log, or `pool` for the common model of several records.
    pub file: PathBuf,
    /// The name of the column.
    pub column: String,
    /// The quantity of the column; the deviations are in its unit of results. `None` if the unit is unknown.
    pub quantity: Option<Quantity>,
    /// The probability that an interval contains the true deviation.
    pub confidence: f64,
    /// The deviations at the requested averaging times.
    pub analysis: Analysis,
    /// The deviations at the averaging times of plots, if plots have more of them.
    finer: Option<Analysis>,
    /// The noise model, or the reason why there is none. `None` if no model was requested.
    pub fit: Option<Result<Fit, FitError>>,
    /// The rate in the unit of the results. `None` unless it was requested and the fit removed nothing from it.
    pub rate: Option<Vec<f64>>,
    /// The warnings about the log.
    pub notes: Vec<LogWarning>,
    /// The warning that the rate follows the temperature, if no model carries it.
    pub follows: Option<AllanWarning>,
    /// The data for plots of the samples and of their spectrum. `None` unless requested, and for a phase.
    pub plot_data: Option<PlotData>,
    /// The polynomial over temperature that was removed.
    pub detrended: Option<DetrendedRate>,
    /// The time left out at the beginning of the log, s.
    pub skipped_s: f64,
    /// The times in which the sensor moves, s from the first analysed sample. `None` if no model was requested, or if
    /// the model is valid and does not warn of many glitches.
    moving_s: Option<Vec<(f64, f64)>>,
    names: Names,
}

/// The data for plots of a record over time and of its spectrum.
pub struct PlotData {
    /// The analysed samples, with their glitches and steps.
    pub envelope: Envelope,
    /// The spectrum without the glitches and steps that the fit removed.
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

/// The form of the column, and the results that are requested.
#[derive(Clone, Debug, Default)]
pub struct AnalysisOptions {
    /// True if the column holds a phase, the integral of a rate.
    pub is_phase: bool,
    /// True if gaps are closed, as if no time had passed in them.
    pub closes_gaps: bool,
    /// The options of the deviations. Their `scale` is not used.
    pub deviations: Options,
    /// True if plots have more averaging times than `deviations` requests.
    pub draws_finely: bool,
    /// The options of the fit; `None` for no fit.
    pub fit: Option<FitOptions>,
    /// True if the record over time and its spectrum are plotted.
    pub draws: bool,
    /// True if the rate is kept for a model of several records.
    pub keeps_rate: bool,
    /// The removal of the dependence on temperature; without an order, only its detection.
    pub detrending: Detrending,
}

/// The reason why a column cannot be analysed.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// The preparation failed.
    #[error(transparent)]
    Detrending(#[from] DetrendingError),
    /// The numbers of the column must not become a result, or too many samples are lost to space the column evenly.
    #[error(transparent)]
    Log(#[from] LogError),
    /// Too few samples for a deviation.
    #[error("{0}: {1} samples are too few, at least 2 are needed")]
    TooFew(String, usize),
    /// The options are invalid.
    #[error("cannot analyse {0}: {1}")]
    Analysis(String, AnalysisError),
    /// The spectrum cannot be computed.
    #[error("{0}: {1}")]
    Spectrum(String, String),
}

impl Record {
    /// Analyses a column of the log `file`. `temperature` is the column with the temperature of the sensor.
    ///
    /// # Errors
    /// Returns the reason why the column cannot be analysed.
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
        // a lost point of a phase becomes NaN
        let phase = options.is_phase.then(|| jumps::angle(&column, file, &mut notes)).transpose()?;
        let input = phase.as_deref().map_or_else(|| column.input(), Input::Phase);
        notes.extend(column.stopped(file)?);
        if options.fit.is_none() {
            notes.extend(jumps::said(&input, &column, file));
        }
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
        let moving_s = if is_sound(fit.as_ref()) { None } else { Some(moving(&column.points(file)?, column.rate_hz)) };
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

    /// Joins records of one type of sensor to one record with the common model. The deviations are root mean squares
    /// over the records, weighted by the number of terms in each deviation.
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

    /// The warnings about the model; empty without a model.
    pub fn of_model(&self) -> &[AllanWarning] {
        self.model().map_or(&[], |fit| &fit.warnings)
    }

    /// The warnings about the noise: that the rate follows the temperature, and those about the model.
    pub fn of_noise(&self) -> impl Iterator<Item = &AllanWarning> {
        self.follows.iter().chain(self.of_model())
    }

    /// All warnings as scripts read them, `code: text`, those about the log first.
    pub fn warnings(&self) -> Vec<String> {
        self.notes.iter().map(LogWarning::coded).chain(self.noise_warnings()).collect()
    }

    /// The warnings about the noise as scripts read them.
    pub fn noise_warnings(&self) -> impl Iterator<Item = String> {
        let unit = self.quantity.map(Quantity::unit);
        self.of_noise().map(move |warning| coded(warning, unit, self.names))
    }

    /// The label that tells this record from others: the file and the column.
    pub fn label(&self) -> String {
        label(&self.file, &self.column)
    }

    /// True if the column is of the ADIS16130, the sensor of AN-1042, by the column names of its captures.
    pub fn is_of_adis16130(&self) -> bool {
        matches!(self.column.as_str(), "rate_code" | "rate_corrected_dps")
    }

    /// The name of the deviation, as in `overlapping Allan deviation`.
    pub fn title(&self) -> &'static str {
        self.analysis.stat.title()
    }

    /// The analysis that plots show, with more averaging times if those were requested.
    pub fn drawn(&self) -> &Analysis {
        self.finer.as_ref().unwrap_or(&self.analysis)
    }

    /// The fitted noise model, even if it is rejected; `None` if there is none.
    pub fn model(&self) -> Option<&Fit> {
        self.fit.as_ref()?.as_ref().ok()
    }

    /// The frequency up to which the model holds, Hz, if the sensor's filter shapes the noise above. `None` if the
    /// model holds up to half the sample rate.
    pub fn max_freq_hz(&self) -> Option<f64> {
        let max_freq_hz = self.model()?.max_freq_hz;
        (max_freq_hz < 0.499 * self.analysis.rate_hz).then_some(max_freq_hz)
    }

    /// The spectral lines of the model; none without a model.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.model().into_iter().flat_map(Fit::lines)
    }

    /// The model, if it is not rejected. Only such a model counts as a result and goes into files.
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

    /// The kind of axis, if the record is of an axis of an IMU.
    pub fn kind(&self) -> Option<Kind> {
        Kind::of(self.quantity?)
    }

    /// The record as an axis with its model, if it is of an axis of an IMU and has a model.
    pub fn axis(&self) -> Option<Axis<'_>> {
        let (kind, fit, rate_hz) = (self.kind()?, self.model()?, self.analysis.rate_hz);
        Some(Axis { name: &self.column, kind, rate_hz, fit, scale: 1.0 })
    }

    /// The axes of an IMU among these records. Records without a noise model are left out.
    pub fn axes(records: &[Self]) -> Vec<Axis<'_>> {
        records.iter().filter_map(Self::axis).collect()
    }

    /// The reasons why axes of an IMU among several records have no result.
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
        let moving = shared(&spans).into_iter().map(|(from_s, to_s)| (start_s + from_s, start_s + to_s));
        let moving: Vec<(f64, f64)> = moving.collect();
        let jumps = ImuWarning::of_motion(&Self::models(axes), &moving, start_s, first.names);
        let rest = Rest::between(&moving, (start_s, end_s), first.names);
        let moves = (!moving.is_empty()).then_some(ImuWarning::Moves(moving, rest));
        moves.into_iter().chain(jumps).collect()
    }

    /// The prediction of the model at a point, if a model exists and describes this statistic.
    pub fn expected(&self, point: &Point) -> Option<Prediction> {
        self.model()?.expected(&self.analysis, point)
    }

    /// The band in which another record of this sensor, of the same length, lies at a point. `None` without a model,
    /// for averages longer than the model predicts, and for other statistics than the overlapping Allan deviation.
    pub fn predicted(&self, point: &Point) -> Option<Prediction> {
        let model = self.model().filter(|_| self.analysis.stat == Stat::Oadev)?;
        model.predicted(point.m, self.analysis.samples)
    }

    /// Averaging time, s, and deviation of the minimum: from the fit or, if the fit describes another statistic or is
    /// not valid, from the points. `None` if there is no minimum, or the rate follows the temperature.
    pub fn minimum(&self) -> Option<(f64, f64)> {
        if let (true, Ok(fit)) = (self.analysis.stat.is_allan(), self.valid_model()) {
            return match allan::advice(fit)?.averaging {
                Averaging::Minimum { tau_s, dev } => Some((tau_s, dev)),
                _ => None,
            };
        }
        if self.of_noise().any(|warning| matches!(warning, AllanWarning::FollowsTemperature { .. })) {
            return None;
        }
        let points = &self.analysis.points;
        let least = points.iter().min_by(|a, b| a.dev.total_cmp(&b.dev))?;
        let inside = least.m > points.first()?.m && least.m < points.last()?.m;
        inside.then_some((least.tau_s, least.dev))
    }
}

/// Closes the gaps if requested, and returns the warning about them.
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

/// True if the model is valid and does not warn of many glitches, or if no model was requested.
fn is_sound(fit: Option<&Result<Fit, FitError>>) -> bool {
    // so many samples stand out of the noise that they are not glitches: the sensor may move
    let stand_out = |warning: &AllanWarning| matches!(warning, AllanWarning::ManyGlitches { .. });
    match fit {
        Some(Ok(fit)) => !fit.is_rejected && !fit.warnings.iter().any(stand_out),
        Some(Err(_)) => false,
        None => true,
    }
}

fn label(file: &Path, column: &str) -> String {
    format!("{}, column {column}", file.display())
}
