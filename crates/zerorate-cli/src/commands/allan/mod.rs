//! `zerorate allan`: the Allan deviation of a sensor at rest over the averaging time.

mod imu_yaml;
mod pool;
mod table;
pub mod temperature;
pub mod warnings;

use crate::column::ColumnArgs;
use crate::exit::{CodedRefusal, Usage};
use crate::output::{Outputs, StagedOutput, command_line, print, print_json, print_lines, say, warn};
use crate::picture::Pictures;
use anyhow::Result;
use clap::{Args, ValueEnum};
use pool::PoolReport;
use serde::Serialize;
use std::path::PathBuf;
use std::slice;
use temperature::TemperatureArgs;
use zerorate_allan::{FitOptions, Options, Stat, Taus};
use zerorate_imu::{AllanReport, AnalysisOptions, AxisReport, MotionReport, Record, Rejection};
use zerorate_jobs::allan::{AllanOptions, allan};
use zerorate_jobs::pool::Pool;
use zerorate_logs::{ColumnOptions, RowFilter};
use zerorate_view::noise::{are_axes, removed, svg};
use zerorate_view::report::{AllanPage, allan_page};

/// Compute the Allan deviation of a log at rest, and fit a noise model
///
/// The log is a capture or the log of any other gyroscope. Supported are captures, Parquet, Arrow, NumPy (npy, npz),
/// MATLAB, HDF5, bags of ROS 1 and 2 (files and folders), logs of PX4 and ArduPilot, and text of any dialect. With
/// --raw the command reads plain binary numbers. Files may be compressed, and - reads from stdin. Missing samples
/// (lost in a capture, empty cells, NaN, jumps of the time column) are gaps: an average counts if at least half of
/// its samples are there.
///
/// The table has a row for each averaging time tau_s. m is the number of samples in an average. The deviation has the
/// limits of its confidence interval, and edf states the degrees of freedom behind them. noise names the noise that
/// dominates there, and n counts the terms that entered. Rows that cannot be computed are listed with the reason. With
/// --fit the noise coefficients follow, each with its 95 % interval, and advice on averaging and recording.
#[derive(Args, Debug)]
pub struct AllanArgs {
    /// The logs; several are compared.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,

    #[arg(long, default_value = "oadev", help = statistics(), help_heading = "Deviations")]
    stat: Stat,

    /// The averaging times: octave, fine, decade, log:N, all, or a list in seconds such as 0.1,1,10 [default: octave,
    /// in pictures fine].
    ///
    /// fine has four to an octave, decade has 1, 2, 4, 10 … samples, log:N has N times at even steps of the logarithm.
    #[arg(long, help_heading = "Deviations")]
    taus: Option<Taus>,

    /// The content of the column: the rate, or its integral, the phase (the angle).
    #[arg(long, value_enum, default_value = "rate", help_heading = "Deviations")]
    data: Data,

    /// The probability that an interval contains the true deviation.
    #[arg(long, default_value_t = 0.683, value_parser = probability, value_name = "P", help_heading = "Deviations")]
    confidence: f64,

    /// Close up the gaps where samples are missing, which changes the result.
    #[arg(long, help_heading = "Deviations")]
    ignore_gaps: bool,

    /// Fit a noise model: N (angle random walk), B (bias instability), K (rate random walk) and more.
    ///
    /// Q (quantisation), R (ramp), Gauss–Markov terms, the sensor's band and lines are added where they are
    /// significant. Glitches and steps are removed first, from the deviations too, and warnings say which. A model
    /// that is off by more than 10 % is rejected: exit code 3, as for a record that has no model.
    #[arg(long, help_heading = "Noise model")]
    fit: bool,

    /// Fit one model to all the logs, which must be of one type of sensor at rest.
    ///
    /// The likelihoods are added. The result states the spread between the records and names those that do not fit.
    /// Text, picture, page and YAML then show the common model. --json has every log as well.
    #[arg(long, help_heading = "Noise model")]
    pool: bool,

