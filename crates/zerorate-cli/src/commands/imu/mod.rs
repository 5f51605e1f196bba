//! `zerorate imu`: the log of an IMU at rest becomes the noise that a filter takes.

mod datasheet;
mod json;
mod text;

use super::allan::temperature::TemperatureArgs;
use super::allan::units::span;
use super::allan::{findings, motion, page};
use crate::column::{flag, listed, share};
use crate::exit::{Refused, Usage};
use crate::output::{Outputs, Staged, print_json, print_lines, say, warn};
use anyhow::Result;
use clap::Args;
use datasheet::Comparison;
use std::path::PathBuf;
use zerorate_allan::DataSheet;
use zerorate_allan::{FitOptions, Options};
use zerorate_host::files;
use zerorate_jobs::analysis::{AnalysisOptions, Record};
use zerorate_jobs::temperature;
use zerorate_logs::imu::{Axes, Axis, Choice, Combine, Format, ImuOptions, Kind, Numbers, Said};
use zerorate_logs::{Column, ColumnOptions, Decimal, LogWarning, Names, Setting, TimeUnit, Unit};
use zerorate_view::report::Fact;

/// Fits noise models to all axes of an IMU's log, taken at rest, and writes the file for the filter that will use
/// them.
///
/// Reads the log once: a sensor_msgs/Imu topic of a bag, or the columns whose names and units say what they are, in
/// any form that `zerorate allan` reads. Gravity is no error: a mean does not matter. Each number in the file says in
/// a comment which coefficient of which axis it is; where the random walk K is not identified, it is the upper end of
/// its 95 % interval. Which number goes where, and why: docs/imu.md.
///
/// Where a model is rejected (exit code 3), or a record is too short for one, there is no file.
#[derive(Args, Debug)]
pub struct ImuArgs {
    /// The log; - is what is piped in.
    #[arg(value_name = "LOG")]
    pub log: PathBuf,

    /// The file to be written.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Who reads that file.
    #[arg(long, value_enum, default_value = "kalibr", ignore_case = true)]
    format: Format,

    /// What stands for all axes of a kind, where the reader takes one number.
    #[arg(long, value_enum, default_value = "worst")]
    combine: Combine,

    /// Multiply all noise by F, for what a record at rest does not show: vibration, temperature, scale errors. Filters
    /// are often tuned with 5 to 20.
    #[arg(long, value_name = "F", default_value_t = 1.0, value_parser = factor)]
    inflate: f64,

    /// The topic of a bag or of a PX4 log, where it has several IMUs.
    #[arg(long, value_name = "TOPIC")]
    topic: Option<String>,

    /// The columns, by name or number counted from 0, as in gx,gy,gz,ax,ay,az [default: all that are axes].
    #[arg(long, value_name = "LIST")]
    column: Option<String>,

    /// Samples per second [default: as the log's stamps or its time column tell].
    #[arg(long, value_name = "HZ", value_parser = factor)]
    rate: Option<f64>,

    /// The column with the time of each row [default: the only one whose name states a unit of time, as in t_ns].
    #[arg(long, value_name = "NAME|INDEX", conflicts_with = "rate")]
    time_column: Option<String>,

    /// The unit of the time column [default: the one that its name or type states].
    #[arg(long, value_enum, requires = "time_column")]
    time_unit: Option<TimeUnit>,

    /// What stands before the decimals in a text file [default: a point, or a comma where it can be nothing else].
    #[arg(long, value_enum, value_name = "MARK")]
    decimal: Option<Decimal>,

    /// Broken lines of a text file that are skipped and counted, as a share of all [default: 0.01].
    #[arg(long, value_name = "SHARE", value_parser = share)]
    max_bad: Option<f64>,

    /// The unit of the gyroscope's columns: dps, rad/s, deg/h … [default: the one that their names state].
    #[arg(long, value_name = "UNIT")]
    gyro_unit: Option<Unit>,

    /// The unit of the accelerometer's columns: m/s², g, mg or µg [default: the one that their names state].
    #[arg(long, value_name = "UNIT")]
    accel_unit: Option<Unit>,

    /// What a step of 1 in the gyroscope's columns is, in its unit.
    #[arg(long, value_name = "X", value_parser = factor, requires = "gyro_unit")]
    gyro_scale: Option<f64>,

