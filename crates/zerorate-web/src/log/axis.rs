//! A column of a log on its way to its noise.

use super::message::{AxisKind, LogAxis, LogCoefficient, LogColumn, LogPoint, LogValue};
use std::path::Path;
use zerorate_allan::{
    self as allan, Analysis, Density, Envelope, Fit, FitError, FitOptions, Input, Line, Options, Settled, Taus, Term,
};
use zerorate_logs::imu::{self, Axis, B, Kind, Named};
use zerorate_logs::{Column, LogWarning, Quantity, Series};
use zerorate_view::plot::number;

/// A column that was analysed.
pub struct Analysed {
    pub name: String,
    pub quantity: Option<Quantity>,
    missing: u64,
    /// At the averaging times of pictures.
    pub analysis: Analysis,
    pub fit: Result<Fit, FitError>,
    pub envelope: Envelope,
    pub spectrum: Vec<Density>,
    warnings: Vec<String>,
}

/// Analyses a column of the log `path`.
pub fn analyse(path: &Path, column: Column) -> Result<Analysed, String> {
    let words = |error: &dyn std::fmt::Display| format!("{}, column {}: {error}", path.display(), column.name);
    let missing = column.missing();
    let stopped = column.stopped(path).map_err(|error| error.to_string())?;
    let input = match &column.series {
        Series::Codes(codes) => Input::Codes { codes, gaps: &column.gaps },
        Series::Numbers(numbers) => Input::Rate(numbers),
    };
    let options = FitOptions::default();
    let analysed = allan::Analysed::new(input, column.rate_hz, column.scale, Some(options), &Settled::default());
    let fine = Options { taus: Taus::Fine, ..Options::default() };
    let analysis = analysed.deviations(&fine).map_err(|error| words(&error))?;
    let samples = analysed.rates();
    let mut fit = analysed.into_fit().ok_or("no noise model was asked for")?;
    // the page keeps the samples as a picture alone
    fit.iter_mut().for_each(|fit| fit.cleaned.rate = None);
    let spectrum = allan::welch(&samples, column.rate_hz).map_err(|error| words(&error))?;
    let envelope = Envelope::new(&samples, column.rate_hz);
    let lacking =
        (missing > 0).then(|| format!("gaps: {missing} samples are missing; what averages lack is left out"));
    let of_log = column.warnings.iter().chain(&stopped).map(LogWarning::coded);
    let warnings = of_log.chain(lacking).collect();
    Ok(Analysed { name: column.name, quantity: column.quantity, missing, analysis, fit, envelope, spectrum, warnings })
}

/// A column, for the page.
pub fn column(column: &Column) -> LogColumn {
    about(&column.name, column.quantity, column.missing())
}

fn about(name: &str, quantity: Option<Quantity>, missing: u64) -> LogColumn {
    let kind = quantity.and_then(Kind::of).map(|kind| match kind {
        Kind::Gyroscope => AxisKind::Gyroscope,
        Kind::Accelerometer => AxisKind::Accelerometer,
    });
    LogColumn { name: name.to_owned(), kind, unit: quantity.map(|of| of.unit().to_owned()), missing }
}

impl Analysed {
    /// For the page.
    pub fn message(&self) -> LogAxis {
        LogAxis {
            column: about(&self.name, self.quantity, self.missing),
            points: self.points(),
            coefficients: self.coefficients().iter().map(coefficient).collect(),
            terms: self.fit.iter().flat_map(|fit| &fit.terms).filter_map(|term| self.term(term)).collect(),
            model_error: self.fit.as_ref().ok().map(|fit| fit.model_error),
            doubt: self.doubt(),
            warnings: self.warnings(),
        }
    }

    /// Averages of 1, 2, 4 … samples; pictures have more.
    fn points(&self) -> Vec<LogPoint> {
        let octaves = self.analysis.points.iter().filter(|point| point.m.is_power_of_two());
        let expected = |point| Some(self.fit.as_ref().ok()?.expected(&self.analysis, point)?.dev);
        octaves
            .map(|point| LogPoint {
                tau_s: point.tau_s,
                dev: point.dev,
                lo: point.lo,
                hi: point.hi,
                model: expected(point),
            })
            .collect()
    }

    /// Those of a model, if there is one.
    pub fn coefficients(&self) -> Vec<Named<'_>> {
        self.fit.as_ref().map_or_else(|_| Vec::new(), |fit| imu::coefficients(fit, self.quantity))
    }

    /// What stands out of its spectrum.
    pub fn lines(&self) -> impl Iterator<Item = &Line> {
        self.fit.iter().flat_map(Fit::lines)
    }

    /// Why the coefficients are no result, if they are none.
    pub fn doubt(&self) -> Option<String> {
        match &self.fit {
            Ok(fit) => imu::doubt(fit),
            Err(why) => Some(why.to_string()),
        }
    }

    /// Itself with its model, where it has one and is an axis of an IMU.
    pub fn axis(&self) -> Option<Axis<'_>> {
        let kind = Kind::of(self.quantity?)?;
        let si = match kind {
            Kind::Gyroscope => 1f64.to_radians(),
            Kind::Accelerometer => 1.0,
        };
        Some(Axis { name: &self.name, kind, rate_hz: self.analysis.rate_hz, fit: self.fit.as_ref().ok()?, si })
    }

    fn warnings(&self) -> Vec<String> {
        let of_model = self.fit.iter().flat_map(|fit| &fit.warnings);
        let of_model = of_model.map(|warning| format!("{}: {warning}", warning.code()));
        self.warnings.iter().cloned().chain(of_model).collect()
    }

    /// What a model has beside its coefficients, in words.
    fn term(&self, term: &Term) -> Option<String> {
        let (unit, factor) = B.of(self.quantity).swap_remove(0);
        let size = |value: f64| format!("{} {unit}", number(value * factor));
        match term {
            Term::GaussMarkov { sigma, tau_s } => {
                Some(format!("Gauss–Markov: σ {}, correlation time {} s", size(sigma.value), number(tau_s.value)))
            }
            Term::Line(Line { frequency_hz, rms, .. }) => {
                Some(format!("line at {} Hz, {} rms, left out", number(*frequency_hz), size(*rms)))
            }
            Term::WarmUp { size: step, tau_s } => {
                Some(format!("warm-up: {}, time constant {}", size(step.value), imu::span(*tau_s)))
            }
            Term::BandShape { .. } => None,
        }
    }
}

fn coefficient(named: &Named<'_>) -> LogCoefficient {
    let value = |index: usize| {
        let found = named.in_unit(index);
        LogValue { value: found.value, lo: found.lo, hi: found.hi, unit: named.units[index].0.clone() }
    };
    LogCoefficient {
        symbol: named.letter.to_string(),
        name: named.name.to_owned(),
        values: (0..named.units.len()).map(value).collect(),
        identified: named.coefficient.identified,
        remark: named.remark(),
    }
}
