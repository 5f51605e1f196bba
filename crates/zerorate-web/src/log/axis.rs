//! The results of a column of a log, for the page.

use super::message::{AxisKind, LogAxis, LogCoefficient, LogColumn, LogPoint, LogValue};
use zerorate_allan::{Line, Term};
use zerorate_imu::{B, Kind, Named, Record};
use zerorate_logs::{Column, Quantity};
use zerorate_view::plot::number;

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

/// The results of a column that was analysed, for the page.
pub fn message(record: &Record) -> LogAxis {
    let model = record.model();
    let of_noise = record.of_noise().map(|warning| format!("{}: {warning}", warning.code()));
    LogAxis {
        column: about(&record.column, record.quantity, record.analysis.missing),
        points: points(record),
        coefficients: coefficients(record).iter().map(coefficient).collect(),
        terms: terms(record),
        model_error: model.map(|fit| fit.model_error),
        doubt: record.valid_model().err().map(|doubt| doubt.to_string()),
        warnings: record.notes.iter().map(ToString::to_string).chain(of_noise).collect(),
    }
}

/// Averages of 1, 2, 4 … samples; the pictures have more.
fn points(record: &Record) -> Vec<LogPoint> {
    let octaves = record.analysis.points.iter().filter(|point| point.m.is_power_of_two());
    octaves
        .map(|point| LogPoint {
            tau_s: point.tau_s,
            dev: point.dev,
            lo: point.lo,
            hi: point.hi,
            model: record.expected(point).map(|expected| expected.dev),
        })
        .collect()
}

/// The deviations of a model, if there is one.
pub fn coefficients(record: &Record) -> Vec<Named<'_>> {
    record.model().map_or_else(Vec::new, |fit| zerorate_imu::coefficients(fit, record.quantity))
}

/// The terms of a model beside its coefficients, and how far up it holds, in words.
fn terms(record: &Record) -> Vec<String> {
    let terms = record.model().into_iter().flat_map(|fit| &fit.terms);
    let holds = |hz: f64| {
        format!("The noise model holds below {} Hz; above it the sensor's filter shapes the noise.", number(hz))
    };
    terms.filter_map(|one| term(record.quantity, one)).chain(record.max_freq_hz().map(holds)).collect()
}

/// A term in words.
fn term(quantity: Option<Quantity>, term: &Term) -> Option<String> {
    let (unit, factor) = B.of(quantity).swap_remove(0);
    let size = |value: f64| format!("{} {unit}", number(value * factor));
    match term {
        Term::GaussMarkov { sigma, tau_s } => {
            Some(format!("Gauss–Markov: σ {}, correlation time {} s", size(sigma.value), number(tau_s.value)))
        }
        Term::Line(Line { frequency_hz, rms, .. }) => {
            Some(format!("line at {} Hz, {} rms, left out", number(*frequency_hz), size(*rms)))
        }
        Term::WarmUp { size: step, tau_s } => {
            Some(format!("warm-up: {}, time constant {}", size(step.value), zerorate_imu::span(*tau_s)))
        }
        Term::BandShape { .. } => None,
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
