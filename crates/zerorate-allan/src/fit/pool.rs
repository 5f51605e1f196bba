//! Fits one model to several records of one type. The terms are common, and the likelihoods are added.
//!
//! Units of one type differ, and a sum of likelihoods that ignores this gives intervals that are too narrow. So the
//! spread between the records is reported, and the intervals include it. The R package mgmwm (Guerrier, Skaloud et
//! al.) treats several calibrations of one sensor in this way.

use super::coefficients::Coefficients;
use super::curve::Curves;
use super::density::Table;
use super::drift::Template;
use super::model::{MeasuredSpectrum, Model};
use super::prediction::PredictionError;
use super::remarks::{Raw, remarks};
use super::scoring::{B2, N2, Optimum, Problem, SHAPE_PRICE};
use super::select::{DESCENT, Selection, chi2, is_upper, select};
use super::{Cleaning, Fit, FitError, MOST_ERROR, TWO_SIDED_95, fitted, lines::median};
use crate::chi2::chi2_above;
use crate::{Coefficient, Misfit, Noise};
use alloc::vec::Vec;
use core::fmt;

/// A record with its own model.
#[derive(Clone, Copy, Debug)]
pub struct PoolRecord<'a> {
    /// The rate, in the unit of the model; NaN is a missing sample. Not used if `fit` contains a cleaned rate.
    pub rate: &'a [f64],
    /// Samples per second.
    pub rate_hz: f64,
    /// The model of this record alone.
    pub fit: &'a Fit,
}

/// A common model of several records.
#[derive(Clone, Debug, PartialEq)]
pub struct Pool {
    /// The common model. Its intervals hold for the mean of units of this type, and include the spread between units.
    pub fit: Fit,
    /// Indices of the records in the common model.
    pub used: Vec<usize>,
    /// The spread between records of each coefficient that at least two records identify.
    pub spread: Vec<Spread>,
    /// The records that do not fit the others.
    pub outliers: Vec<Outlier>,
}

/// The spread of a coefficient between records.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// The coefficient whose values are compared.
    pub noise: Noise,
    /// Number of records that identify the coefficient.
    pub records: usize,
    /// Standard deviation of the coefficient's logarithm beyond the records' intervals; 0 if these explain all of it.
    pub relative: f64,
    /// Smallest value among the records that identify the coefficient.
    pub least: f64,
    /// Largest value among the records that identify the coefficient.
    pub largest: f64,
}

/// A record that does not fit the others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outlier {
    /// The index of the record.
    pub record: usize,
    /// The kind of difference.
    pub differs: Differs,
    /// Whether the record is not in the common model. If only two are left and their slow noise differs, both stay.
    pub is_left_out: bool,
}

/// The way in which a record differs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Differs {
    /// The record's own model is rejected.
    Rejected {
        /// Model error ε of the record's own model.
        error: f64,
    },
    /// The sensor moved during the record.
    Moves,
    /// The white noise of the record differs.
    White {
        /// N of the record divided by the median N of the records with accepted models.
        ratio: f64,
    },
    /// The slower noise of the record differs: flicker, random walk, Gauss–Markov terms.
    Slow {
        /// The gain in −2 ln L from the record's own slow terms over the median of all records that were still in the
        /// pool.
        gain: f64,
    },
}

/// The reasons why several records have no common model.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PoolError {
    /// A pool needs at least two records.
    TooFew {
        /// The number of records given.
        records: usize,
    },
    /// The sample rates differ, and so may the filters of the sensors.
    Rates {
        /// Rate of the first record.
        first_hz: f64,
        /// Rate of a record that differs from it.
        other_hz: f64,
    },
    /// Fewer than two records have an accepted model and similar white noise.
    NothingInCommon,
    /// A record cannot be fitted, or no common model has a finite likelihood.
    Fit(FitError),
}

impl fmt::Display for PoolError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooFew { records } => {
                write!(f, "a common model needs at least two records, not {records}: give more")
            }
            Self::Rates { first_hz, other_hz } => write!(
                f,
                "the records were sampled at {first_hz:.3} and {other_hz:.3} Hz; the band of a sensor goes with its \
                 rate: pool records of one setting"
            ),
            Self::NothingInCommon => write!(
                f,
                "no two of the records have white noise within {:.0} %: these are not units of one type at rest, \
                 or not in one unit; look at each alone",
                MOST_ERROR * 100.0
            ),
            Self::Fit(why) => why.fmt(f),
        }
    }
}

