//! The result as one HTML page.

use super::picture;
use super::record::Record;
use super::units::{self, deviation_unit, noise};
use crate::output::Staged;
use anyhow::Result;
use zerorate::allan::Estimate;
use zerorate_view::plot::number;
use zerorate_view::report::{self, AllanPage, AllanRow, Coefficient, CoefficientValue, Fact, allan_page};

/// Writes the page of all records, with a picture for each group of them.
pub fn write(file: Staged, groups: &[&[Record]]) -> Result<()> {
    let records = || groups.iter().flat_map(|group| *group);
    let first = records().next();
    let page = AllanPage {
        command: std::iter::once("zerorate".to_owned()).chain(std::env::args().skip(1)).collect::<Vec<_>>().join(" "),
        quantity: first.map(Record::title).unwrap_or_default().to_owned(),
        interval: first.map(|record| super::units::interval(record.confidence)).unwrap_or_default(),
        coefficient_interval: "95 % intervals".to_owned(),
        pictures: groups.iter().map(|group| picture::svg(group)).collect(),
        records: records().map(section).collect(),
    };
    Ok(file.fill(allan_page(&page)?.as_bytes())?)
}

fn section(record: &Record) -> report::Record {
    let analysis = &record.analysis;
    let model =
        record.model().map(|fit| Fact::new("noise model", format!("holds to {:.1} %", fit.model_error * 100.0)));
    let facts = [
        Fact::new("samples", analysis.samples.to_string()),
        Fact::new("missing", analysis.missing.to_string()),
        Fact::new("sample rate", format!("{:.6} Hz", analysis.rate_hz)),
        Fact::new("length", super::units::span(analysis.samples as f64 / analysis.rate_hz)),
    ];
    let row = |point: &zerorate::allan::Point| {
        let &zerorate::allan::Point { tau_s, dev, lo, hi, edf, alpha, n, .. } = point;
        AllanRow { tau_s, dev, lo, hi, edf, n, noise: noise(alpha, record.quantity).to_owned() }
    };
    let unavailable = |missing: &zerorate::allan::Unavailable| {
        Fact::new(format!("{} s", number(missing.tau_s)), missing.reason.to_string())
    };
    report::Record {
        name: record.label(),
        unit: deviation_unit(record).unwrap_or_default().to_owned(),
        facts: facts.into_iter().chain(model).collect(),
        warnings: record.warnings.clone(),
        advice: record.advice(),
        coefficients: units::rows(record).into_iter().map(coefficient).collect(),
        points: analysis.points.iter().map(row).collect(),
        unavailable: analysis.unavailable.iter().map(unavailable).collect(),
    }
}

fn coefficient(row: units::Row) -> Coefficient {
    let value = |(Estimate { value, lo, hi }, unit): (Estimate, String)| CoefficientValue {
        value: number(value),
        lo: number(lo),
        hi: number(hi),
        unit,
    };
    Coefficient { name: row.name, values: row.values.into_iter().map(value).collect(), remark: row.remark }
}
