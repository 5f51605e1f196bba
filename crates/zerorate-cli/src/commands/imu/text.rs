//! The result as text.

use crate::commands::allan::words::units::{self, GaussMarkov, Named, coefficients, is_without_misfit, span, stated};
use anyhow::Result;
use std::fmt::Write;
use zerorate_allan::Fit;
use zerorate_imu::Kind;
use zerorate_imu::Record;
use zerorate_view::plot::number;
use zerorate_view::report::Table;

/// Formats a table for each kind of sensor, with a row for each axis.
pub fn table(axes: &[Record]) -> Result<String> {
    let mut text = String::new();
    if let Some(record) = axes.first() {
        let (samples, rate_hz) = (record.analysis.samples, record.analysis.rate_hz);
        let length = span(samples as f64 / rate_hz);
        writeln!(text, "{}: {samples} samples at {rate_hz:.6} Hz, {length}", record.file.display())?;
        writeln!(text, "value [95 % interval]; < upper limit where it cannot be told from zero")?;
    }
    for kind in Kind::ALL {
        let of_kind: Vec<&Record> = axes.iter().filter(|axis| axis.quantity == Some(kind.quantity())).collect();
        if !of_kind.is_empty() {
            write!(text, "\n{}", of_group(kind, &of_kind)?)?;
        }
    }
    Ok(text)
}

/// Formats the comparison with a data sheet, a row for each line and axis.
pub fn comparison(table: &Table) -> String {
    let rows: Vec<Vec<String>> = std::iter::once(&table.head).chain(&table.rows).cloned().collect();
    format!("\n{}\n{}", table.title, aligned(&rows))
}

/// Formats N, B and K side by side, and the other terms of a model below.
fn of_group(kind: Kind, axes: &[&Record]) -> Result<String> {
    let mut rows = vec![vec![kind.name().to_owned()]];
    for record in axes {
        let all = coefficients(record);
        let (columns, others) = all.split_at(all.len().min(3));
        if rows[0].len() == 1 {
            rows[0].extend(columns.iter().map(|named| format!("{}, {}", named.letter, named.units[0].0)));
            rows[0].extend((!columns.is_empty()).then(|| "model misfit".to_owned()));
        }
        let mut row = vec![record.column.clone()];
        let is_rejected = record.model().is_some_and(|fit| fit.is_rejected);
        row.extend(columns.iter().map(|named| match is_rejected {
            true => "–".to_owned(),
            false => stated(named.in_unit(0), named.coefficient.identified),
        }));
        row.extend(record.model().map(|fit| match is_without_misfit(fit) {
            true => "none found".to_owned(),
            false => format!("{:.1} %", fit.model_error * 100.0),
        }));
        rows.push(row);
        match record.valid_model() {
            Ok(fit) => rows.extend(further(record, others, fit)),
            Err(why) => rows.push(vec![String::new(), format!("NOT A RESULT: {why}")]),
        }
    }
    Ok(aligned(&rows))
}

/// The terms of a model beside N, B and K, a row each.
fn further(record: &Record, others: &[Named<'_>], fit: &Fit) -> Vec<Vec<String>> {
    let coefficient = |named: &Named<'_>| {
        let value = stated(named.in_unit(0), named.coefficient.identified);
        format!("{} {value} {}", named.letter, named.units[0].0)
    };
    let gauss_markov = |term: GaussMarkov| {
        format!("Gauss–Markov σ {} {}, T {} s", number(term.sigma.value), term.unit, number(term.tau_s.value))
    };
    let all = others.iter().map(coefficient).chain(units::gauss_markov(fit, record.quantity).map(gauss_markov));
    all.map(|text| vec![String::new(), text]).collect()
}

/// Aligns the columns. The second cell of a row with two cells spans the rest.
fn aligned(rows: &[Vec<String>]) -> String {
    let width = |column: usize| {
        let cells = rows.iter().filter(|row| row.len() > 2 || column == 0).filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let mut text = String::new();
    for (index, row) in rows.iter().enumerate() {
        let indent = if index == 0 { "" } else { "  " };
        let cells = row.iter().enumerate().map(|(column, cell)| {
            let width = width(column) + if column == 0 { 2 - indent.len() } else { 0 };
            format!("{cell:width$}")
        });
        text += format!("{indent}{}", cells.collect::<Vec<_>>().join("  ")).trim_end();
        text.push('\n');
    }
    text
}
