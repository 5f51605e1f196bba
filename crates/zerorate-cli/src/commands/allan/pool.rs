//! Several records of one type as one: `--pool`.

use crate::exit::{Refused, Usage};
use anyhow::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use zerorate_allan::{self as allan, Apart, Differs, Fit, PoolError, PoolRecord, Stat};
use zerorate_jobs::analysis::Record;
use zerorate_logs::LogWarning;

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
        let apart: Vec<_> = pool.apart.iter().map(|apart| (name(apart.record), *apart)).collect();
        let used: Vec<&Record> = pool.used.iter().map(|&i| &records[i]).collect();
        let notes = apart.iter().map(misfit).collect();
        Ok(Self {
            spread: pool.spread,
            apart,
            used: pool.used.iter().map(|&i| name(i)).collect(),
            record: Record::together(&used, pool.fit, notes),
        })
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

/// A record that does not fit.
fn misfit((name, apart): &(String, Apart)) -> LogWarning {
    let rest = match apart.is_left_out {
        true => "left out of the common model",
        false => "the common model is of two that differ; a third would tell which is the exception",
    };
    LogWarning::NotAlike(format!("{name} {}: {rest}", differs(&apart.differs)))
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
