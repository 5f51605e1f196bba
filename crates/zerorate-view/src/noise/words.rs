//! Words and table rows for noise models.

use crate::Interval;
use crate::plot::number;
use zerorate_allan::{Corner, Estimate, Line, Term, hertz, span};
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
    let detrended = report.detrend.as_ref().map(|detrend| {
        let unit = detrend.unit.unwrap_or("");
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

/// The deviation of the spectrum from a model that is not rejected, as a phrase.
#[must_use]
pub fn misfit(fit: &FitReport) -> String {
    match is_without_misfit(fit) {
        true => "no misfit found".to_owned(),
        false => format!("may be off by {:.1} % of the spectrum", fit.model_error.unwrap_or_default() * 100.0),
    }
}

/// The highest frequency at which the model is valid, Hz; `None` without a valid model, or if it is half the sample
/// rate.
#[must_use]
pub fn holds_below(report: &AllanReport) -> Option<f64> {
    report.valid_model()?.f_max_hz.filter(|hz| *hz < 0.499 * report.rate_hz)
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
         The record shows nothing of longer ones.",
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

/// All terms of the model, the coefficients first. Of a rejected model these are only the lines, which are not a
/// result of the model, but may explain why no model fits.
#[must_use]
pub fn term_rows(report: &AllanReport) -> Vec<TermRow> {
    let Some(fit) = report.model() else { return Vec::new() };
    let lines = lines(&fit.terms).into_iter().map(|line| of_line(fit, line));
    if fit.rejected {
        return lines.collect();
    }
    let values = |of: &CoefficientReport| {
        let units = of.units.iter().enumerate();
        units.filter_map(|(index, in_unit)| Some((interval_of(of.in_unit(index)?), in_unit.unit.clone()))).collect()
    };
    let coefficient = |(letter, of): (char, &CoefficientReport)| TermRow {
        name: format!("{letter}  {}", of.name),
        values: values(of),
        is_identified: of.identified,
        remark: of.remark.clone(),
    };
    let terms = fit.terms.iter().filter_map(|term| of_term(fit, term));
    fit.coefficients().map(coefficient).chain(terms).chain(lines).collect()
}

/// The lines among the terms. Lines whose frequencies read the same are one, and lines without power are left out.
fn lines(terms: &[Term]) -> Vec<Line> {
    let mut all: Vec<Line> = Vec::new();
    for term in terms {
        let Term::Line(line) = term else { continue };
        match all.last_mut() {
            _ if line.rms <= 0.0 => {}
            Some(last) if hertz(last.frequency_hz) == hertz(line.frequency_hz) => {
                last.rms = last.rms.hypot(line.rms);
                last.width_hz += line.width_hz;
            }
            _ => all.push(*line),
        }
    }
    all
}

fn of_line(fit: &FitReport, Line { frequency_hz, width_hz, rms }: Line) -> TermRow {
    let unit = fit.rate_units.last().map_or("rms", |unit| &*unit.unit);
    TermRow {
        name: "line, left out".to_owned(),
        values: vec![(interval_of(Estimate { value: rms, lo: rms, hi: rms }), format!("{unit} rms"))],
        is_identified: true,
        remark: format!("at {}, {} Hz wide", hertz(frequency_hz), number(width_hz)),
    }
}

/// The row of a term; `None` for a line, whose row [`of_line`] makes.
fn of_term(fit: &FitReport, term: &Term) -> Option<TermRow> {
    let in_rate = |estimate: &Estimate| {
        let (estimate, unit) = in_rate(fit, *estimate);
        (interval_of(estimate), unit)
    };
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
        Term::Line(_) => return None,
        Term::WarmUp { size, tau_s } => {
            let unit = fit.rate_units.last().map_or("", |unit| &*unit.unit).to_owned();
            let change = Interval { value: -size.value, lo: -size.hi, hi: -size.lo };
            (
                "warm-up",
                vec![(change, unit)],
                format!("the change of the level, with a time constant of {}", span(*tau_s)),
            )
        }
    };
    Some(TermRow { name: name.to_owned(), values, is_identified: true, remark })
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A log of one sample in ten minutes has all of its lines below 0.001 Hz.
    #[test]
    fn lines_have_digits_and_are_named_once() {
        let line = |frequency_hz, rms| Term::Line(Line { frequency_hz, width_hz: 2e-6, rms });
        let terms = [line(4.123_451e-4, 3e-7), line(4.123_453e-4, 4e-7), line(5e-4, 0.0), line(150.0, 0.1)];
        let found = lines(&terms);
        assert_eq!(
            found.iter().map(|line| hertz(line.frequency_hz)).collect::<Vec<_>>(),
            ["0.000412345 Hz", "150.000 Hz"]
        );
        assert!((found[0].rms - 5e-7).abs() < 1e-12 && (found[0].width_hz - 4e-6).abs() < 1e-12, "{found:?}");
    }
}
