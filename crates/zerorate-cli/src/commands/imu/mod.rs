//! `zerorate imu`: analyses a log of an IMU at rest, and writes a noise file for a filter.

pub mod axes;
mod codes;
mod datasheet;
mod text;

use super::allan::temperature::TemperatureArgs;
use super::allan::warnings::{self, code, first_of_each};
use crate::column::{LogArgs, positive};
use crate::exit::{CodedRefusal, Usage};
use crate::output::{Outputs, StagedOutput, command_line, print_json, print_lines, say, warn};
use crate::picture::Pictures;
use anyhow::Result;
use axes::{AxisArgs, option};
use clap::Args;
use std::io::IsTerminal;
use std::path::PathBuf;
use zerorate_allan::{FitOptions, span};
use zerorate_imu::{
    AnalysisOptions, Combine, Format, ImuReport, ImuWarning, NoNoiseFile, NoiseFileOptions, Record, Rule,
};
use zerorate_jobs::code_scales::CodeOptions;
use zerorate_jobs::imu::{ImuNoise, ImuNoiseOptions, imu};
use zerorate_logs::{Condition, LogWarning, Names, RowFilter};
use zerorate_view::noise::axes_svg;
use zerorate_view::report::{AllanPage, Fact, allan_page};

/// Turn the log of an IMU at rest into the noise file of a filter, such as imu.yaml
///
/// The command reads a sensor_msgs/Imu topic of a bag, or the columns whose names and units say what they are, in any
/// form that `zerorate allan` reads. It fits a noise model to each axis. Gravity does no harm, since means do not
/// matter. A comment beside each number in the file names the axis and the coefficient. Where the random walk K is not
/// identified, the file has the upper end of its 95 % interval. docs/imu.md explains which number goes where.
///
/// Where a model is rejected (exit code 3), or a record is too short for one, no file is written.
#[derive(Args, Clone, Debug)]
pub struct ImuArgs {
    /// The log; - reads from stdin.
    #[arg(value_name = "LOG")]
    pub log: PathBuf,

    /// The file to write.
    #[arg(short, long, value_name = "FILE", help_heading = "Noise file")]
    output: Option<PathBuf>,

    /// The program that will read the file.
    #[arg(long, value_enum, default_value = "kalibr", requires = "output", help_heading = "Noise file")]
    format: Format,

    /// How to combine the axes of a kind where the reader takes one number.
    #[arg(long, value_enum, default_value = "worst", requires = "output", help_heading = "Noise file")]
    combine: Combine,

    /// The longest time over which the filter is to trust its own uncertainty, s [default: a third of the record, at
    /// most 1000 s, and at most 100 s for Kalibr].
    ///
    /// Filters know white noise N and a random walk K only. N and K are chosen so that N²/τ + K²τ/3 covers the
    /// Allan variance of the noise from 1 s to the horizon, with the least excess. The horizon is at most half of the
    /// record. Kalibr, which weighs a minute or two, gets the fitted N, and only K is lifted.
    #[arg(long, value_name = "S", value_parser = horizon, requires = "output", help_heading = "Noise file")]
    horizon: Option<f64>,

    /// Write N and K as they were fitted.
    #[arg(long, conflicts_with = "horizon", requires = "output", help_heading = "Noise file")]
    as_fitted: bool,

    /// Multiply all noise by F, to allow for errors that a record at rest does not show: vibration, temperature,
    /// scale. Filters are often tuned with 5 to 20.
    #[arg(
        long,
        value_name = "F",
        default_value_t = 1.0,
        value_parser = positive,
        requires = "output",
        help_heading = "Noise file"
    )]
    inflate: f64,

    /// Write -o also from noise models that are rejected; the file says so inside.
    #[arg(long, requires = "output", help_heading = "Noise file")]
    accept_rejected: bool,

    /// Draw the deviations of all axes, with fit and band (.svg, .png).
    #[arg(long, value_name = "PICTURE", help_heading = "Result")]
    plot: Vec<PathBuf>,

    /// Write one self-contained HTML page with coefficients by axis, curves, spectra and records.
    #[arg(long, value_name = "PAGE", help_heading = "Result")]
    report: Option<PathBuf>,

    /// Compare with the noise of a data sheet: a name of `zerorate parts`, or a TOML file
    /// (docs/formats/datasheet.md).
    #[arg(long, value_name = "PART", help_heading = "Result")]
    datasheet: Option<PathBuf>,

    /// Print the result as one JSON object.
    #[arg(long, help_heading = "Result")]
    json: bool,

    /// Overwrite existing files.
    #[arg(long, help_heading = "Result")]
    force: bool,

    #[command(flatten)]
    temperature: TemperatureArgs,

    #[command(flatten)]
    axes: AxisArgs,

    #[command(flatten)]
    reading: LogArgs,
}