    /// Remove samples that cannot be noise (knocks, bit errors) before a fit. This is the default.
    #[arg(long, conflicts_with = "keep_glitches", help_heading = "Noise model")]
    cut_glitches: bool,

    /// Keep samples that cannot be noise.
    #[arg(long, help_heading = "Noise model")]
    keep_glitches: bool,

    /// What to do before a fit where the level jumps and stays, up to three times.
    #[arg(long, value_enum, default_value = "remove", help_heading = "Noise model")]
    steps: Steps,

    /// The frequency up to which the noise model holds, Hz [default: the data choose].
    ///
    /// Above it the sensor's filter shapes the noise, and the Allan deviation is that of the measured spectrum.
    #[arg(long, value_parser = frequency, value_name = "HZ", help_heading = "Noise model")]
    max_freq: Option<f64>,

    #[command(flatten)]
    temperature: TemperatureArgs,

    /// Draw the deviations with their intervals, the fit with its band, and the averaging times of AN-1042 (.svg,
    /// .png).
    #[arg(long, value_name = "PICTURE", help_heading = "Result")]
    plot: Vec<PathBuf>,

    /// Write one self-contained HTML page with pictures, tables, coefficients and advice.
    #[arg(long, value_name = "PAGE", help_heading = "Result")]
    report: Option<PathBuf>,

    /// Write N and K as Kalibr, VINS and OpenVINS read them (imu.yaml). Several logs give their largest values.
    #[arg(long, value_name = "YAML", help_heading = "Result")]
    imu_yaml: Option<PathBuf>,

    /// Overwrite pictures, pages and YAML files that exist, but never a capture.
    #[arg(long, help_heading = "Result")]
    force: bool,

    /// Print the table as CSV.
    #[arg(long, conflicts_with = "json", help_heading = "Result")]
    csv: bool,

    /// Print the result as one JSON object. With --fit or --pool it has the noise model, and says so if the model is
    /// rejected. Without a model the coefficients are null. Both are exit code 3.
    #[arg(long, help_heading = "Result")]
    json: bool,

    #[command(flatten)]
    column: ColumnArgs,
}

fn statistics() -> String {
    let names: Vec<String> = Stat::ALL.iter().map(|stat| format!("{stat} ({})", stat.title())).collect();
    format!("The statistic: {}", names.join(", "))
}

/// The content of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Data {
    /// The rate.
    Rate,
    /// The integral of the rate over time: for a gyroscope the angle.
    Phase,
}

/// The treatment of lasting jumps of the level before a fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Steps {
    /// Keep them: a random walk has to explain them.
    Keep,
    /// Remove them.
    Remove,
}

impl AllanArgs {
    fn wants_fit(&self) -> bool {
        self.fit || self.pool || !self.plot.is_empty() || self.report.is_some() || self.imu_yaml.is_some()
    }

    fn options(&self) -> AllanOptions {
        let taus = self.taus.clone().unwrap_or(Taus::Octave);
        let deviations = Options { stat: self.stat, taus, confidence: self.confidence, scale: 1.0 };
        let draws = !self.plot.is_empty() || self.report.is_some();
        let remove_steps = self.steps == Steps::Remove;
        let fit =
            FitOptions { scale: 1.0, cut_glitches: !self.keep_glitches, remove_steps, max_freq_hz: self.max_freq };
        let analysis = AnalysisOptions {
            is_phase: self.data == Data::Phase,
            closes_gaps: self.ignore_gaps,
            deviations,
            draws_finely: draws && self.taus.is_none(),
            fit: self.wants_fit().then_some(fit),
            draws: self.report.is_some(),
            keeps_rate: self.pool,
            detrending: self.temperature.detrending(),
        };
        let (columns, log) = (self.column.columns(), self.column.options());
        AllanOptions { columns, log, temperature: self.temperature.temp_column.clone(), analysis }
    }
}

