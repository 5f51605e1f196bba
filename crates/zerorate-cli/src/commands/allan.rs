//! `zerorate allan`: how much the mean of a rate at rest moves, over how long it is taken.

use super::{print, print_json, warn};
use crate::column::{self, Column, ColumnArgs, Series};
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::fmt::Write;
use std::path::PathBuf;
use zerorate::allan::{self, Input};

/// Computes the Allan deviation of a gyroscope's log, taken at rest: a capture, or the log of any other part.
///
/// Reads captures, Parquet, Arrow, NPY, ROS 2 bags (MCAP or SQLite, sensor_msgs/Imu), text of any dialect and, with --raw, plain binary
/// numbers, packed by gzip, xz or Zstandard or not. Samples that are missing (lost in a capture, empty cells, NaN, leaps of the time
/// column) are gaps. The averaging times are 1, 2, 4 … samples.
///
/// The table has a row for each averaging time: tau_s; m, the samples in each average; the deviation in °/s and in °/h; n, the differences
/// that entered. With --json `dev` is in °/s, or whatever --scale makes of it.
#[derive(Args, Debug)]
pub struct AllanArgs {
    /// The log.
    #[arg(value_name = "FILE")]
    file: PathBuf,

    #[command(flatten)]
    column: ColumnArgs,

    /// The statistic.
    #[arg(long, value_enum, default_value = "oadev")]
    stat: Stat,

    /// Close up the gaps where samples are missing. This changes the result.
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
    let mut column = column::read(&args.file, &args.column)?;
    warn(&column.warnings);
    mind_gaps(args, &mut column);
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
fn mind_gaps(args: &AllanArgs, column: &mut Column) {
    let missing = column.missing();
    let seen = format!("{}: {missing} samples are missing among {}", args.file.display(), column.series.len());
    match missing {
        0 => {}
        _ if args.ignore_gaps => {
            column.close_gaps();
            warn(&[format!("{seen}; the gaps are closed up, which changes the result")]);
        }
        _ => warn(&[format!(
            "{seen}; they are gaps, and an average that lacks more than half of its samples is left out"
        )]),
    }
}

fn report(args: &AllanArgs, column: &Column) -> Result<Report> {
    let rate_hz = column.rate_hz;
    let samples = column.series.len();
    let octaves = allan::octaves(samples);
    ensure!(!octaves.is_empty(), "{}: {samples} samples are too few, at least 2 are needed", args.file.display());
    let scale = column.scale;
    let input = match &column.series {
        Series::Codes(codes) => Input::Codes { codes, gaps: &column.gaps },
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
