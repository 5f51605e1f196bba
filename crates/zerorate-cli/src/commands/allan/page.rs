//! The result as one HTML page.

use super::picture;
use super::record::Record;
use super::units::{self, deviation_unit, noise};
use crate::output::Staged;
use anyhow::Result;
use zerorate::allan::{Estimate, Term};
use zerorate_view::plot::number;
use zerorate_view::report::{
    self, AllanPage, AllanRow, Coefficient, CoefficientValue, Fact, Group, Table, allan_page,
};

/// What the page says of all records together.
#[derive(Default)]
pub struct Head {
    pub title: String,
    pub facts: Vec<Fact>,
    pub warnings: Vec<String>,
    pub tables: Vec<Table>,
}

/// Writes the page of all records, with a group for each quantity.
pub fn write(file: Staged, head: Head, records: &[Record]) -> Result<()> {
    let Head { title, facts, warnings, tables } = head;
    let first = records.first();
    let groups: Vec<&[Record]> = records.chunk_by(|a, b| a.quantity == b.quantity).collect();
    let page = AllanPage {
        title,
        command: std::iter::once("zerorate".to_owned()).chain(std::env::args().skip(1)).collect::<Vec<_>>().join(" "),
        quantity: first.map(Record::title).unwrap_or_default().to_owned(),
        interval: first.map(|record| units::interval(record.confidence)).unwrap_or_default(),
        coefficient_interval: "95 % intervals".to_owned(),
        facts,
        warnings,
        tables,
        groups: groups.into_iter().map(group).collect(),
        records: records.iter().map(section).collect(),
    };
    Ok(file.fill(allan_page(&page)?.as_bytes())?)
}

/// Curves, spectra and the records themselves of one quantity. A record alone has its coefficients below.
fn group(records: &[Record]) -> Group {
    let curves = if picture::are_axes(records) { picture::multiples(records) } else { picture::svg(records) };
    let pictures = std::iter::once(curves).chain(picture::spectra(records)).chain(picture::signals(records));
    let tables = match records {
        [_] => Vec::new(),
        several => [by_axis(several), lines(several)].into_iter().filter(|table| !table.rows.is_empty()).collect(),
    };
    let name = if records.len() > 1 { picture::heading(records) } else { "" };
    Group { name: name.to_owned(), tables, pictures: pictures.collect() }
}

/// A row for each coefficient in each unit, a column for each axis.
fn by_axis(records: &[Record]) -> Table {
    let name = |record: &Record| picture::name(records, record);
    let all: Vec<_> = records.iter().map(units::coefficients).collect();
    let mut rows = Vec::new();
    let letters = ['N', 'B', 'K', 'Q', 'R'];
    for letter in letters {
        let of_axes: Vec<_> = all.iter().map(|named| named.iter().find(|one| one.letter == letter)).collect();
        let Some(some) = of_axes.iter().flatten().next() else { continue };
        for (index, (unit, _)) in some.units.iter().enumerate() {
            let title = if index == 0 { format!("{letter}, {}", some.name) } else { String::new() };
            let cell = |named: &Option<&units::Named<'_>>| match named {
                Some(named) => value(&named.in_unit(index), named.coefficient.identified),
                None => "–".to_owned(),
            };
            rows.push(std::iter::once(title).chain(of_axes.iter().map(cell)).chain([unit.clone()]).collect());
        }
    }
    if rows.is_empty() {
        return Table::default();
    }
    let error = |record: &Record| match record.model() {
        Some(fit) if fit.is_rejected => format!("{:.1} %: rejected", fit.model_error * 100.0),
        Some(fit) => format!("{:.1} %", fit.model_error * 100.0),
        None => "no model".to_owned(),
    };
    rows.push(
        std::iter::once("the model holds to".to_owned())
            .chain(records.iter().map(error))
            .chain([String::new()])
            .collect(),
    );
    let head = std::iter::once(String::new()).chain(records.iter().map(name)).chain(["unit".to_owned()]);
    Table {
        title: "Coefficients by axis".to_owned(),
        head: head.collect(),
        rows,
        note:
            "In brackets 95 % intervals; < upper limit where the coefficient cannot be told from zero. B is drawn at \
               0.664·B, where its floor lies."
                .to_owned(),
    }
}

fn value(Estimate { value, lo, hi }: &Estimate, is_identified: bool) -> String {
    match is_identified {
        true => format!("{} [{}, {}]", number(*value), number(*lo), number(*hi)),
        false => format!("< {}", number(*hi)),
    }
}

/// What stands out of the spectra, by frequency.
fn lines(records: &[Record]) -> Table {
    let unit = records.first().map_or("", picture::unit);
    let mut found: Vec<(f64, Vec<String>)> = Vec::new();
    for record in records {
        for term in record.model().iter().flat_map(|fit| &fit.terms) {
            if let Term::Line(line) = term {
                let frequency = format!("{:.4} Hz", line.frequency_hz);
                let (width, rms) = (format!("{:.4} Hz", line.width_hz), format!("{} {unit}", number(line.rms)));
                found.push((line.frequency_hz, vec![frequency, picture::name(records, record), width, rms]));
            }
        }
    }
    found.sort_by(|a, b| a.0.total_cmp(&b.0));
    Table {
        title: "What stands out of the spectrum".to_owned(),
        head: ["frequency", "axis", "width", "rms"].map(str::to_owned).to_vec(),
        rows: found.into_iter().map(|(_, row)| row).collect(),
        note: "Disturbances or resonances: left out of N, B and K, part of the curve. What all axes have comes from \
               the table they stand on."
            .to_owned(),
    }
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
