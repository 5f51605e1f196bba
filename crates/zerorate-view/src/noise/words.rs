//! Words and table rows for noise models.

use crate::Interval;
use crate::plot::number;
use zerorate_allan::{Corner, Estimate, Line, Term, span};
use zerorate_imu::{AllanReport, CoefficientReport, DetrendReport, FitReport};

/// True if the model's error, beyond what chance explains, rounds to 0.0 %.
#[must_use]
pub fn is_without_misfit(fit: &FitReport) -> bool {
    fit.model_error.is_some_and(|error| error < 0.0005)
}

/// Describes what was removed from the record before the analysis: skipped time and detrending, one text each.
#[must_use]
pub fn removed(report: &AllanReport) -> Vec<String> {
    let skipped = (report.skipped_s > 0.0).then(|| format!("without the first {}", span(report.skipped_s)));
    let unit = report.unit.unwrap_or("");
    let detrended = report.detrend.as_ref().map(|detrend| {
        let terms = detrend.coefficients.iter().zip(["/°C", "/°C²", "/°C³"]);
        let terms = terms.map(|(value, per)| format!("{value:.4e} {unit}{per}")).collect::<Vec<_>>().join(", ");
        format!(
            "less a polynomial of order {} over temperature ({}): {terms}; it explains {:.1} % of the \
             slow variance and took {} of the degrees of freedom. Of a random walk {:.0} % are left, so K is stated \
             with what was lost, and long averages with fewer degrees of freedom",
            detrend.order,
            DetrendReport::METHOD,
            detrend.explained * 100.0,
            detrend.lost_dof,
            detrend.walk_kept * 100.0
        )
    });
    skipped.into_iter().chain(detrended).collect()
}

/// The deviation of the spectrum from the model, as a phrase.
#[must_use]
pub fn misfit(fit: &FitReport) -> String {
    let percent = fit.model_error.unwrap_or_default() * 100.0;
    match fit.rejected {
        true if fit.motion_ratio.is_some() => {
            "rejected, since the sensor moves: no coefficient is a result".to_owned()
        }
        true => format!("off by {percent:.1} % of the spectrum, rejected: no coefficient is a result"),
        false if is_without_misfit(fit) => "no misfit found".to_owned(),
        false => format!("may be off by {percent:.1} % of the spectrum"),
    }
}

/// The highest frequency at which the model is valid, Hz; `None` without a model, or if it is half the sample rate.
#[must_use]
pub fn holds_below(report: &AllanReport) -> Option<f64> {
    report.fit.as_ref()?.f_max_hz.filter(|hz| *hz < 0.499 * report.rate_hz)
}

/// Describes the predicted range of deviations of another record of this sensor. `None` without a valid model or
/// prediction.
#[must_use]
pub fn predicts(report: &AllanReport) -> Option<String> {
    report.valid_model()?;
    let points = report.points.iter();
    let bands: Vec<_> =
        points.filter_map(|at| Some((at.tau_s, at.predicted?, at.predicted_lo?, at.predicted_hi?))).collect();
    let (longest_s, ..) = bands.last()?;
    let widest = bands.iter().map(|(_, dev, lo, hi)| (hi / dev).max(dev / lo)).fold(1.0, f64::max);
    Some(format!(
        "The model expects 95 % of other records of this sensor within {:.0} % of its curve, for averages up to {}. \
         It predicts no longer ones.",
        (widest - 1.0) * 100.0,
        span(*longest_s)
    ))
}

/// A table row: a coefficient or another term with its limits, in one or more units.
pub struct TermRow {
    /// The name of the coefficient or other term.
    pub name: String,
    /// The same value in each unit, or different values of one term, such as σ and correlation time.
    pub values: Vec<(Interval, String)>,
    /// True if the value is identified; if not, only its upper limit is meaningful.
    pub is_identified: bool,
    /// A remark beside the values; may be empty.
    pub remark: String,
}

