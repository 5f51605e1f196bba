//! Several records of one type as one: `--pool`.

use super::record::Record;
use crate::exit::{Refused, Usage};
use anyhow::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use zerorate_allan::{
    self as allan, self, AllanWarning, Analysis, Apart, Differs, Fit, Point, PoolError, PoolRecord, Stat, interval,
};

/// The common model, as a record of its own, and what is to say of the records.
pub struct Pool {
    pub record: Record,
    spread: Vec<allan::Spread>,
    apart: Vec<(String, Apart)>,
    used: Vec<String>,
}

impl Pool {
    /// Fits all of `records`, whose rates were kept.
    pub fn of(records: &[Record]) -> Result<Self> {
        check(records)?;
        let fitted: Vec<(&Record, &Fit)> =
            records.iter().filter_map(|record| Some((record, record.model()?))).collect();
        if let Some((record, why)) =
            records.iter().find_map(|record| Some((record, record.fit.as_ref()?.as_ref().err()?)))
        {
            return Err(Refused::new("no-model", format!("{}: {why}", record.label())).into());
        }
        let inputs: Vec<PoolRecord<'_>> = fitted
            .iter()
            .map(|&(record, fit)| PoolRecord {
                rate: record.rate.as_deref().unwrap_or_default(),
                rate_hz: record.analysis.rate_hz,
                fit,
            })
            .collect();
        let pool = allan::fit_pool(&inputs).map_err(refused)?;
        let name = |i: usize| records[i].label();
        let apart = pool.apart.iter().map(|apart| (name(apart.record), *apart)).collect();
        let used: Vec<&Record> = pool.used.iter().map(|&i| &records[i]).collect();
        let mut found = Self {
            spread: pool.spread,
            apart,
            used: pool.used.iter().map(|&i| name(i)).collect(),
            record: together(&used, pool.fit),
        };
        let mut warnings = found.misfits();
        let of_model = found.record.model().into_iter().flat_map(|fit| &fit.warnings);
        warnings.extend(of_model.map(|warning: &AllanWarning| format!("{}: {warning}", warning.code())));
        found.record.warnings = warnings;
        Ok(found)
    }

    /// A line for each record that does not fit.
    fn misfits(&self) -> Vec<String> {
        let line = |(name, apart): &(String, Apart)| {
            let rest = match apart.is_left_out {
                true => "left out of the common model",
                false => "the common model is of two that differ; a third would tell which is the exception",
            };
            format!("not-alike: {name} {}: {rest}", differs(&apart.differs))
        };
        self.apart.iter().map(line).collect()
    }

    /// The spread between the records, a line for each coefficient.
    pub fn text(&self) -> Result<String> {
        let mut text = format!("One model of {} records: {}\n", self.used.len(), self.used.join("; "));
        writeln!(text, "Spread between them beyond their own intervals:")?;
        for spread in &self.spread {
            let allan::Spread { noise, records, relative, least, largest } = *spread;
            let part = 100.0 * relative;
            writeln!(text, "  {:22} {part:>5.1} %  ({least:.4e} to {largest:.4e} in {records})", noise.name())?;
        }
        if self.spread.is_empty() {
            writeln!(text, "  no coefficient is identified in two of them")?;
        }
        Ok(text)
    }

    pub fn json(&self) -> Json<'_> {
        let of = |spread: &allan::Spread| {
            let &allan::Spread { records, relative, least, largest, .. } = spread;
            // a name ends with its letter
            let letter = spread.noise.name().chars().last().unwrap_or_default();
            (letter.to_ascii_lowercase(), Spread { records, relative, least, largest })
        };
        let one = |(name, apart): &'_ (String, Apart)| Misfit {
            record: name.clone(),
            why: differs(&apart.differs),
            left_out: apart.is_left_out,
        };
        Json {
            records: &self.used,
            spread: self.spread.iter().map(of).collect(),
            apart: self.apart.iter().map(one).collect(),
        }
    }
}

/// What a pool adds to the report of its model.
#[derive(Serialize)]
pub struct Json<'a> {
    records: &'a [String],
    spread: BTreeMap<char, Spread>,
    apart: Vec<Misfit>,
}

#[derive(Serialize)]
struct Spread {
    records: usize,
    relative: f64,
    least: f64,
    largest: f64,
}

#[derive(Serialize)]
struct Misfit {
    record: String,
    why: String,
    left_out: bool,
}

fn check(records: &[Record]) -> Result<(), Usage> {
    let is_again =
        |(i, record): &(usize, &Record)| records[..*i].iter().any(|before| before.label() == record.label());
    if let Some((_, record)) = records.iter().enumerate().find(is_again) {
        return Err(Usage(format!(
            "--pool: {} is given twice, which would count its noise twice; give each record once",
            record.label()
        )));
    }
    let mixed = records.windows(2).find(|pair| pair[0].quantity != pair[1].quantity);
    mixed.map_or(Ok(()), |pair| {
        Err(Usage(format!(
            "--pool: {} and {} are of different quantities; pool records of one kind",
            pair[0].label(),
            pair[1].label()
        )))
    })
}

fn refused(why: PoolError) -> anyhow::Error {
    match why {
        PoolError::TooFew { .. } | PoolError::Rates { .. } => Usage(format!("--pool: {why}")).into(),
        why => Refused::new("no-common-model", format!("no common model: {why}")).into(),
    }
}

fn differs(differs: &Differs) -> String {
    match differs {
        Differs::Rejected { error } => format!("has no model of its own (off by {:.0} %)", error * 100.0),
        Differs::White { ratio } => format!("has {ratio:.2} times the N of the others"),
        Differs::Slow { gain } => {
            format!("has other slow noise (flicker, random walk or memory; −2 ln L differs by {gain:.0})")
        }
        _ => "differs".to_owned(),
    }
}

/// The mean of the curves, each weighed by its terms, with the common model.
fn together(used: &[&Record], fit: Fit) -> Record {
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
    Record {
        file: PathBuf::from("pool"),
        column: first.column.clone(),
        quantity: first.quantity,
        confidence: first.confidence,
        analysis,
        finer: None,
        fit: Some(Ok(fit)),
        rate: None,
        warnings: Vec::new(),
        look: None,
        detrended: None,
        skipped_s: 0.0,
    }
}

/// Only where the model speaks of the curve there is something to pool.
pub fn check_statistic(stat: Stat) -> Result<(), Usage> {
    match stat.is_allan() {
        true => Ok(()),
        false => Err(Usage(format!(
            "--pool: the model is of the Allan deviation, not of {}; leave --stat out",
            stat.name()
        ))),
    }
}