impl core::error::Error for PoolError {}

impl From<FitError> for PoolError {
    fn from(why: FitError) -> Self {
        Self::Fit(why)
    }
}

/// Largest relative difference between two sample rates of one setting.
const SAME_RATE: f64 = 0.01;
/// The 0.1 % point of χ² with four degrees of freedom: B, K, and σ and T of a Gauss–Markov term.
const SLOW_LIMIT: f64 = 18.5;

/// Fits one model to several records. The same records in the same order always give the same bits.
///
/// The fit leaves out records whose own model is rejected, and records whose N is off the median by more than
/// [`MOST_ERROR`]. While three or more are left and the common model does not explain the slow noise of each, the fit
/// also leaves out the record that is farthest from the median. The drift in a record's own model is removed from the
/// record, and so are its lines, glitches and steps.
///
/// # Errors
/// Returns [`PoolError`] if fewer than two records are alike, if their rates differ, or if a fit fails.
pub fn fit_pool(records: &[PoolRecord<'_>]) -> Result<Pool, PoolError> {
    same_rates(records)?;
    let top_hz = records.iter().map(|record| record.fit.max_freq_hz).fold(f64::INFINITY, f64::min);
    let parts = records.iter().map(|record| parts(record, top_hz)).collect::<Result<Vec<Parts>, FitError>>()?;
    let mut outliers = outliers_by_own_model(records);
    let mut used: Vec<usize> =
        (0..records.len()).filter(|i| outliers.iter().all(|outlier| outlier.record != *i)).collect();
    let chosen = loop {
        if used.len() < 2 {
            return Err(PoolError::NothingInCommon);
        }
        let of_these: Vec<&Table> = used.iter().map(|&i| &parts[i].table).collect();
        let chosen = select(Table::pooled(&of_these), SHAPE_PRICE).ok_or(FitError::NotFinite)?;
        let own: Vec<RecordFit> =
            used.iter().map(|&i| RecordFit::of(i, &parts[i].table, &chosen, records[i].fit)).collect();
        let Some((record, gain)) = farthest_from_median(&own) else { break chosen };
        let is_left_out = used.len() > 2;
        outliers.push(Outlier { record, differs: Differs::Slow { gain }, is_left_out });
        if !is_left_out {
            break chosen;
        }
        used.retain(|i| *i != record);
    };
    outliers.sort_by_key(|outlier| outlier.record);
    let alike: Vec<&PoolRecord<'_>> = used.iter().map(|&i| &records[i]).collect();
    let spread: Vec<Spread> = spreads(&alike);
    let mut above: Vec<(f64, f64)> = used.iter().flat_map(|&i| parts[i].above.iter().copied()).collect();
    above.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(Pool { fit: common(&alike, &chosen, &spread, above)?, used, spread, outliers })
}

fn same_rates(records: &[PoolRecord<'_>]) -> Result<(), PoolError> {
    let first_hz = match records {
        [first, _, ..] => first.rate_hz,
        _ => return Err(PoolError::TooFew { records: records.len() }),
    };
    let other = records.iter().find(|record| libm::fabs(record.rate_hz / first_hz - 1.0) > SAME_RATE);
    other.map_or(Ok(()), |other| Err(PoolError::Rates { first_hz, other_hz: other.rate_hz }))
}

impl PoolRecord<'_> {
    fn cleaned(&self) -> &[f64] {
        self.fit.cleaned.rate.as_deref().unwrap_or(self.rate)
    }
}

/// The spectrum of a record: the fitted part, and frequency and density of the bins above it.
struct Parts {
    table: Table,
    above: Vec<(f64, f64)>,
}

fn parts(record: &PoolRecord<'_>, top_hz: f64) -> Result<Parts, FitError> {
    let (spectrum, mut table) = fitted(record.cleaned(), record.rate_hz)?;
    if let Some((drift, size)) = record.fit.model.drift {
        let template = Template::new(drift, &table);
        let (powers, nu) = (template.powers(&table, size), table.rows.iter().map(|row| row.bin.freedom));
        let density: Vec<f64> = table.rows.iter().map(|row| record.fit.density(row.f_hz, record.rate_hz)).collect();
        // the fit of the drift took a part of the noise with it
        let taken = template.restriction(&nu.collect::<Vec<_>>(), &density).taken;
        for (((row, power), taken), density) in table.rows.iter_mut().zip(powers).zip(taken).zip(density) {
            row.bin.power = power + taken * density / row.bin.freedom;
        }
    }
    Ok(Parts { table: table.below(top_hz), above: spectrum.above(top_hz, record.rate_hz) })
}

fn outliers_by_own_model(records: &[PoolRecord<'_>]) -> Vec<Outlier> {
    let valid = records.iter().filter(|record| !record.fit.is_rejected);
    let middle = median(valid.map(|record| record.fit.n.value).collect());
    let of = |(record, PoolRecord { fit, .. }): (usize, &PoolRecord<'_>)| {
        let ratio = fit.n.value / middle;
        let differs = match fit.is_rejected {
            true if fit.motion_ratio.is_some() => Differs::Moves,
            true => Differs::Rejected { error: fit.model_error },
            false if libm::fabs(libm::log(ratio)) > libm::log1p(MOST_ERROR) => Differs::White { ratio },
            false => return None,
        };
        Some(Outlier { record, differs, is_left_out: true })
    };
    records.iter().enumerate().filter_map(of).collect()
}

/// A record to which the terms of the common model were fitted again.
struct RecordFit {
    record: usize,
    problem: Problem,
    own: Optimum,
    /// Expected power with the common values of the slow terms.
    common: Vec<f64>,
}

impl RecordFit {
    fn of(record: usize, table: &Table, chosen: &Selection, fit: &Fit) -> Self {
        let problem = Problem::new(table.clone(), chosen.problem.error);
        let (form, mut at) = (chosen.found.form, chosen.found.at.clone());
        at[N2] = fit.n.value * fit.n.value;
        let common = problem.density(&form, &at);
        Self { record, own: problem.descend(form, &at, None, DESCENT), problem, common }
    }

    /// The gain in −2 ln L of the slow noise from the record's own values, compared with the expected power `density`.
    fn gain(&self, density: &[f64]) -> f64 {
        let deviance = |density: &[f64]| {
            let rows = self.problem.table.rows.iter().zip(density).zip(&self.problem.nu);
            let slow = rows.filter(|((row, _), _)| !is_upper(&self.problem, row.f_hz));
            slow.map(|((row, s), nu)| nu * (libm::log(s / row.bin.power) + row.bin.power / s - 1.0)).sum::<f64>()
        };
        deviance(density) - deviance(&self.own.density)
    }

    /// Expected power with the slow terms of another record and the N of this record.
    fn by(&self, other: &Self) -> Vec<f64> {
        let mut at = other.own.at.clone();
        at[N2] = self.own.at[N2];
        self.problem.density(&self.own.form, &at)
    }
}

/// The record whose slow noise is farthest from the median of all, and its gain from values of its own. `None` if the
/// common values explain every record. The common values follow the loudest record; the median does not.
fn farthest_from_median(all: &[RecordFit]) -> Option<(usize, f64)> {
    if all.iter().all(|one| one.gain(&one.common) <= SLOW_LIMIT) {
        return None;
    }
    let from_middle = |one: &RecordFit| {
        let by_each: Vec<Vec<f64>> = all.iter().map(|other| one.by(other)).collect();
        let middle = |row| libm::exp(median(by_each.iter().map(|density| libm::log(density[row])).collect()));
        let middle: Vec<f64> = (0..one.common.len()).map(middle).collect();
        (one.record, one.gain(&middle))
    };
    all.iter().map(from_middle).max_by(|a, b| a.1.total_cmp(&b.1))
}

fn spreads(records: &[&PoolRecord<'_>]) -> Vec<Spread> {
    let of = |noise, coefficient: fn(&Fit) -> Coefficient| {
        let all: Vec<Coefficient> =
            records.iter().map(|record| coefficient(record.fit)).filter(|found| found.identified).collect();
        let count = all.len() as f64;
        let mean = all.iter().map(|found| libm::log(found.value)).sum::<f64>() / count;
        let square = |found: &Coefficient| libm::pow(libm::log(found.value) - mean, 2.0);
        let own = |found: &Coefficient| libm::pow(libm::log(found.hi / found.lo) / (2.0 * TWO_SIDED_95), 2.0);
        let variance = all.iter().map(square).sum::<f64>() / (count - 1.0) - all.iter().map(own).sum::<f64>() / count;
        let values = || all.iter().map(|found| found.value);
        let (least, largest) = (values().fold(f64::INFINITY, f64::min), values().fold(0.0, f64::max));
        let relative = libm::sqrt(variance.max(0.0));
        (all.len() > 1).then_some(Spread { noise, records: all.len(), relative, least, largest })
    };
    let n = of(Noise::AngleRandomWalk, |fit| fit.n);
    n.into_iter()
        .chain(of(Noise::BiasInstability, |fit| fit.b))
        .chain(of(Noise::RateRandomWalk, |fit| fit.k))
        .collect()
}

/// The common model, with intervals that hold for the mean of units that differ.
fn common(
    records: &[&PoolRecord<'_>],
    chosen: &Selection,
    spread: &[Spread],
    above: Vec<(f64, f64)>,
) -> Result<Fit, FitError> {
    let found = &chosen.found;
    let Table { rate_hz, top_hz, .. } = chosen.problem.table;
    let samples = records.iter().map(|record| record.cleaned().len()).max().unwrap_or(0);
    let record_s = samples as f64 / rate_hz;
    let is_rejected = chosen.problem.error > MOST_ERROR;
    let coefficients = Coefficients { samples, chosen, rate_hz, is_rejected };
    let of_mean = |noise| {
        let own = spread.iter().find(|spread| spread.noise == noise);
        own.map_or(0.0, |spread| spread.relative / libm::sqrt(spread.records as f64))
    };
    let (chi2, freedom) = chi2(&chosen.problem, found);
    let measured = MeasuredSpectrum { rate_hz, record_s, top_hz, above, sines: Vec::new() };
    let model = Model::new(found, &measured)?;
    let doubt = PredictionError::of((&chosen.problem, found), &model, &measured, None)?;
    let of_no_record = Curves::of(&[], rate_hz);
    let misfit = is_rejected.then(|| Misfit::of((&chosen.problem, found), None, (&of_no_record, &model)));
    let (n, other) = coefficients.n(0.0, 0.0);
    let fit = Fit {
        n: wider(n, of_mean(Noise::AngleRandomWalk)),
        b: wider(coefficients.of(B2), of_mean(Noise::BiasInstability)),
        k: wider(coefficients.k(), of_mean(Noise::RateRandomWalk)),
        q: found.form.quantised.then(|| coefficients.of(super::Q2)),
        r: None,
        terms: coefficients.terms(&[]),
        model: model.with(doubt),
        model_error: chosen.problem.error,
        motion_ratio: None,
        p_value: chi2_above(chi2, freedom),
        is_rejected,
        misfit,
        curve: Vec::new(),
        max_freq_hz: top_hz,
        span_s: (1.0 / rate_hz, record_s / 2.0),
        cleaned: Cleaning::default(),
        warnings: Vec::new(),
    };
    let warnings = remarks(&fit, (chosen, other), &of_no_record, None, Raw { record_s, missing: 0 });
    Ok(Fit { warnings, ..fit })
}

/// The coefficient with its interval widened by this relative standard deviation.
fn wider(found: Coefficient, deviation: f64) -> Coefficient {
    let Coefficient { value, lo, hi, .. } = found;
    let ratio = |ratio: f64| {
        let log = libm::log(ratio);
        libm::exp(libm::sqrt(log * log + libm::pow(TWO_SIDED_95 * deviation, 2.0)))
    };
    let lower = if lo > 0.0 { value / ratio(value / lo) } else { lo };
    let upper = if value > 0.0 { value * ratio(hi / value) } else { hi };
    Coefficient { lo: lower, hi: upper, ..found }
}
