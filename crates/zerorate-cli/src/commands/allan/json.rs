//! The result as one JSON object.

use super::pool;
use super::words::advice::advice;
use super::words::units::{DETREND_METHOD, Named, coefficients, deviation_unit};
use super::words::warnings;
use serde::Serialize;
use std::collections::BTreeMap;
use zerorate_allan::{self as allan, MotionKind, Point, Unavailable};
use zerorate_imu::Moment;
use zerorate_imu::Record;
use zerorate_jobs::pool::Pool;

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

/// Several logs and their common model.
#[derive(Serialize)]
pub struct Pooled<'a> {
    files: Vec<Report<'a>>,
    pool: PoolReport<'a>,
}

#[derive(Serialize)]
struct PoolReport<'a> {
    #[serde(flatten)]
    report: Report<'a>,
    #[serde(flatten)]
    records: pool::Json<'a>,
}

impl<'a> Pooled<'a> {
    pub fn new(records: &'a [Record], pool: &'a Pool) -> Self {
        let report = PoolReport { report: Report::new(&pool.record), records: pool::json(pool) };
        Self { files: records.iter().map(Report::new).collect(), pool: report }
    }
}

/// Several columns.
#[derive(Serialize)]
pub struct Axes<'a> {
    axes: Vec<Axis<'a>>,
    motion: Vec<Motion>,
}

#[derive(Serialize)]
struct Axis<'a> {
    name: &'a str,
    #[serde(flatten)]
    report: Report<'a>,
}

impl<'a> Axes<'a> {
    pub fn new(records: &'a [Record]) -> Self {
        let axis = |record: &'a Record| Axis { name: &record.column, report: Report::new(record) };
        let of_files = records.chunk_by(|a, b| a.file == b.file);
        Self { axes: records.iter().map(axis).collect(), motion: of_files.flat_map(motion).collect() }
    }
}

/// A moment at which several axes jump or have a glitch.
#[derive(Serialize)]
pub struct Motion {
    at_s: f64,
    axes: Vec<String>,
    kind: &'static str,
}

/// Finds the common events of the axes of one log.
pub fn motion(axes: &[Record]) -> Vec<Motion> {
    let found = |Moment { at_s, axes, kind }: Moment| Motion {
        at_s,
        axes,
        kind: match kind {
            MotionKind::Jump => "jump",
            MotionKind::Knock => "knock",
        },
    };
    Moment::all(&Record::models(axes)).into_iter().map(found).collect()
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
    points: Vec<PointRow>,
    unavailable: Vec<Missing>,
    /// None without --fit.
    fit: Option<Fit>,
    fit_error: Option<String>,
    cleaned: Cleaned,
    advice: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    detrend: Option<Detrend>,
    #[serde(skip_serializing_if = "is_nothing")]
    skipped_s: f64,
    warnings: Vec<String>,
}

fn is_nothing(seconds: &f64) -> bool {
    *seconds == 0.0
}

#[derive(Serialize)]
struct PointRow {
    tau_s: f64,
    m: u64,
    dev: f64,
    lo: f64,
    hi: f64,
    edf: f64,
    alpha: i32,
    n: u64,
    /// The fitted deviation, and the band in which the model expects 95 % of the deviations of this record.
    model: Option<f64>,
    model_lo: Option<f64>,
    model_hi: Option<f64>,
    /// The band for another record of this sensor, up to 1/128 of the record.
    predicted_lo: Option<f64>,
    predicted_hi: Option<f64>,
}

#[derive(Serialize)]
struct Fit {
    #[serde(flatten)]
    coefficients: BTreeMap<char, Coefficient>,
    /// ε: the relative error of the model.
    model_error: Option<f64>,
    p_value: Option<f64>,
    /// The frequency up to which the model holds, Hz.
    f_max_hz: Option<f64>,
    /// Whether the error is too large: nothing is identified.
    rejected: bool,
    terms: Vec<Term>,
}

#[derive(Serialize)]
#[serde(tag = "kind", rename_all = "kebab-case")]
enum Term {
    GaussMarkov { sigma: Estimate, tau_s: Estimate },
    BandShape { cosines: Vec<f64>, pole: Option<f64>, corner: Option<Corner>, of_white: bool },
    Line { frequency_hz: f64, width_hz: f64, rms: f64 },
    WarmUp { size: Estimate, tau_s: f64 },
}

/// A low-pass of the second order.
#[derive(Serialize)]
struct Corner {
    frequency_hz: f64,
    damping: f64,
}

#[derive(Serialize)]
struct Estimate {
    value: f64,
    lo: f64,
    hi: f64,
}

#[derive(Default, Serialize)]
struct Cleaned {
    glitches: u64,
    steps: Vec<Step>,
}

