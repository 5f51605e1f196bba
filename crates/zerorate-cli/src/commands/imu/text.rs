//! Formats the noise coefficients of all axes, and their comparison with a data sheet, as text.

use anyhow::Result;
use std::fmt::Write;
use zerorate_allan::span;
use zerorate_imu::{AllanReport, AxisReport, CoefficientReport, FitReport, ImuReport, Kind};
use zerorate_view::noise::{GaussMarkov, gauss_markov, is_without_misfit, stated};
use zerorate_view::plot::number;
use zerorate_view::report::Table;

pub fn table(report: &ImuReport) -> Result<String> {
    let mut text = String::new();
    if let Some(axis) = report.axes.first() {
        let ImuReport { samples, rate_hz, .. } = *report;
        let length = span(samples as f64 / rate_hz);
        write!(text, "{}: {samples} samples at {rate_hz:.6} Hz, {length}", axis.report.file)?;
        // the accelerometer may have its own topic with another rate
        if let Some(other) = report.axes.iter().find(|other| other.report.rate_hz != rate_hz) {
            let AllanReport { samples, rate_hz, .. } = other.report;
            write!(text, "; {} {samples} samples at {rate_hz:.6} Hz", other.kind.map_or("others", Kind::name))?;
        }
        writeln!(text)?;
        writeln!(text, "value [95 % interval]; < upper limit where it cannot be told from zero")?;
    }
    for kind in Kind::ALL {
        let of_kind: Vec<&AxisReport> = report.axes.iter().filter(|axis| axis.kind == Some(kind)).collect();
        if !of_kind.is_empty() {
            write!(text, "\n{}", of_group(kind, &of_kind))?;
        }
    }
    Ok(text)
}

pub fn comparison(table: &Table) -> String {
    let rows: Vec<Vec<String>> = std::iter::once(&table.head).chain(&table.rows).cloned().collect();
    format!("\n{}\n{}", table.title, aligned(&rows))
}

/// Formats N, B and K side by side, and the other terms of a model below.
fn of_group(kind: Kind, axes: &[&AxisReport]) -> String {
    let mut rows = vec![vec![kind.name().to_owned()]];
    for AxisReport { name, report, .. } in axes {
        let all: Vec<_> = report.model().into_iter().flat_map(FitReport::coefficients).collect();
        let (columns, others) = all.split_at(all.len().min(3));
        if rows[0].len() == 1 {
            rows[0].extend(columns.iter().map(|(letter, of)| format!("{letter}, {}", of.units[0].unit)));
            rows[0].extend((!columns.is_empty()).then(|| "model misfit".to_owned()));
        }
        let mut row = vec![name.clone()];
        let is_rejected = report.model().is_some_and(|fit| fit.rejected);
        row.extend(columns.iter().map(|(_, of)| if is_rejected { "–".to_owned() } else { value(of) }));
        row.extend(report.model().map(|fit| match fit.model_error {
            _ if fit.motion_ratio.is_some() => "motion".to_owned(),
            Some(error) if !is_without_misfit(fit) => format!("{:.1} %", error * 100.0),
            _ => "none found".to_owned(),
        }));
        rows.push(row);
        match (&report.rejection, report.valid_model()) {
            (Some(why), _) => rows.push(vec![String::new(), format!("NOT A RESULT: {why}")]),
            (None, fit) => rows.extend(fit.into_iter().flat_map(|fit| further(others, fit))),
        }
    }
    aligned(&rows)
}

fn value(of: &CoefficientReport) -> String {
    of.in_unit(0).map_or_else(String::new, |value| stated(value, of.identified))
}

/// Rows for the terms of a model other than N, B and K, one row for each term.
fn further(others: &[(char, &CoefficientReport)], fit: &FitReport) -> Vec<Vec<String>> {
    let coefficient =
        |(letter, of): &(char, &CoefficientReport)| format!("{letter} {} {}", value(of), of.units[0].unit);
    let gauss_markov_text = |term: GaussMarkov| {
        format!("Gauss–Markov σ {} {}, T {} s", number(term.sigma.value), term.unit, number(term.tau_s.value))
    };
    let all = others.iter().map(coefficient).chain(gauss_markov(fit).map(gauss_markov_text));
    all.map(|text| vec![String::new(), text]).collect()
}

/// Aligns the columns. In a row of two cells, the second cell spans the remaining columns.
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
