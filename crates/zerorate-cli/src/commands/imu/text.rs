//! The result as text.

use crate::commands::allan::record::Record;
use crate::commands::allan::units::{coefficients, span};
use anyhow::Result;
use std::fmt::Write;
use zerorate::allan::{Estimate, Term};
use zerorate_data::column::STANDARD_GRAVITY;
use zerorate_data::imu::Kind;

/// For each kind a table with a row for each axis.
pub fn table(axes: &[Record]) -> Result<String> {
    let mut text = String::new();
    if let Some(record) = axes.first() {
        let (samples, rate_hz) = (record.analysis.samples, record.analysis.rate_hz);
        let length = span(samples as f64 / rate_hz);
        writeln!(text, "{}: {samples} samples at {rate_hz:.6} Hz, {length}", record.file.display())?;
    }
    for kind in Kind::ALL {
        let of_kind: Vec<&Record> = axes.iter().filter(|axis| axis.quantity == Some(kind.quantity())).collect();
        if !of_kind.is_empty() {
            write!(text, "\n{}", of_group(kind, &of_kind)?)?;
        }
    }
    Ok(text.trim_end().to_owned() + "\n")
}

/// As B has it.
fn bias_unit(kind: Kind) -> (&'static str, f64) {
    match kind {
        Kind::Gyroscope => ("°/h", 3600.0),
        Kind::Accelerometer => ("µg", 1e6 / STANDARD_GRAVITY),
    }
}

fn of_group(kind: Kind, axes: &[&Record]) -> Result<String> {
    let mut text = format!("{}: value [95 % interval]; in brackets alone: not told from zero\n", kind.name());
    let width = axes.iter().map(|axis| axis.column.chars().count()).max().unwrap_or(0);
    for record in axes {
        write!(text, "  {:width$}", record.column)?;
        for named in coefficients(record) {
            let Estimate { value, lo, hi } = named.in_unit(0);
            let (letter, unit) = (named.letter, &named.units[0].0);
            match named.coefficient.identified {
                true => write!(text, "  {letter} {value:.4e} [{lo:.3e}, {hi:.3e}] {unit}")?,
                false => write!(text, "  {letter} [{lo:.3e}, {hi:.3e}] {unit}")?,
            }
        }
        writeln!(text)?;
        if let Err(why) = record.believed() {
            writeln!(text, "  {:width$}  NOT A RESULT: {why}", "")?;
        }
        for term in record.model().iter().flat_map(|fit| &fit.terms) {
            if let Term::GaussMarkov { sigma, tau_s } = term {
                let (unit, factor) = bias_unit(kind);
                let sigma = sigma.value * factor;
                writeln!(text, "  {:width$}  Gauss–Markov σ {sigma:.4} {unit}, T {:.3} s", "", tau_s.value)?;
            }
        }
    }
    Ok(text)
}
