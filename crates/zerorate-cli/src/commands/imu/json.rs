//! The result as one JSON object.

use super::datasheet::{Comparison, ComparisonRow};
use crate::commands::allan::json::{self, Motion};
use serde::Serialize;
use zerorate_allan::DataSheet;
use zerorate_imu::Kind;
use zerorate_imu::Record;

/// All axes of a log.
#[derive(Serialize)]
pub struct Report<'a> {
    rate_hz: f64,
    samples: u64,
    /// The topic, if the log is a bag.
    topic: Option<&'a str>,
    /// Warnings about the whole log. Each axis carries its own.
    warnings: &'a [String],
    motion: Vec<Motion>,
    #[serde(skip_serializing_if = "Option::is_none")]
    data_sheet: Option<Sheet<'a>>,
    axes: Vec<OfAxis<'a>>,
}

#[derive(Serialize)]
struct Sheet<'a> {
    name: &'a str,
    source: Option<&'a str>,
}

#[derive(Serialize)]
struct OfAxis<'a> {
    name: &'a str,
    kind: Option<&'static str>,
    /// The comparison with each line of the data sheet.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    data_sheet: Vec<ComparisonRow<'a>>,
    #[serde(flatten)]
    report: json::Report<'a>,
}

impl<'a> Report<'a> {
    pub fn new(
        log: (Option<&'a str>, &'a [String]),
        axes: &'a [Record],
        sheet: Option<&'a DataSheet>,
        compared: &[Comparison<'a>],
    ) -> Self {
        let (topic, warnings) = log;
        let first = axes.first().map(|axis| &axis.analysis);
        let of = |axis: &'a Record| OfAxis {
            name: &axis.column,
            kind: axis.quantity.and_then(Kind::of).map(Kind::name),
            data_sheet: compared.iter().filter(|one| one.axis == axis.column).map(ComparisonRow::new).collect(),
            report: json::Report::new(axis),
        };
        Self {
            rate_hz: first.map_or(0.0, |analysis| analysis.rate_hz),
            samples: first.map_or(0, |analysis| analysis.samples),
            topic,
            warnings,
            motion: json::motion(axes),
            data_sheet: sheet.map(|sheet| Sheet { name: &sheet.name, source: sheet.source.as_deref() }),
            axes: axes.iter().map(of).collect(),
        }
    }
}
