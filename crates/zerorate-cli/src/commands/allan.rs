//! `zerorate allan`: how much the mean of a rate at rest moves, over how long it is taken.

use super::{print, print_json, warn};
use crate::column::{self, Column, RawType, Series};
use crate::exit::{Refused, Usage};
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use zerorate::allan::{self, Input};

/// Computes the Allan deviation of a gyroscope's log, taken at rest: a capture, or the log of any other part.
///
/// Reads captures, Parquet, Arrow streams, CSV (comma, semicolon, tab or blanks; with or without a header; lines that start with # or % are
/// comments) and, with --raw, plain binary numbers. The averaging times are 1, 2, 4 … samples.
///
/// The table has a row for each averaging time: tau_s; m, the samples in each average; the deviation in °/s and in °/h; n, the differences
/// that entered. With --json `dev` is in °/s, or whatever --scale makes of it.
#[derive(Args, Debug)]
pub struct AllanArgs {
    /// The log.
    #[arg(value_name = "FILE")]
    file: PathBuf,

    /// The column, by its name or its number counted from 0 [default: the rate of a capture, or the only column].
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "raw")]
    column: Option<String>,

    /// Samples per second [default: as measured by the timestamps of a capture; every other file needs it].
    #[arg(long, value_name = "HZ", value_parser = positive)]
    rate: Option<f64>,

    /// What a step of 1 in the column is in °/s [default: the scale of the part for the codes of a capture, else 1].
    #[arg(long, value_name = "X", value_parser = positive)]
    scale: Option<f64>,

    /// The file is nothing but numbers of this type, little endian.
    #[arg(long, value_enum)]
    raw: Option<RawType>,

    /// The statistic.
    #[arg(long, value_enum, default_value = "oadev")]
    stat: Stat,

    /// Close up the gaps where a capture lost samples. This changes the result.
    #[arg(long)]
    ignore_gaps: bool,

    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,
}

/// Statistics of stability.
#[derive(Clone, Copy, Debug, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
enum Stat {
    /// Overlapping Allan deviation.
    Oadev,
}

/// The JSON form.
#[derive(Serialize)]
struct Report {
    rate_hz: f64,
    samples: usize,
    stat: Stat,
    points: Vec<Row>,
}

#[derive(Serialize)]
struct Row {
    tau_s: f64,
    m: u64,
    dev: f64,
    n: u64,
}

pub fn run(args: &AllanArgs) -> Result<()> {
    let column = column::read(&args.file, args.column.as_deref(), args.raw)?;
    warn(column.warning.as_slice());
    check_gaps(args, &column)?;
    let report = report(args, &column)?;
    if args.json {
        return print_json(&report);
    }
    let Report { rate_hz, samples, .. } = report;
    eprintln!(
        "{}, column {}: {samples} samples at {rate_hz:.6} Hz, overlapping Allan deviation",
        args.file.display(),
        column.name
    );
    print(&table(&report.points)?)
}

/// A gap that is closed up looks like a step, or hides one.
fn check_gaps(args: &AllanArgs, column: &Column) -> Result<()> {
    let lost = column.timing.map_or(0, |timing| timing.lost);
    let lost_of = format!("{}: {lost} samples were lost among {}", args.file.display(), column.series.len());
    match lost {
        0 => {}
        _ if args.ignore_gaps => warn(&[format!("{lost_of}; the gaps are closed up, which changes the result")]),
        _ => {
            let advice =
                "the Allan deviation needs a whole record: take another, or give --ignore-gaps to close the gaps up";
            return Err(Refused(format!("{lost_of}; {advice}")).into());
        }
    }
    Ok(())
}

fn report(args: &AllanArgs, column: &Column) -> Result<Report> {
    let measured = column.timing.and_then(|timing| timing.rate_hz);
    let rate_hz = args.rate.or(measured).ok_or_else(|| {
        Usage(format!("{} does not say how fast it was sampled: give --rate HZ", args.file.display()))
    })?;
    let samples = column.series.len();
    let octaves = allan::octaves(samples);
    ensure!(!octaves.is_empty(), "{}: {samples} samples are too few, at least 2 are needed", args.file.display());
    let scale = args.scale.unwrap_or(column.scale);
    let input = match &column.series {
        Series::Codes(codes) => Input::Codes { codes, gaps: &[] },
        Series::Numbers(numbers) => Input::Rate(numbers),
    };
    let found = allan::deviations(&input, rate_hz, allan::Stat::Oadev, &octaves);
    let points = found.into_iter().flatten().map(|point| Row {
        tau_s: point.m as f64 / rate_hz,
        m: point.m,
        dev: point.dev * scale,
        n: point.n,
    });
    Ok(Report { rate_hz, samples, stat: args.stat, points: points.collect() })
}

fn table(points: &[Row]) -> Result<String> {
    let mut text = format!("{:>14} {:>10} {:>14} {:>14} {:>10}\n", "tau_s", "m", "dev_dps", "dev_deg_per_h", "n");
    for Row { tau_s, m, dev, n } in points {
        let per_hour = dev * 3600.0;
        writeln!(text, "{tau_s:>14.6} {m:>10} {dev:>14.6e} {per_hour:>14.6e} {n:>10}")?;
    }
    Ok(text)
}

fn positive(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number: &f64| *number > 0.0 && number.is_finite())
        .ok_or_else(|| "must be a number above zero".to_owned())
}