pub fn run(args: &AllanArgs) -> Result<()> {
    if args.pool {
        pool::check_statistic(args.stat)?;
    }
    args.column.check()?;
    args.temperature.check(args.pool, args.data == Data::Phase)?;
    let files = Files::claim(args)?;
    let records = records(args)?;
    check_units(args, &records)?;
    let warnings = warnings(args, &records);
    warn(&warnings);
    if args.pool {
        return pooled(args, &records, files);
    }
    // files are written first, because the reader of stdout may close the pipe early
    let written = files.write(&records, warnings);
    let printed = print_records(args, &records);
    written?;
    printed?;
    if args.fit { records.iter().try_for_each(check_model) } else { Ok(()) }
}

/// With several `--where` conditions, each log is analysed once for each condition.
fn records(args: &AllanArgs) -> Result<Vec<Record>> {
    let options = args.options();
    let [_, _, ..] = args.column.series() else { return allan(&args.files, &options) };
    let of_series = |only: &RowFilter| {
        let log = ColumnOptions { only: Some(only.clone()), ..options.log.clone() };
        let mut records = allan(&args.files, &AllanOptions { log, ..args.options() })?;
        records.iter_mut().for_each(|record| record.file = format!("{} {only}", record.file.display()).into());
        Ok(records)
    };
    let each = args.column.series().iter().map(of_series).collect::<Result<Vec<_>>>()?;
    Ok(each.into_iter().flatten().collect())
}

/// The warnings about the records. A single record has each warning in full. With several records or a list of
/// columns, warnings with the same code share a line.
fn warnings(args: &AllanArgs, records: &[Record]) -> Vec<String> {
    match records {
        [only] if !args.column.is_list() => warnings::of_motion(records).into_iter().chain(only.warnings()).collect(),
        several => {
            let of_files = several.chunk_by(|a, b| a.file == b.file);
            of_files.flat_map(warnings::of_motion).chain(warnings::condensed(several)).collect()
        }
    }
}

fn check_model(record: &Record) -> Result<()> {
    let refused = |doubt: Rejection| CodedRefusal::new(doubt.code(), format!("{}: {doubt}", record.label()));
    Ok(record.valid_model().map(drop).map_err(refused)?)
}

fn pooled(args: &AllanArgs, records: &[Record], files: Files) -> Result<()> {
    let pool = zerorate_jobs::pool::pool(records).map_err(pool::failed)?;
    warn(&pool.record.warnings());
    let written = files.write(slice::from_ref(&pool.record), Vec::new());
    let printed = print_pool(args, records, &pool);
    written?;
    printed?;
    check_model(&pool.record)
}

fn print_pool(args: &AllanArgs, records: &[Record], pool: &Pool) -> Result<()> {
    let report = AllanReport::new(&pool.record);
    if args.json {
        return print_json(&Reports { files: reports(records), pool: Some(PoolReport::new(report, pool)) });
    }
    if args.csv {
        return print(&table::csv(&[report])?);
    }
    say(table::heading(&report));
    let texts = [table::text(&report)?, table::coefficients_text(&report)?, pool::text(pool)?];
    texts.iter().try_for_each(|text| print_lines(text))
}

/// Refuses records of different quantities if a plot or a CSV table is requested, since each has only one unit.
fn check_units(args: &AllanArgs, records: &[Record]) -> Result<(), Usage> {
    let mixed = records.windows(2).find(|pair| pair[0].quantity != pair[1].quantity);
    mixed.filter(|_| args.csv || !args.plot.is_empty()).map_or(Ok(()), |pair| {
        let names = format!("{} and {} measure different quantities", pair[0].label(), pair[1].label());
        Err(Usage(format!(
            "{names}, but a picture or a CSV table has one unit: choose columns of one, or give --report alone"
        )))
    })
}

/// The requested output files. They are claimed before the logs are read, which may take long.
struct Files {
    pictures: Pictures,
    page: Option<StagedOutput>,
    imu_yaml: Option<StagedOutput>,
}

