//! The comparison of the axes with a data sheet.

use crate::catalogue;
use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::{Result, anyhow};
use serde::Serialize;
use std::io::ErrorKind;
use std::path::Path;
use zerorate_allan::DataSheet;
use zerorate_allan::Estimate;
use zerorate_allan::datasheet::{Figure, Line, Verdict};
use zerorate_imu::Kind;
use zerorate_imu::Record;
use zerorate_view::plot::number;
use zerorate_view::report::Table;

/// A line of a data sheet, compared with an axis.
pub struct Comparison<'a> {
    pub kind: Kind,
    pub axis: &'a str,
    pub line: &'a Line,
    pub measured: Option<Estimate>,
    pub verdict: Verdict,
}

/// Reads a part of the catalogue, or the file at `path`.
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

/// Compares every line with every axis of its kind, line by line.
pub fn compare<'a>(sheet: &'a DataSheet, axes: &'a [Record]) -> Vec<Comparison<'a>> {
    let of_kind = |kind: Kind| {
        let lines = match kind {
            Kind::Gyroscope => &sheet.gyroscope,
            Kind::Accelerometer => &sheet.accelerometer,
        };
        let is_of = move |axis: &&Record| axis.quantity == Some(kind.quantity());
        lines.iter().flat_map(move |line| axes.iter().filter(is_of).map(move |axis| beside(kind, line, axis)))
    };
    Kind::ALL.into_iter().flat_map(of_kind).collect()
}

fn beside<'a>(kind: Kind, line: &'a Line, axis: &'a Record) -> Comparison<'a> {
    let compared = line.compare(axis.model(), &axis.analysis);
    Comparison { kind, axis: &axis.column, line, measured: compared.measured, verdict: compared.verdict }
}

impl Comparison<'_> {
    /// Names the figure that is compared.
    pub fn figure(&self) -> &'static str {
        match (self.line.figure, self.kind) {
            (Figure::NoiseDensity, _) => "noise density, one-sided",
            (Figure::RandomWalk, Kind::Gyroscope) => "angle random walk N",
            (Figure::RandomWalk, Kind::Accelerometer) => "velocity random walk N",
            (Figure::CurveMinimum, _) => "bias instability, minimum of the curve",
            (Figure::BiasInstability, _) => "bias instability B",
            (Figure::RateRandomWalk, Kind::Gyroscope) => "rate random walk K",
            (Figure::RateRandomWalk, Kind::Accelerometer) => "acceleration random walk K",
        }
    }

    /// `typical 0.05 °/s/√Hz`.
    pub fn stated(&self) -> String {
        let Line { is_maximum, value, unit, .. } = self.line;
        format!("{} {value} {unit}", if *is_maximum { "at most" } else { "typical" })
    }

    /// `0.0569 [0.0565, 0.0573]`, in the unit of the line.
    pub fn found(&self) -> String {
        match self.measured {
            Some(Estimate { value, lo, hi }) if lo > 0.0 => {
                format!("{} [{}, {}]", number(value), number(lo), number(hi))
            }
            Some(Estimate { hi, .. }) => format!("< {}", number(hi)),
            None => "no model".to_owned(),
        }
    }

    /// The measured value divided by the stated one.
    pub fn ratio(&self) -> Option<f64> {
        self.measured.filter(|measured| measured.lo > 0.0).map(|measured| measured.value / self.line.value)
    }

    pub fn verdict(&self) -> &'static str {
        match self.verdict {
            Verdict::Within => "within",
            Verdict::Better => "better",
            Verdict::Worse => "worse",
            Verdict::Open => "cannot be told",
        }
    }

    /// The verdict, with the ratio where it is meaningful.
    pub fn judged(&self) -> String {
        match self.ratio().filter(|_| matches!(self.verdict, Verdict::Better | Verdict::Worse)) {
            Some(ratio) => format!("{}, {ratio:.2} times", self.verdict()),
            None => self.verdict().to_owned(),
        }
    }
}

/// All of them, for the page.
pub fn table(sheet: &DataSheet, all: &[Comparison<'_>]) -> Table {
    let row = |one: &Comparison<'_>| {
        vec![one.figure().to_owned(), one.stated(), one.axis.to_owned(), one.found(), one.judged()]
    };
    Table {
        title: format!("Beside the data sheet of {}", sheet.name),
        head: HEAD.map(str::to_owned).to_vec(),
        rows: all.iter().map(row).collect(),
        note: sheet.source.as_ref().map(|source| format!("Source: {source}")).unwrap_or_default(),
    }
}

/// Names of the columns of that table.
const HEAD: [&str; 5] = ["figure", "data sheet", "axis", "measured [95 % interval]", "verdict"];

/// A comparison in JSON.
#[derive(Serialize)]
pub struct ComparisonRow<'a> {
    figure: &'static str,
    /// typical or maximum
    limit: &'static str,
    value: f64,
    unit: &'a str,
    source: Option<&'a str>,
    measured: Option<f64>,
    measured_lo: Option<f64>,
    measured_hi: Option<f64>,
    verdict: &'static str,
}

impl<'a> ComparisonRow<'a> {
    pub fn new(comparison: &Comparison<'a>) -> Self {
        let line = comparison.line;
        let measured = comparison.measured.as_ref();
        Self {
            figure: comparison.figure(),
            limit: if line.is_maximum { "maximum" } else { "typical" },
            value: line.value,
            unit: &line.unit,
            source: line.source.as_deref(),
            measured: measured.map(|measured| measured.value),
            measured_lo: measured.map(|measured| measured.lo),
            measured_hi: measured.map(|measured| measured.hi),
            verdict: comparison.verdict(),
        }
    }
}
