//! A column of a log on its way from file to result: its deviations, its noise model, and what is to be said of it.

use crate::error::InvalidOptions;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use zerorate_allan::{
    self as allan, AllanWarning, Analysed, Analysis, Averaging, Density, Detrended, Envelope, Expected, Fit, FitError,
    FitOptions, Input, Line, Options, Point, Settled, Taus, interval,
};
use zerorate_logs::imu::{self, Axis, Kind};
use zerorate_logs::{Column, LogWarning, Quantity, Series, Settling, SettlingError};

/// A column of a log and what was found in it.
pub struct Record {
    /// The log.
    pub file: PathBuf,
    /// The name of the column.
    pub column: String,
    /// Of what the deviations are, in the unit of its results; none: in a unit that nobody stated.
    pub quantity: Option<Quantity>,
    /// Of the intervals.
    pub confidence: f64,
    /// Its deviations.
    pub analysis: Analysis,
    /// The same at the averaging times of pictures, where those are others.
    finer: Option<Analysis>,
    /// None where nobody asked for it.
    pub fit: Option<Result<Fit, FitError>>,
    /// The rate in the unit of the results; only where it is fitted once more, and nothing was taken out before.
    pub rate: Option<Vec<f64>>,
    /// What there is to know of the log.
    pub notes: Vec<LogWarning>,
    /// Its rate follows its temperature, and there is no model to say so.
    pub follows: Option<AllanWarning>,
    /// What is drawn of it beside its curve; none unless that was asked for, and of a rate.
    pub look: Option<Look>,
    /// The polynomial over temperature that was taken out.
    pub detrended: Option<Detrended>,
    /// What was left out at its beginning, s.
    pub skipped_s: f64,
}

/// A record as one looks at it.
pub struct Look {
    /// As it was read.
    pub envelope: Envelope,
    /// Without what was taken out before the fit.
    pub spectrum: Vec<Density>,
}

impl Look {
    fn of(column: &Column, file: &Path, cleaned: Option<&[f64]>) -> Result<Self> {
        let mut samples = column.points(file)?;
        samples.iter_mut().for_each(|sample| *sample *= column.scale);
        let spectrum = allan::welch(cleaned.unwrap_or(&samples), column.rate_hz)?;
        Ok(Self { envelope: Envelope::new(&samples, column.rate_hz), spectrum })
    }
}

/// How a column is analysed.
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
    /// What is left out, and taken out, before.
    pub settling: Settling,
}

impl Record {
    /// Analyses a column of the log `file`.
    pub fn of(
        mut column: Column,
        file: &Path,
        options: &AnalysisOptions,
        temperature: Option<&Column>,
    ) -> Result<Self> {
        let mut notes = column.warnings.clone();
        let settled = options.settling.apply(&mut column, file, temperature).map_err(|error| match error {
            SettlingError::NothingLeft(why) => InvalidOptions(why).into(),
            error => anyhow::Error::from(error),
        })?;
        notes.extend(gaps(options, file, &mut column));
        let samples = column.series.len();
        ensure!(
            samples >= 2,
            "{}, column {}: {samples} samples are too few, at least 2 are needed",
            file.display(),
            column.name
        );
        notes.extend(column.stopped(file)?);
        let phase = phase(options, file, &column)?;
        let input = match (&phase, &column.series) {
            (Some(phase), _) => Input::Phase(phase),
            (None, Series::Codes(codes)) => Input::Codes { codes, gaps: &column.gaps },
            (None, Series::Numbers(numbers)) => Input::Rate(numbers),
        };
        let analysed = Analysed::new(input, column.rate_hz, column.scale, options.fit, &settled);
        let analyse = |taus: &Taus| {
            let deviations = Options { taus: taus.clone(), ..options.deviations };
            analysed.deviations(&deviations).with_context(|| format!("cannot analyse {}", file.display()))
        };
        let analysis = analyse(&options.deviations.taus)?;
        let finer = options.draws_finely.then(|| analyse(&Taus::Fine)).transpose()?;
        let rate = (options.keeps_rate && analysed.cleaned().is_none()).then(|| analysed.rates());
        let draws = options.draws && !options.is_phase;
        let look = draws.then(|| Look::of(&column, file, analysed.cleaned())).transpose()?;
        let fit = analysed.into_fit();
        let Settled { detrended, follows, skipped_s } = settled;
        let follows = follows.filter(|_| !matches!(fit, Some(Ok(_))));
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
            look,
            detrended,
            skipped_s,
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
            look: None,
            detrended: None,
            skipped_s: 0.0,
        }
    }

    /// What there is to know of the model.
    pub fn of_model(&self) -> &[AllanWarning] {
        self.model().map_or(&[], |fit| &fit.warnings)
    }

    /// What tells this log from others: the file, and the column.
    pub fn label(&self) -> String {
        format!("{}, column {}", self.file.display(), self.column)
    }

    /// Whether it is of the part that AN-1042 is about, as the columns of captures and corrections of it are called.
    pub fn is_of_adis16130(&self) -> bool {
        matches!(self.column.as_str(), "rate_code" | "rate_corrected_dps")
    }

    /// What the deviation is called.
    pub fn title(&self) -> &'static str {
        self.analysis.stat.title()
    }

    /// What pictures show.
    pub fn drawn(&self) -> &Analysis {
        self.finer.as_ref().unwrap_or(&self.analysis)
    }

    /// The model, if there is one.
    pub fn model(&self) -> Option<&Fit> {
        self.fit.as_ref()?.as_ref().ok()
    }

    /// What stands out of its spectrum.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.model().into_iter().flat_map(Fit::lines)
    }

    /// The model, if it is not rejected: what may be called a result and go into files.
    pub fn believed(&self) -> Result<&Fit, String> {
        match &self.fit {
            Some(Ok(fit)) => imu::doubt(fit).map_or(Ok(fit), Err),
            Some(Err(why)) => Err(why.to_string()),
            None => Err("no noise model was asked for".to_owned()),
        }
    }

    /// Of a record whose model is not believed: why, for scripts.
    pub fn doubt_code(&self) -> &'static str {
        match self.model() {
            Some(_) => "model-rejected",
            None => "no-model",
        }
    }

    /// Itself with its model, where it has one and is an axis of an IMU.
    pub fn axis(&self) -> Option<Axis<'_>> {
        let kind = Kind::of(self.quantity?)?;
        let si = match kind {
            Kind::Gyroscope => 1f64.to_radians(),
            Kind::Accelerometer => 1.0,
        };
        Some(Axis { name: &self.column, kind, rate_hz: self.analysis.rate_hz, fit: self.model()?, si })
    }

    /// What the model says of a point, if there is a model and it speaks of this statistic.
    pub fn expected(&self, point: &Point) -> Option<Expected> {
        self.model()?.expected(&self.analysis, point)
    }

    /// Averaging time and deviation of the minimum: that of the fit, or of the points where the fit is of another
    /// statistic.
    pub fn minimum(&self) -> Option<(f64, f64)> {
        if let (true, Ok(fit)) = (self.analysis.stat.is_allan(), self.believed()) {
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
        let is_such = |warning: &AllanWarning| matches!(warning, AllanWarning::FollowsTemperature { .. });
        self.follows.is_some() || self.of_model().iter().any(is_such)
    }
}

/// What is missing, and what is done about it.
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

/// The numbers as phase, if that is what they are. A lost phase point is a point that is not there.
fn phase(options: &AnalysisOptions, file: &Path, column: &Column) -> Result<Option<Vec<f64>>> {
    options.is_phase.then(|| Ok(column.points(file)?)).transpose()
}
