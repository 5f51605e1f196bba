//! Noise coefficients in the units of data sheets, standards and users.

use zerorate_allan::{Corner, Estimate, Fit, Line, Term};
use zerorate_imu as imu;
use zerorate_imu::Record;
pub use zerorate_imu::{B, Named, span};
use zerorate_logs::Quantity;
use zerorate_view::Interval;
use zerorate_view::plot::number;

/// The coefficients of a record. N, B and K, which every fit has, come first.
pub fn coefficients(record: &Record) -> Vec<Named<'_>> {
    record.model().map_or_else(Vec::new, |fit| imu::coefficients(fit, record.quantity))
}

/// Whether chance explains how the spectrum scatters about the model, to the digit that is shown.
pub fn is_without_misfit(fit: &Fit) -> bool {
    fit.model_error < 0.0005
}

/// How far the model is from the spectrum, as a phrase.
pub fn misfit(fit: &Fit) -> String {
    let percent = fit.model_error * 100.0;
    match fit.is_rejected {
        true => format!("off by {percent:.1} % of the spectrum, rejected"),
        false if is_without_misfit(fit) => "no misfit found".to_owned(),
        false => format!("may be off by {percent:.1} % of the spectrum"),
    }
}

/// How far up the model holds, where a filter shapes the noise above.
pub fn holds_below(record: &Record) -> Option<String> {
    let max_freq_hz = record.max_freq_hz()?;
    Some(format!("It holds below {} Hz; above it the sensor's filter shapes the noise.", number(max_freq_hz)))
}

/// How near another record of the sensor is expected, and up to which averages.
pub fn predicts(record: &Record) -> Option<String> {
    record.valid_model().ok()?;
    let points = record.analysis.points.iter();
    let bands: Vec<_> = points.filter_map(|point| Some((point.tau_s, record.predicted(point)?))).collect();
    let (longest_s, _) = bands.last()?;
    let widest = bands.iter().map(|(_, band)| (band.hi / band.dev).max(band.dev / band.lo)).fold(1.0, f64::max);
    Some(format!(
        "95 % of other records of this sensor lie within {:.0} % of the model, for averages up to {}; longer ones are \
         not predicted.",
        (widest - 1.0) * 100.0,
        span(*longest_s)
    ))
}

/// The row of a coefficient or another term in a table: value, limits and unit, in each unit.
pub struct TermRow {
    pub name: String,
    pub values: Vec<(Interval, String)>,
    pub remark: String,
}

/// All terms of the model of a record, the coefficients first.
pub fn term_rows(record: &Record) -> Vec<TermRow> {
    let Some(fit) = record.model() else { return Vec::new() };
    let coefficient = |named: Named<'_>| TermRow {
        name: format!("{}  {}", named.letter, named.name),
        values: (0..named.units.len())
            .map(|index| (interval_of(named.in_unit(index)), named.units[index].0.clone()))
            .collect(),
        remark: if fit.is_rejected { "model rejected".to_owned() } else { named.remark() },
    };
    coefficients(record)
        .into_iter()
        .map(coefficient)
        .chain(fit.terms.iter().map(|term| of_term(record, term)))
        .collect()
}

fn of_term(record: &Record, term: &Term) -> TermRow {
    let in_rate = |estimate: &Estimate| {
        let (estimate, unit) = in_rate(*estimate, record.quantity);
        (interval_of(estimate), unit)
    };
    let exact = |value: f64| Estimate { value, lo: value, hi: value };
    match term {
        Term::GaussMarkov { sigma, tau_s } => TermRow {
            name: "Gauss–Markov σ, T".to_owned(),
            values: vec![in_rate(sigma), (interval_of(*tau_s), "s".to_owned())],
            remark: String::new(),
        },
        Term::BandShape { cosines, pole, corner, of_white } => {
            let noise = if *of_white { "white noise" } else { "noise" };
            let order = cosines.len() + usize::from(pole.is_some());
            let remark = match corner {
                Some(Corner { frequency_hz, .. }) => {
                    format!("a low-pass of the second order at {frequency_hz:.3} Hz shapes the {noise}")
                }
                None => format!("of order {order}: a filter shapes the {noise}"),
            };
            TermRow { name: "band shape".to_owned(), values: Vec::new(), remark }
        }
        Term::Line(Line { frequency_hz, width_hz, rms }) => TermRow {
            name: "line, left out".to_owned(),
            values: vec![in_rate(&exact(*rms))],
            remark: format!("at {frequency_hz:.4} Hz, {width_hz:.4} Hz wide"),
        },
        Term::WarmUp { size, tau_s } => TermRow {
            name: "warm-up".to_owned(),
            values: vec![in_rate(size)],
            remark: format!("with a time constant of {}", span(*tau_s)),
        },
    }
}

/// An estimate, to be shown.
fn interval_of(Estimate { value, lo, hi }: Estimate) -> Interval {
    Interval { value, lo, hi }
}

/// An estimate with its interval, or its upper limit where it is not identified.
pub fn stated(estimate: Estimate, is_identified: bool) -> String {
    match is_identified {
        true => interval_of(estimate).to_string(),
        false => format!("< {}", number(estimate.hi)),
    }
}

/// A Gauss–Markov term, with σ in the first unit of the bias instability.
pub struct GaussMarkov {
    pub sigma: Estimate,
    pub unit: String,
    pub tau_s: Estimate,
}

/// The Gauss–Markov terms of a model.
pub fn gauss_markov(fit: &Fit, quantity: Option<Quantity>) -> impl Iterator<Item = GaussMarkov> {
    fit.terms.iter().filter_map(move |term| match term {
        Term::GaussMarkov { sigma, tau_s } => {
            let (sigma, unit) = in_rate(*sigma, quantity);
            Some(GaussMarkov { sigma, unit, tau_s: *tau_s })
        }
        _ => None,
    })
}

/// An estimate of a rate in the first unit of the bias instability, and that unit.
fn in_rate(Estimate { value, lo, hi }: Estimate, quantity: Option<Quantity>) -> (Estimate, String) {
    let (unit, factor) = B.of(quantity).swap_remove(0);
    (Estimate { value: value * factor, lo: lo * factor, hi: hi * factor }, unit)
}

/// The method that removes the temperature from a record.
pub const DETREND_METHOD: &str = "least squares over means of 128 parts";

/// Names the limits of a deviation: `68.3 % intervals`.
pub fn interval(confidence: f64) -> String {
    format!("{} % intervals", (confidence * 1e6).round() / 1e4)
}

/// The unit of the deviations of a record, for people; none if it is not stated.
pub fn deviation_unit(record: &Record) -> Option<&'static str> {
    let quantity = record.quantity?;
    if !record.analysis.stat.is_times_s() {
        return Some(quantity.unit());
    }
    Some(match quantity {
        Quantity::AngularRate => "°",
        Quantity::Acceleration => "m/s",
        Quantity::Temperature => "°C·s",
    })
}

/// The usual name of the noise whose spectral density has the exponent α.
pub fn noise(alpha: i32, quantity: Option<Quantity>) -> &'static str {
    match alpha {
        2 if quantity == Some(Quantity::Acceleration) => "white velocity",
        1 if quantity == Some(Quantity::Acceleration) => "flicker velocity",
        0 if quantity == Some(Quantity::Acceleration) => "velocity random walk",
        -2 if quantity == Some(Quantity::Acceleration) => "acceleration random walk",
        2 => "white angle",
        1 => "flicker angle",
        0 => "angle random walk",
        -1 => "bias instability",
        -2 => "rate random walk",
        _ => "ramp or drift",
    }
}
