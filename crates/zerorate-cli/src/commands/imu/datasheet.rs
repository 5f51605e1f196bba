//! Compares the axes with a data sheet.

use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::{Result, anyhow};
use std::io::ErrorKind;
use std::path::Path;
use zerorate_allan::DataSheet;
use zerorate_imu::{AxisReport, ImuReport, Kind, LineReport};
use zerorate_jobs::catalogue;
use zerorate_view::plot::number;
use zerorate_view::report::Table;

pub fn read(path: &Path, outputs: &mut Outputs) -> Result<DataSheet> {
    let text = catalogue::text(path, outputs)?.map_err(|error| match error.kind() {
        ErrorKind::InvalidData | ErrorKind::FileTooLarge => {
            Usage(format!("{}: not the file of a data sheet: {error}", path.display())).into()
        }
        ErrorKind::NotFound => {
            anyhow!("cannot read the data sheet: {}", catalogue::unknown(&path.display().to_string()).0)
        }
        _ => anyhow::Error::from(error).context(format!("cannot read {}", path.display())),
    })?;
    DataSheet::parse(&text).map_err(|error| Usage(format!("{}: {error}", path.display())).into())
}

/// `None` without a data sheet.
pub fn table(report: &ImuReport) -> Option<Table> {
    let sheet = report.data_sheet.as_ref()?;
    let of_kind = |kind: Kind| {
        let axes: Vec<&AxisReport> = report.axes.iter().filter(|axis| axis.kind == Some(kind)).collect();
        let lines = axes.first().map_or(0, |axis| axis.data_sheet.len());
        let rows = (0..lines).flat_map(|line| axes.iter().map(move |axis| row(&axis.name, &axis.data_sheet[line])));
        rows.collect::<Vec<_>>()
    };
    Some(Table {
        title: format!("Beside the data sheet of {}", sheet.name),
        head: HEAD.map(str::to_owned).to_vec(),
        rows: Kind::ALL.into_iter().flat_map(of_kind).collect(),
        note: sheet.source.as_ref().map(|source| format!("Source: {source}")).unwrap_or_default(),
    })
}

const HEAD: [&str; 5] = ["figure", "data sheet", "axis", "measured [95 % interval]", "verdict"];

fn row(axis: &str, line: &LineReport) -> Vec<String> {
    let limit = if line.limit == "maximum" { "at most" } else { line.limit };
    let stated = format!("{limit} {} {}", line.value, line.unit);
    vec![line.figure.to_owned(), stated, axis.to_owned(), found(line), judged(line)]
}

/// Formats a measured value: `0.0569 [0.0565, 0.0573]`, `< 0.1` for an upper limit, or `no model`.
fn found(line: &LineReport) -> String {
    match (line.measured, line.measured_lo, line.measured_hi) {
        (Some(value), Some(lo), Some(hi)) if lo > 0.0 => {
            format!("{} [{}, {}]", number(value), number(lo), number(hi))
        }
        (.., Some(hi)) => format!("< {}", number(hi)),
        _ => "no model".to_owned(),
    }
}

/// Formats the verdict. If the measured interval lies above zero, `better` and `worse` are followed by the ratio of
/// the measured value to the value of the data sheet.
fn judged(line: &LineReport) -> String {
    let measured = line.measured.filter(|_| line.measured_lo.is_some_and(|lo| lo > 0.0));
    match measured.filter(|_| matches!(line.verdict, "better" | "worse")) {
        Some(measured) => format!("{}, {:.2} times", line.verdict, measured / line.value),
        None => line.verdict.to_owned(),
    }
}