    /// What a step of 1 in the accelerometer's columns is, in its unit.
    #[arg(long, value_name = "X", value_parser = factor, requires = "accel_unit")]
    accel_scale: Option<f64>,

    #[command(flatten)]
    temperature: TemperatureArgs,

    /// Write one self-contained HTML page: coefficients by axis, and for each kind its curves, spectra and records.
    #[arg(long, value_name = "PAGE")]
    report: Option<PathBuf>,

    /// Compare with the noise that a data sheet states: a TOML file as in docs/formats/datasheet.md.
    #[arg(long, value_name = "TOML")]
    datasheet: Option<PathBuf>,

    /// Print the result as one JSON object.
    #[arg(long)]
    json: bool,

    /// Overwrite files that exist, and write a file of numbers that are no result; it says so inside.
    #[arg(long)]
    force: bool,
}

impl ImuArgs {
    /// What the log may not say of itself.
    fn options(&self) -> ImuOptions {
        ImuOptions {
            columns: self.column.as_deref().and_then(listed),
            gyro: Said { unit: self.gyro_unit, scale: self.gyro_scale },
            accel: Said { unit: self.accel_unit, scale: self.accel_scale },
            log: ColumnOptions {
                topic: self.topic.clone(),
                rate: self.rate,
                time_column: self.time_column.clone(),
                time_unit: self.time_unit,
                decimal: self.decimal,
                max_bad: self.max_bad,
                names: Names(option),
                ..ColumnOptions::default()
            },
        }
    }
}

/// What the options are called here: a unit and a scale are of a kind, and plain numbers have no axes.
fn option(setting: Setting) -> &'static str {
    match setting {
        Setting::Unit => "--gyro-unit or --accel-unit",
        Setting::Scale => "--gyro-scale or --accel-scale",
        Setting::Raw => "`zerorate allan --raw`",
        other => flag(other),
    }
}

pub fn run(args: &ImuArgs) -> Result<()> {
    let mut outputs = Outputs::new(args.force).printing().reading([&*args.log])?;
    let sheet = args.datasheet.as_deref().map(|path| datasheet::read(path, &mut outputs)).transpose()?;
    let file = args.output.as_ref().map(|path| outputs.derived(path)).transpose()?;
    let page = args.report.as_ref().map(|path| outputs.derived(path)).transpose()?;
    let Axes { columns, topic, warnings } = Axes::read(&args.log, files::log(&args.log)?, &args.options())?;
    check_format(args, &columns)?;
    let of_log: Vec<String> = warnings.iter().map(LogWarning::coded).chain(absent(args, &columns)).collect();
    let (fit, draws) = (Some(FitOptions::default()), page.is_some());
    let options = AnalysisOptions {
        is_phase: false,
        closes_gaps: false,
        deviations: Options::default(),
        draws_finely: draws,
        fit,
        draws,
        keeps_rate: false,
        settling: args.temperature.settling(),
    };
    let log = args.options().log;
    let temperature = args.temperature.read(&args.log, |names| temperature::named(&args.log, names, &log))?;
    let analyse = |column| Record::of(column, &args.log, &options, temperature.as_ref());
    let axes: Vec<Record> = columns.into_iter().map(analyse).collect::<Result<_>>()?;
    let compared = sheet.as_ref().map(|sheet| datasheet::compare(sheet, &axes)).unwrap_or_default();
    if args.json {
        print_json(&json::Report::new((topic.as_deref(), &of_log), &axes, sheet.as_ref(), &compared))?;
    } else {
        print_lines(&text::table(&axes)?)?;
        sheet.as_ref().map_or(Ok(()), |sheet| print_lines(&text::comparison(&datasheet::table(sheet, &compared))))?;
    }
    let findings = motion::lines(&axes).into_iter().chain(findings::condensed(&axes));
    let warnings: Vec<String> = findings.chain(of_log).collect();
    warn(&warnings);
    if let Some(page) = page {
        page::write(page, head(args, &axes, topic.as_deref(), sheet.as_ref(), &compared, warnings), &axes)?;
    }
    deliver(args, &axes, topic, file)
}