impl Files {
    fn claim(args: &AllanArgs) -> Result<Self> {
        let mut outputs = Outputs::new(args.force).printing().reading(args.files.iter().map(PathBuf::as_path))?;
        let pictures = Pictures::claim(&args.plot, &mut outputs)?;
        let mut claim = |path: &PathBuf| outputs.derived(path);
        Ok(Self {
            pictures,
            page: args.report.as_ref().map(&mut claim).transpose()?,
            imu_yaml: args.imu_yaml.as_ref().map(&mut claim).transpose()?,
        })
    }

    fn write(self, records: &[Record], warnings: Vec<String>) -> Result<()> {
        self.pictures.write(|| svg(records))?;
        if let Some(file) = self.page {
            file.fill(allan_page(&page(records, warnings))?.as_bytes())?;
        }
        if let Some(file) = self.imu_yaml {
            imu_yaml::write(file, records)?;
        }
        Ok(())
    }
}

/// The warnings about the noise of a single record are in its own section.
fn page(records: &[Record], warnings: Vec<String>) -> AllanPage<'_> {
    let title = match records {
        [first, ..] if are_axes(records) => first.file.display().to_string(),
        records => records.iter().map(Record::label).collect::<Vec<_>>().join(", "),
    };
    let warnings = if records.len() > 1 { warnings } else { warnings::of_motion(records) };
    let (title, command) = (format!("Allan analysis of {title}"), command_line());
    AllanPage { title, command, warnings, records, ..AllanPage::default() }
}

/// The JSON report of a list of columns.
#[derive(Serialize)]
struct AxesReport {
    axes: Vec<AxisReport>,
    motion: Vec<MotionReport>,
    /// The warnings about the axes together. Each axis has its own.
    warnings: Vec<String>,
}

impl AxesReport {
    fn new(records: &[Record]) -> Self {
        let of_files = || records.chunk_by(|a, b| a.file == b.file);
        Self {
            axes: records.iter().map(|record| AxisReport::new(record, None)).collect(),
            motion: of_files().flat_map(MotionReport::all).collect(),
            warnings: of_files().flat_map(warnings::of_motion).collect(),
        }
    }
}

/// The JSON report of several logs, with their common model if requested.
#[derive(Serialize)]
struct Reports {
    files: Vec<AllanReport>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pool: Option<PoolReport>,
}

/// The reports of logs with one column each, with the warnings about motion.
fn reports(records: &[Record]) -> Vec<AllanReport> {
    let of_record = |record: &Record| {
        let report = AllanReport::new(record);
        let warnings = [warnings::of_motion(slice::from_ref(record)), report.warnings].concat();
        AllanReport { warnings, ..report }
    };
    records.iter().map(of_record).collect()
}

fn print_records(args: &AllanArgs, records: &[Record]) -> Result<()> {
    if args.json && args.column.is_list() {
        return print_json(&AxesReport::new(records));
    }
    let files = reports(records);
    match &*files {
        [only] if args.json => print_json(only),
        _ if args.json => print_json(&Reports { files, pool: None }),
        _ if args.csv => print(&table::csv(&files)?),
        _ => files.iter().try_for_each(|report| {
            match files.len() {
                1 => say(table::heading(report)),
                _ => print_lines(&format!("{}\n", table::heading(report)))?,
            }
            removed(report).iter().for_each(say);
            print_lines(&table::text(report)?)?;
            if args.fit { print_lines(&table::coefficients_text(report)?) } else { Ok(()) }
        }),
    }
}

fn frequency(text: &str) -> Result<f64, String> {
    let above_zero = |value: &f64| *value > 0.0 && value.is_finite();
    text.parse().ok().filter(above_zero).ok_or_else(|| "must be a frequency above 0, in Hz".to_owned())
}

fn probability(text: &str) -> Result<f64, String> {
    let inside = |value: &f64| *value > 0.0 && *value < 1.0;
    text.parse().ok().filter(inside).ok_or_else(|| "must be above 0 and below 1, such as 0.683 or 0.95".to_owned())
}