#[derive(Serialize)]
struct Step {
    at_s: f64,
    size: f64,
}

#[derive(Serialize)]
struct Missing {
    tau_s: f64,
    reason: String,
}

#[derive(Serialize)]
struct Coefficient {
    /// `value` to `hi` need a model.
    value: Option<f64>,
    lo: Option<f64>,
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
            let model = record.expected(point);
            let [model, model_lo, model_hi] = [model.map(|m| m.dev), model.map(|m| m.lo), model.map(|m| m.hi)];
            let predicted = record.predicted(point);
            let [predicted_lo, predicted_hi] = [predicted.map(|m| m.lo), predicted.map(|m| m.hi)];
            PointRow { tau_s, m, dev, lo, hi, edf, alpha, n, model, model_lo, model_hi, predicted_lo, predicted_hi }
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
            fit: record.fit.is_some().then(|| fit(record)),
            fit_error: record.fit.as_ref().and_then(|fit| fit.as_ref().err()).map(ToString::to_string),
            cleaned: record.model().map(|fit| cleaned(&fit.cleaned)).unwrap_or_default(),
            advice: advice(record),
            detrend: detrend(record),
            skipped_s: record.skipped_s,
            warnings: warnings::of_record(record),
        }
    }
}

fn fit(record: &Record) -> Fit {
    let model = record.model();
    Fit {
        coefficients: letters(record),
        model_error: model.map(|fit| fit.model_error),
        p_value: model.map(|fit| fit.p_value),
        f_max_hz: model.map(|fit| fit.max_freq_hz),
        rejected: model.is_some_and(|fit| fit.is_rejected),
        terms: model.iter().flat_map(|fit| &fit.terms).map(term).collect(),
    }
}

/// The coefficients, each in its base unit, which is the unit without a factor. Without a model they have no numbers.
fn letters(record: &Record) -> BTreeMap<char, Coefficient> {
    let base = |named: Named<'_>| {
        let unit = named.units.iter().find(|(_, factor)| *factor == 1.0).map(|(unit, _)| unit.clone());
        let &allan::Coefficient { value, lo, hi, identified, needed_s, .. } = named.coefficient;
        let [value, lo, hi] = [value, lo, hi].map(Some);
        let unit = unit.unwrap_or_default();
        (named.letter.to_ascii_lowercase(), Coefficient { value, lo, hi, unit, identified, needed_s })
    };
    if record.model().is_some() {
        return coefficients(record).into_iter().map(base).collect();
    }
    let unknown =
        || Coefficient { value: None, lo: None, hi: None, unit: String::new(), identified: false, needed_s: None };
    ['n', 'b', 'k'].map(|letter| (letter, unknown())).into()
}

fn term(term: &allan::Term) -> Term {
    let estimate = |&allan::Estimate { value, lo, hi }: &allan::Estimate| Estimate { value, lo, hi };
    match term {
        allan::Term::GaussMarkov { sigma, tau_s } => {
            Term::GaussMarkov { sigma: estimate(sigma), tau_s: estimate(tau_s) }
        }
        &allan::Term::BandShape { ref cosines, pole, corner, of_white } => {
            let corner = corner.map(|allan::Corner { frequency_hz, damping }| Corner { frequency_hz, damping });
            Term::BandShape { cosines: cosines.clone(), pole, corner, of_white }
        }
        allan::Term::WarmUp { size, tau_s } => Term::WarmUp { size: estimate(size), tau_s: *tau_s },
        &allan::Term::Line(allan::Line { frequency_hz, width_hz, rms }) => Term::Line { frequency_hz, width_hz, rms },
    }
}

fn cleaned(cleaned: &allan::Cleaning) -> Cleaned {
    let steps = cleaned.steps.iter().map(|&allan::Step { at_s, size }| Step { at_s, size }).collect();
    Cleaned { glitches: cleaned.glitches, steps }
}

/// The polynomial, for scripts.
#[derive(Serialize)]
struct Detrend {
    over: &'static str,
    order: usize,
    method: &'static str,
    /// In the unit of the rate per °C, °C², °C³, about `mean_c`.
    coefficients: Vec<f64>,
    mean_c: f64,
    explained: f64,
    lost_dof: usize,
    /// Share of the variance of a random walk that is left.
    walk_kept: f64,
}

fn detrend(record: &Record) -> Option<Detrend> {
    let detrended = record.detrended.as_ref()?;
    Some(Detrend {
        over: "temperature",
        order: detrended.lost_dof,
        method: DETREND_METHOD,
        coefficients: detrended.coefficients.clone(),
        mean_c: detrended.mean_c,
        explained: detrended.explained,
        lost_dof: detrended.lost_dof,
        walk_kept: detrended.walk_kept(),
    })
}
