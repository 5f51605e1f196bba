//! The axes of an IMU together as plain data.

use super::AllanReport;
use crate::{Kind, Moment, Record};
use serde::Serialize;
#[cfg(feature = "types")]
use ts_rs::TS;
use zerorate_allan::datasheet::{Figure, Line, Verdict};
use zerorate_allan::{DataSheet, MotionKind};

/// All axes of a log. Scripts read it as the JSON of `zerorate imu --json`.
#[derive(Clone, Debug, Serialize)]
pub struct ImuReport {
    /// Sample rate of the first axis, Hz.
    pub rate_hz: f64,
    /// Number of samples of the first axis, including missing ones.
    pub samples: u64,
    /// The topic, if the log is a bag.
    pub topic: Option<String>,
    /// Warnings about the whole log. Each axis has its own.
    pub warnings: Vec<String>,
    /// Moments at which several axes jump or have a glitch.
    pub motion: Vec<MotionReport>,
    /// The data sheet that the axes are compared with.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub data_sheet: Option<SheetReport>,
    /// The axes, gyroscopes first.
    pub axes: Vec<AxisReport>,
}

/// The data sheet with which the axes are compared.
#[derive(Clone, Debug, Serialize)]
pub struct SheetReport {
    /// The name of the sensor.
    pub name: String,
    /// The document that prints the lines, unless a line has its own source.
    pub source: Option<String>,
}

/// The results of an axis.
#[derive(Clone, Debug, Serialize)]
#[cfg_attr(feature = "types", derive(TS))]
pub struct AxisReport {
    /// The name of its column.
    pub name: String,
    /// Gyroscope or accelerometer; `None` if the axis is neither.
    pub kind: Option<Kind>,
    /// The comparison with each line of the data sheet; empty without a data sheet.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "types", ts(skip))]
    pub data_sheet: Vec<LineReport>,
    /// Deviations and noise model.
    #[serde(flatten)]
    pub report: AllanReport,
}

/// The comparison of an axis with a line of a data sheet.
#[derive(Clone, Debug, Serialize)]
pub struct LineReport {
    /// The figure that is compared, as in `angle random walk N`.
    pub figure: &'static str,
    /// `typical` or `maximum`.
    pub limit: &'static str,
    /// The value that the data sheet states.
    pub value: f64,
    /// The unit of `value` and of the measured values.
    pub unit: String,
    /// The document that prints the line, if it is not the source of the sheet.
    pub source: Option<String>,
    /// The measured value, in the unit of the line. `None` without a valid model, or without a deviation that may be
    /// the minimum of the curve.
    pub measured: Option<f64>,
    /// Lower end of the 95 % interval of `measured`.
    pub measured_lo: Option<f64>,
    /// Upper end of the 95 % interval of `measured`.
    pub measured_hi: Option<f64>,
    /// The result of the comparison: `within`, `better`, `worse` or `cannot be told`.
    pub verdict: &'static str,
}

/// A moment at which several axes jump or have a glitch.
#[derive(Clone, Debug, Serialize)]
pub struct MotionReport {
    /// Time from the start of the log, s.
    pub at_s: f64,
    /// The names of the axes.
    pub axes: Vec<String>,
    /// `jump` for a jump of the level, or `knock` for a glitch.
    pub kind: &'static str,
}

impl ImuReport {
    /// Reports on the axes of a log, with the warnings about the whole log.
    #[must_use]
    pub fn new(axes: &[Record], topic: Option<&str>, warnings: &[String], sheet: Option<&DataSheet>) -> Self {
        let first = axes.first().map(|axis| &axis.analysis);
        Self {
            rate_hz: first.map_or(0.0, |analysis| analysis.rate_hz),
            samples: first.map_or(0, |analysis| analysis.samples),
            topic: topic.map(str::to_owned),
            warnings: warnings.to_vec(),
            motion: MotionReport::all(axes),
            data_sheet: sheet.map(|sheet| SheetReport { name: sheet.name.clone(), source: sheet.source.clone() }),
            axes: axes.iter().map(|axis| AxisReport::new(axis, sheet)).collect(),
        }
    }
}

impl AxisReport {
    /// Reports on an axis, compared with the lines of a data sheet.
    #[must_use]
    pub fn new(axis: &Record, sheet: Option<&DataSheet>) -> Self {
        let kind = axis.kind();
        let lines = match (sheet, kind) {
            (Some(sheet), Some(Kind::Gyroscope)) => &sheet.gyroscope[..],
            (Some(sheet), Some(Kind::Accelerometer)) => &sheet.accelerometer,
            _ => &[],
        };
        Self {
            name: axis.column.clone(),
            kind,
            data_sheet: lines.iter().map(|line| LineReport::new(line, axis)).collect(),
            report: AllanReport::new(axis),
        }
    }
}

impl LineReport {
    fn new(line: &Line, axis: &Record) -> Self {
        let compared = line.compare(axis.model(), &axis.analysis);
        let measured = compared.measured.as_ref();
        Self {
            figure: figure(line.figure, axis.kind()),
            limit: if line.is_maximum { "maximum" } else { "typical" },
            value: line.value,
            unit: line.unit.clone(),
            source: line.source.clone(),
            measured: measured.map(|measured| measured.value),
            measured_lo: measured.map(|measured| measured.lo),
            measured_hi: measured.map(|measured| measured.hi),
            verdict: match compared.verdict {
                Verdict::Within => "within",
                Verdict::Better => "better",
                Verdict::Worse => "worse",
                Verdict::Open => "cannot be told",
            },
        }
    }
}

fn figure(figure: Figure, kind: Option<Kind>) -> &'static str {
    match (figure, kind) {
        (Figure::NoiseDensity, _) => "noise density, one-sided",
        (Figure::RandomWalk, Some(Kind::Accelerometer)) => "velocity random walk N",
        (Figure::RandomWalk, _) => "angle random walk N",
        (Figure::CurveMinimum, _) => "bias instability, minimum of the curve",
        (Figure::BiasInstability, _) => "bias instability B",
        (Figure::RateRandomWalk, Some(Kind::Accelerometer)) => "acceleration random walk K",
        (Figure::RateRandomWalk, _) => "rate random walk K",
    }
}

impl MotionReport {
    /// The moments that the axes of one log share.
    #[must_use]
    pub fn all(axes: &[Record]) -> Vec<Self> {
        let found = |Moment { at_s, axes, kind }: Moment| Self {
            at_s,
            axes,
            kind: match kind {
                MotionKind::Jump => "jump",
                MotionKind::Knock => "knock",
            },
        };
        Moment::all(&Record::models(axes), axes.first().map_or(0.0, |axis| axis.skipped_s))
            .into_iter()
            .map(found)
            .collect()
    }
}
