//! The result as one JSON object.

use super::record::Record;
use super::units::{Named, coefficients, deviation_unit};
use serde::Serialize;
use std::collections::BTreeMap;
use zerorate::allan::{self, Point, Unavailable};

/// Several logs.
#[derive(Serialize)]
pub struct Reports<'a> {
    files: Vec<Report<'a>>,
}

impl<'a> Reports<'a> {
    pub fn new(records: &'a [Record]) -> Self {
        Self { files: records.iter().map(Report::new).collect() }
    }
}

/// One log. `fit` is in the unit of the deviations: N in unit·√s, B in unit, K in unit/√s.
#[derive(Serialize)]
pub struct Report<'a> {
    file: String,
    column: &'a str,
    rate_hz: f64,
    samples: u64,
    missing: u64,
    stat: &'static str,
    unit: Option<&'static str>,
    confidence: f64,
    points: Vec<Row>,
    unavailable: Vec<Missing>,
    fit: BTreeMap<char, Coefficient>,
    fit_error: Option<String>,
    advice: Vec<String>,
    warnings: &'a [String],
}

#[derive(Serialize)]
struct Row {
    tau_s: f64,
    m: u64,
    dev: f64,
    lo: f64,
    hi: f64,
    edf: f64,
    alpha: i32,
    n: u64,
}

#[derive(Serialize)]
struct Missing {
    tau_s: f64,
    reason: String,
}

#[derive(Serialize)]
struct Coefficient {
    value: f64,
    lo: f64,
    /// None where nothing bounds it.
    hi: Option<f64>,
    unit: String,
    identified: bool,
    needed_s: Option<f64>,
}

impl<'a> Report<'a> {
    pub fn new(record: &'a Record) -> Self {
        let analysis = &record.analysis;
        let row = |point: &Point| {
            let &Point { tau_s, m, dev, lo, hi, edf, alpha, n } = point;
            Row { tau_s, m, dev, lo, hi, edf, alpha, n }
        };
        let missing =
            |Unavailable { tau_s, reason }: &Unavailable| Missing { tau_s: *tau_s, reason: reason.to_string() };
        Self {
            file: record.file.display().to_string(),
            column: &record.column,
            rate_hz: analysis.rate_hz,
            samples: analysis.samples,
            missing: analysis.missing,
            stat: analysis.stat.name(),
            unit: deviation_unit(record),
            confidence: record.confidence,
            points: analysis.points.iter().map(row).collect(),
            unavailable: analysis.unavailable.iter().map(missing).collect(),
            fit: fit(record),
            fit_error: record.fit.as_ref().err().map(ToString::to_string),
            advice: record.advice(),
            warnings: &record.warnings,
        }
    }
}

/// In the base unit of each coefficient, which is the one without a factor. Where there is no fit, zeros that nothing
/// is known about.
fn fit(record: &Record) -> BTreeMap<char, Coefficient> {
    let base = |named: Named<'_>| {
        let unit = named.units.iter().find(|(_, factor)| *factor == 1.0).map(|(unit, _)| unit.clone());
        let &allan::Coefficient { value, lo, hi, identified, needed_s, .. } = named.coefficient;
        let unit = unit.unwrap_or_default();
        (named.letter.to_ascii_lowercase(), Coefficient { value, lo, hi: Some(hi), unit, identified, needed_s })
    };
    if record.fit.is_ok() {
        return coefficients(record).into_iter().map(base).collect();
    }
    let unknown =
        || Coefficient { value: 0.0, lo: 0.0, hi: None, unit: String::new(), identified: false, needed_s: None };
    ['n', 'b', 'k'].map(|letter| (letter, unknown())).into()
}