/// What the page says of the log as a whole.
fn head(
    args: &ImuArgs,
    axes: &[Record],
    topic: Option<&str>,
    sheet: Option<&DataSheet>,
    compared: &[Comparison<'_>],
    warnings: Vec<String>,
) -> page::Head {
    let log = args.log.display().to_string();
    let of_axis = axes.first().map(|axis| {
        let (samples, rate_hz) = (axis.analysis.samples, axis.analysis.rate_hz);
        [
            Fact::new("samples", samples.to_string()),
            Fact::new("sample rate", format!("{rate_hz:.6} Hz")),
            Fact::new("length", span(samples as f64 / rate_hz)),
        ]
    });
    let topic = topic.map(|topic| Fact::new("topic", topic));
    page::Head {
        title: format!("Noise of the IMU in {log}"),
        facts: topic.into_iter().chain(of_axis.into_iter().flatten()).collect(),
        warnings,
        tables: sheet.map(|sheet| datasheet::table(sheet, compared)).into_iter().collect(),
    }
}

/// Writes the file, if its numbers are results or were asked for nonetheless.
fn deliver(args: &ImuArgs, axes: &[Record], topic: Option<String>, file: Option<Staged>) -> Result<()> {
    let doubts = doubts(axes);
    if !doubts.is_empty() {
        let doubted = axes.iter().find(|axis| axis.believed().is_err());
        let code = doubted.map_or("no-model", Record::doubt_code);
        let refused = Refused::new(code, format!("{}: {}", args.log.display(), doubts.join("; ")));
        if !args.force || axes.iter().any(|axis| axis.model().is_none()) {
            return Err(refused.into());
        }
        say(format_args!("warning: {refused}; written all the same (--force)"));
    }
    let Some(file) = file else { return Ok(()) };
    let ImuArgs { combine, inflate, .. } = *args;
    let names = Names(option);
    let choice = Choice { log: args.log.display().to_string(), topic, combine, inflate, doubts, names };
    let axes: Vec<Axis<'_>> = axes.iter().filter_map(Record::axis).collect();
    file.fill(args.format.text(&Numbers::new(choice, &axes)).as_bytes())?;
    if let Some(path) = &args.output {
        let chosen = match args.format.is_by_axis() {
            true => "each axis by itself".to_owned(),
            false => format!("of the axes of a kind {}", combine.words(Names(option))),
        };
        say(format_args!("wrote {} for {}: {chosen}", path.display(), args.format.reader()));
    }
    Ok(())
}

/// Why there is no result, each reason with the axes that have it.
fn doubts(axes: &[Record]) -> Vec<String> {
    let mut all: Vec<(String, Vec<&str>)> = Vec::new();
    for (axis, why) in axes.iter().filter_map(|axis| Some((axis, axis.believed().err()?))) {
        match all.iter_mut().find(|(same, _)| *same == why) {
            Some((_, names)) => names.push(&axis.column),
            None => all.push((why, vec![&axis.column])),
        }
    }
    all.into_iter().map(|(why, names)| format!("{}: {why}", names.join(", "))).collect()
}

/// What takes a number by axis needs three of a kind.
fn check_format(args: &ImuArgs, columns: &[Column]) -> Result<(), Usage> {
    for kind in Kind::ALL {
        let count = count(columns, kind);
        if args.output.is_some() && args.format.is_by_axis() && !matches!(count, 0 | 3) {
            let (format, name) = (args.format.reader(), kind.name());
            let why = format!("{format} takes three; choose three with --column, or another --format");
            let axes = if count == 1 { "axis" } else { "axes" };
            return Err(Usage(format!("{}: {count} {name} {axes}, and {why}", args.log.display())));
        }
    }
    Ok(())
}

/// The kinds that the log has nothing of.
fn absent(args: &ImuArgs, columns: &[Column]) -> impl Iterator<Item = String> {
    let none = |kind: &Kind| count(columns, *kind) == 0;
    let seen = if args.column.is_some() { "--column names no" } else { "the log has no" };
    let words = move |kind: Kind| format!("kind-absent: {seen} {}: its numbers are left to be filled in", kind.name());
    Kind::ALL.into_iter().filter(none).map(words)
}

fn count(columns: &[Column], kind: Kind) -> usize {
    columns.iter().filter(|column| column.quantity == Some(kind.quantity())).count()
}

fn factor(text: &str) -> Result<f64, String> {
    text.parse()
        .ok()
        .filter(|number: &f64| *number > 0.0 && number.is_finite())
        .ok_or_else(|| "must be a number above zero".to_owned())
}
