//! The result as one JSON object.

use crate::commands::allan::json;
use crate::commands::allan::record::Record;
use serde::Serialize;
use zerorate_data::imu::Kind;

/// All axes of a log.
#[derive(Serialize)]
pub struct Report<'a> {
    rate_hz: f64,
    samples: u64,
    axes: Vec<OfAxis<'a>>,
}

#[derive(Serialize)]
struct OfAxis<'a> {
    name: &'a str,
    kind: Option<&'static str>,
    #[serde(flatten)]
    report: json::Report<'a>,
}

impl<'a> Report<'a> {
    pub fn new(axes: &'a [Record]) -> Self {
        let first = axes.first().map(|axis| &axis.analysis);
        let of = |axis: &'a Record| OfAxis {
            name: &axis.column,
            kind: axis.quantity.and_then(Kind::of).map(Kind::name),
            report: json::Report::new(axis),
        };
        Self {
            rate_hz: first.map_or(0.0, |analysis| analysis.rate_hz),
            samples: first.map_or(0, |analysis| analysis.samples),
            axes: axes.iter().map(of).collect(),
        }
    }
}