impl ImuArgs {
    /// The options for one `--where`. The values of its conditions are added to file names: `imu-1.yaml`.
    fn of_series(&self, only: &RowFilter) -> Self {
        let plain = |one: &Condition| one.value.replace(|c: char| !c.is_alphanumeric(), "_");
        let value = only.conditions.iter().map(plain).collect::<Vec<_>>().join("-");
        let named = |path: &PathBuf| {
            let [stem, ending] = [path.file_stem(), path.extension()].map(|part| part.unwrap_or_default().display());
            path.with_file_name(format!("{stem}-{value}.{ending}").trim_end_matches('.'))
        };
        let mut reading = self.reading.clone();
        reading.only = vec![only.clone()];
        Self {
            output: self.output.as_ref().map(named),
            plot: self.plot.iter().map(named).collect(),
            report: self.report.as_ref().map(named),
            reading,
            ..self.clone()
        }
    }

    fn options(&self, codes: CodeOptions) -> ImuNoiseOptions {
        let axes = self.axes.options(&self.reading);
        let analysis = AnalysisOptions {
            draws_finely: self.report.is_some() || !self.plot.is_empty(),
            fit: Some(FitOptions::default()),
            draws: self.report.is_some(),
            detrending: self.temperature.detrending(),
            ..AnalysisOptions::default()
        };
        let format = self.output.is_some().then_some(self.format);
        ImuNoiseOptions { axes, codes, temperature: self.temperature.temp_column.clone(), analysis, format }
    }
}

fn horizon(text: &str) -> Result<f64, String> {
    let is_long = |value: &f64| *value > 1.0 && value.is_finite();
    text.parse().ok().filter(is_long).ok_or_else(|| "must be more than 1, in seconds".to_owned())
}

pub fn run(args: &ImuArgs) -> Result<()> {
    match &args.reading.only[..] {
        [] | [_] => run_one(args),
        _ if args.json => Err(Usage("--json takes one --where: run it once for each".to_owned()).into()),
        several => several.iter().try_for_each(|only| {
            print_lines(&format!("{only}\n"))?;
            run_one(&args.of_series(only))
        }),
    }
}

fn run_one(args: &ImuArgs) -> Result<()> {
    let mut outputs = Outputs::new(args.force).printing().reading([&*args.log])?;
    let sheet = args.datasheet.as_deref().map(|path| datasheet::read(path, &mut outputs)).transpose()?;
    let codes = args.axes.codes.options(&mut outputs)?;
    let file = args.output.as_ref().map(|path| outputs.derived(path)).transpose()?;
    let page = args.report.as_ref().map(|path| outputs.derived(path)).transpose()?;
    let pictures = Pictures::claim(&args.plot, &mut outputs)?;
    let ImuNoise { axes, topic, notes, absent } = imu(&args.log, &args.options(codes))?;
    let absent = absent.iter().map(ImuWarning::coded);
    let of_log: Vec<String> = notes.iter().map(LogWarning::coded).chain(absent).collect();
    let motion = warnings::of_motion(&axes);
    let report = ImuReport::new(&axes, topic.as_deref(), &[&of_log[..], &motion].concat(), sheet.as_ref());
    let (doubts, remarks): (Vec<_>, Vec<_>) = of_log.iter().cloned().partition(|line| DOUBTS.contains(&code(line)));
    let findings: Vec<String> = motion.into_iter().chain(warnings::condensed(&axes)).collect();
    let with = |doubts: &[String]| [doubts, &findings, &remarks].concat();
    // files are written first, because the reader of stdout may close the pipe early
    let drawn = pictures.write(|| axes_svg(&axes));
    let written =
        page.map_or(Ok(()), |file| Ok(file.fill(allan_page(&self::page(&report, &axes, with(&doubts)))?.as_bytes())?));
    let mattering = NoiseFileOptions::mattering(with(&first_of_each(&doubts)));
    let written = drawn.and(written).and_then(|()| deliver(args, &axes, (topic.clone(), mattering), file));
    let printed = if args.json {
        print_json(&report)
    } else {
        let compared = datasheet::table(&report).as_ref().map(text::comparison);
        print_lines(&(text::table(&report)? + &compared.unwrap_or_default()))
    };
    warn(&at_most(LINES, &with(&first_of_each(&doubts))));
    written?.iter().for_each(say);
    if args.output.is_none() && !args.json && std::io::stderr().is_terminal() {
        say("no noise file was written; -o imu.yaml writes the one of Kalibr, and --format names others");
    }
    printed
}

