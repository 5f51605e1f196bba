//! `--pool`: one noise model for several records of one type of sensor.

use crate::exit::{CodedRefusal, Usage};
use anyhow::Result;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt::Write;
use zerorate_allan::{self as allan, Stat};
use zerorate_imu::AllanReport;
use zerorate_jobs::pool::{NoPool, Outlier, Pool};

/// Formats the spread between the records, one line per coefficient.
pub fn text(pool: &Pool) -> Result<String> {
    let mut text = format!("One model of {} records: {}\n", pool.used.len(), pool.used.join("; "));
    writeln!(text, "Spread between them beyond their own intervals:")?;
    for spread in &pool.spread {
        let allan::Spread { noise, records, relative, least, largest } = *spread;
        let part = 100.0 * relative;
        writeln!(text, "  {:22} {part:>5.1} %  ({least:.4e} to {largest:.4e} in {records})", noise.name())?;
    }
    if pool.spread.is_empty() {
        writeln!(text, "  no coefficient is identified in two of them")?;
    }
    Ok(text)
}

/// The JSON report of the common model, with the spread of the records.
#[derive(Serialize)]
pub struct PoolReport {
    #[serde(flatten)]
    report: AllanReport,
    records: Vec<String>,
    spread: BTreeMap<char, Spread>,
    apart: Vec<Outlier>,
}

#[derive(Serialize)]
struct Spread {
    records: usize,
    relative: f64,
    least: f64,
    largest: f64,
}

impl PoolReport {
    pub fn new(report: AllanReport, pool: &Pool) -> Self {
        let of = |spread: &allan::Spread| {
            let &allan::Spread { records, relative, least, largest, .. } = spread;
            // the name ends with the letter of the coefficient, as in `angle random walk N`
            let letter = spread.noise.name().chars().last().unwrap_or_default();
            (letter.to_ascii_lowercase(), Spread { records, relative, least, largest })
        };
        let spread = pool.spread.iter().map(of).collect();
        Self { report, records: pool.used.clone(), spread, apart: pool.outliers.clone() }
    }
}

pub fn failed(why: NoPool) -> anyhow::Error {
    match why.code() {
        Some(code) => CodedRefusal::new(code, why.to_string()).into(),
        None => Usage(format!("--pool: {why}")).into(),
    }
}

pub fn check_statistic(stat: Stat) -> Result<(), Usage> {
    match stat.is_allan() {
        true => Ok(()),
        false => Err(Usage(format!("--pool models the Allan deviation, not {}; leave --stat out", stat.name()))),
    }
}