/// All terms of the model, the coefficients first.
#[must_use]
pub fn term_rows(report: &AllanReport) -> Vec<TermRow> {
    let Some(fit) = report.model() else { return Vec::new() };
    let values = |of: &CoefficientReport| {
        let units = of.units.iter().enumerate();
        units.filter_map(|(index, in_unit)| Some((interval_of(of.in_unit(index)?), in_unit.unit.clone()))).collect()
    };
    let coefficient = |(letter, of): (char, &CoefficientReport)| TermRow {
        name: format!("{letter}  {}", of.name),
        values: values(of),
        is_identified: of.identified,
        remark: if fit.rejected { "model rejected".to_owned() } else { of.remark.clone() },
    };
    fit.coefficients().map(coefficient).chain(fit.terms.iter().map(|term| of_term(fit, term))).collect()
}

fn of_term(fit: &FitReport, term: &Term) -> TermRow {
    let in_rate = |estimate: &Estimate| {
        let (estimate, unit) = in_rate(fit, *estimate);
        (interval_of(estimate), unit)
    };
    let exact = |value: f64| Estimate { value, lo: value, hi: value };
    let (name, values, remark) = match term {
        Term::GaussMarkov { sigma, tau_s } => {
            ("Gauss–Markov σ, T", vec![in_rate(sigma), (interval_of(*tau_s), "s".to_owned())], String::new())
        }
        Term::BandShape { cosines, pole, corner, of_white } => {
            let noise = if *of_white { "white noise" } else { "noise" };
            let order = cosines.len() + usize::from(pole.is_some());
            let remark = match corner {
                Some(Corner { frequency_hz, .. }) => {
                    format!("a low-pass of the second order at {frequency_hz:.3} Hz shapes the {noise}")
                }
                None => format!("of order {order}: a filter shapes the {noise}"),
            };
            ("band shape", Vec::new(), remark)
        }
        Term::Line(Line { frequency_hz, width_hz, rms }) => {
            let unit = fit.rate_units.last().map_or("rms", |unit| &*unit.unit);
            let strength = vec![(interval_of(exact(*rms)), format!("{unit} rms"))];
            ("line, left out", strength, format!("at {frequency_hz:.4} Hz, {width_hz:.4} Hz wide"))
        }
        Term::WarmUp { size, tau_s } => {
            ("warm-up", vec![in_rate(size)], format!("with a time constant of {}", span(*tau_s)))
        }
    };
    TermRow { name: name.to_owned(), values, is_identified: true, remark }
}

fn interval_of(Estimate { value, lo, hi }: Estimate) -> Interval {
    Interval { value, lo, hi }
}

/// Formats an estimate with its interval, or only its upper limit if it is not identified.
#[must_use]
pub fn stated(estimate: Estimate, is_identified: bool) -> String {
    match is_identified {
        true => interval_of(estimate).to_string(),
        false => format!("< {}", number(estimate.hi)),
    }
}

/// A Gauss–Markov term. Its σ is in the first unit of the bias instability.
pub struct GaussMarkov {
    /// Standard deviation.
    pub sigma: Estimate,
    /// The unit of σ.
    pub unit: String,
    /// Correlation time, s.
    pub tau_s: Estimate,
}

/// The Gauss–Markov terms of a model.
pub fn gauss_markov(fit: &FitReport) -> impl Iterator<Item = GaussMarkov> {
    fit.terms.iter().filter_map(|term| match term {
        Term::GaussMarkov { sigma, tau_s } => {
            let (sigma, unit) = in_rate(fit, *sigma);
            Some(GaussMarkov { sigma, unit, tau_s: *tau_s })
        }
        _ => None,
    })
}

/// Converts a rate to the first unit of the bias instability, and returns that unit.
fn in_rate(fit: &FitReport, Estimate { value, lo, hi }: Estimate) -> (Estimate, String) {
    let (unit, factor) = fit.rate_units.first().map_or(("", 1.0), |unit| (&*unit.unit, unit.factor));
    (Estimate { value: value * factor, lo: lo * factor, hi: hi * factor }, unit.to_owned())
}

/// Describes the intervals of a deviation: `68.3 % intervals`.
#[must_use]
pub fn interval(confidence: f64) -> String {
    format!("{} % intervals", (confidence * 1e6).round() / 1e4)
}