/// Largest number of lines of warnings on stderr.
const LINES: usize = 8;

/// Codes of warnings about the samples themselves. These warnings come first, since they may explain the others.
const DOUBTS: [&str; 8] = [
    "implausible",
    "rate-contradicts",
    "scale-unused",
    "scale-assumed",
    "codes-unsigned",
    "clipped",
    "resampled",
    "frozen",
];

/// Limits the warnings to this number of lines. If there are more, the last line lists the codes of the others.
fn at_most(lines: usize, warnings: &[String]) -> Vec<String> {
    if warnings.len() <= lines {
        return warnings.to_vec();
    }
    let (shown, rest) = warnings.split_at(lines - 1);
    let codes: Vec<&str> = rest.iter().map(|warning| code(warning)).collect();
    let more = format!("{} more: {}; --json or --report has them", rest.len(), codes.join(", "));
    shown.iter().cloned().chain([more]).collect()
}

fn page<'a>(report: &ImuReport, records: &'a [Record], warnings: Vec<String>) -> AllanPage<'a> {
    let log = report.axes.first().map_or("", |axis| &axis.report.file);
    let topic = report.topic.as_deref().map(|topic| Fact::new("topic", topic));
    let of_axes = [
        Fact::new("samples", report.samples.to_string()),
        Fact::new("sample rate", format!("{:.6} Hz", report.rate_hz)),
        Fact::new("length", span(report.samples as f64 / report.rate_hz)),
    ];
    AllanPage {
        title: format!("Noise of the IMU in {log}"),
        command: command_line(),
        facts: topic.into_iter().chain(of_axes).collect(),
        warnings,
        tables: datasheet::table(report).into_iter().collect(),
        records,
    }
}

/// Writes the requested noise file. Refuses a missing model, and a rejected one without consent. Returns lines to say.
fn deliver(
    args: &ImuArgs,
    axes: &[Record],
    (topic, warnings): (Option<String>, Vec<String>),
    file: Option<StagedOutput>,
) -> Result<Vec<String>> {
    let doubts = Record::doubts(axes);
    let mut lines = Vec::new();
    if let Some(code) = doubts.code() {
        let refused = CodedRefusal::new(code, format!("{}: {doubts}", args.log.display()));
        if !doubts.allow(args.accept_rejected) {
            return Err(refused.into());
        }
        lines.push(format!("warning: {refused}; written all the same (--accept-rejected)"));
    }
    let Some((file, path)) = file.zip(args.output.as_ref()) else { return Ok(lines) };
    let ImuArgs { combine, inflate, .. } = *args;
    let rule = if args.as_fitted { Rule::AsFitted } else { Rule::Covers(args.horizon) };
    let (log, names) = (args.log.display().to_string(), Names(option));
    let choice = NoiseFileOptions { log, topic, combine, rule, inflate, names, warnings };
    let not_written = |why: NoNoiseFile| Usage(format!("{}: {why}", args.log.display()));
    let text = args.format.file(choice, &Record::axes(axes), &doubts, args.accept_rejected).map_err(not_written)?;
    file.fill(text.as_bytes())?;
    let chosen = match args.format.is_by_axis() {
        true => "each axis by itself".to_owned(),
        false => format!("of the axes of a kind {}", combine.words(Names(option))),
    };
    lines.push(format!("wrote {} for {}: {chosen}", path.display(), args.format.reader()));
    Ok(lines)
}
