//! One log on its way from file to result.

use super::{Data, temperature, units};
use crate::exit::Usage;
use anyhow::{Context, Result, ensure};
use std::path::{Path, PathBuf};
use zerorate_allan::{
    self as allan, AllanWarning, Analysed, Analysis, Averaging, Density, Detrended, Expected, Fit, FitError,
    FitOptions, Input, Line, Options, Point, Settled, Taus,
};
use zerorate_logs::imu::{self, Axis, Kind};
use zerorate_logs::{Column, Quantity, STANDARD_GRAVITY, Series, Settling, SettlingError};
use zerorate_view::plot::Envelope;

/// A log and what was found in it.
pub struct Record {
    pub file: PathBuf,
    pub column: String,
    /// Of what the deviations are, in the unit of its results; none: in a unit that nobody stated.
    pub quantity: Option<Quantity>,
    pub confidence: f64,
    pub analysis: Analysis,
    /// The same at the averaging times of pictures, where those are others.
    pub(super) finer: Option<Analysis>,
    /// None where nobody asked for it.
    pub fit: Option<Result<Fit, FitError>>,
    /// The rate in the unit of the results; only where it is fitted once more, and nothing was taken out before.
    pub(super) rate: Option<Vec<f64>>,
    pub warnings: Vec<String>,
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
    /// What it holds.
    pub data: Data,
    /// Its gaps are closed up.
    pub closes_gaps: bool,
    /// In the unit of the column.
    pub options: Options,
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
    pub fn of(mut column: Column, file: &Path, way: &AnalysisOptions, temperature: Option<&Column>) -> Result<Self> {
        let mut warnings: Vec<String> = column.warnings.iter().map(ToString::to_string).collect();
        let settled = way.settling.apply(&mut column, file, temperature).map_err(|error| match error {
            SettlingError::NothingLeft(why) => Usage(why).into(),
            error => anyhow::Error::from(error),
        })?;
        warnings.extend(gaps(way, file, &mut column));
        let samples = column.series.len();
        ensure!(
            samples >= 2,
            "{}, column {}: {samples} samples are too few, at least 2 are needed",
            file.display(),
            column.name
        );
        warnings.extend(column.stopped(file)?.map(|note| note.to_string()));
        let phase = phase(way, file, &column)?;
        let input = match (&phase, &column.series) {
            (Some(phase), _) => Input::Phase(phase),
            (None, Series::Codes(codes)) => Input::Codes { codes, gaps: &column.gaps },
            (None, Series::Numbers(numbers)) => Input::Rate(numbers),
        };
        let analysed = Analysed::new(input, column.rate_hz, column.scale, way.fit, &settled);
        let analyse = |taus: &Taus| {
            let options = Options { taus: taus.clone(), ..way.options };
            analysed.deviations(&options).with_context(|| format!("cannot analyse {}", file.display()))
        };
        let analysis = analyse(&way.options.taus)?;
        let finer = way.draws_finely.then(|| analyse(&Taus::Fine)).transpose()?;
        let rate = (way.keeps_rate && analysed.cleaned().is_none()).then(|| analysed.rates());
        let draws = way.draws && way.data == Data::Rate;
        let look = draws.then(|| Look::of(&column, file, analysed.cleaned())).transpose()?;
        let fit = analysed.into_fit();
        let Settled { detrended, follows, skipped_s } = settled;
        let said = follows.filter(|_| !matches!(fit, Some(Ok(_))));
        let seen = fit.iter().flatten().flat_map(|fit| &fit.warnings);
        warnings.extend(said.iter().chain(seen).map(temperature::text));
        Ok(Self {
            file: file.to_owned(),
            column: column.name,
            quantity: column.quantity,
            confidence: way.options.confidence,
            analysis,
            finer,
            fit,
            rate,
            warnings,
            look,
            detrended,
            skipped_s,
        })
    }

    /// What there is to know: of the log, in words, and of the model.
    pub fn findings(&self) -> (&[String], &[AllanWarning]) {
        let of_model = self.model().map_or(&[][..], |fit| &fit.warnings);
        (&self.warnings[..self.warnings.len() - of_model.len()], of_model)
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
        self.warnings.iter().any(|warning| warning.starts_with("follows-temperature"))
    }

    /// What the fit advises, a sentence each; nothing where it is rejected.
    pub fn advice(&self) -> Vec<String> {
        let Some(advice) = self.model().and_then(allan::advice) else { return Vec::new() };
        let at_rest = |dev: f64| self.in_words(dev);
        let averaging = match advice.averaging {
            Averaging::Minimum { tau_s, dev } => format!(
                "To find the bias, average for about {}: the curve has its minimum there, {}; longer averages get \
                 worse.",
                units::span(tau_s),
                at_rest(dev)
            ),
            Averaging::Flat { tau_s, dev } => format!(
                "To find the bias, average for about {}: {}; averaging longer gains less than 5 %.",
                units::span(tau_s),
                at_rest(dev)
            ),
            Averaging::Falling { tau_s, dev } => format!(
                "To find the bias, average as long as you can: the curve still falls at {}, {}.",
                units::span(tau_s),
                at_rest(dev)
            ),
        };
        let times = allan::AN1042_TAUS_S.into_iter().zip(advice.an1042).filter(|_| self.is_of_adis16130());
        let times = times.filter_map(|(tau_s, dev)| Some(format!("{tau_s} s give {}", at_rest(dev?))));
        let times = times.collect::<Vec<_>>().join(", ");
        let note = (!times.is_empty()).then(|| format!("AN-1042's averaging times: {times}."));
        std::iter::once(averaging).chain(note).collect()
    }

    fn in_words(&self, dev: f64) -> String {
        match self.quantity {
            Some(Quantity::AngularRate) => format!("{dev:.3e} °/s ({:.3} °/h)", dev * 3600.0),
            Some(Quantity::Acceleration) => format!("{dev:.3e} m/s² ({:.3} µg)", dev / STANDARD_GRAVITY * 1e6),
            Some(Quantity::Temperature) => format!("{dev:.3e} °C"),
            None => format!("{dev:.3e}"),
        }
    }
}

/// What is missing, and what is done about it.
fn gaps(way: &AnalysisOptions, file: &Path, column: &mut Column) -> Option<String> {
    let missing = column.missing();
    let seen = format!("gaps: {}: {missing} samples are missing among {}", file.display(), column.series.len());
    match missing {
        0 => None,
        _ if way.closes_gaps => {
            column.close_gaps();
            Some(format!("{seen}; the gaps are closed up, which changes the result"))
        }
        _ => {
            Some(format!("{seen}; they are gaps, and what averages lack more than half of their samples is left out"))
        }
    }
}

/// The numbers as phase, if that is what they are. A lost phase point is a point that is not there.
fn phase(way: &AnalysisOptions, file: &Path, column: &Column) -> Result<Option<Vec<f64>>> {
    match way.data {
        Data::Rate => Ok(None),
        Data::Phase => Ok(Some(column.points(file)?)),
    }
}
