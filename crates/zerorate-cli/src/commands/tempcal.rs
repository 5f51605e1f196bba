//! `zerorate tempcal`: fits the bias of all axes over temperature, from logs of any IMU at rest.

use super::imu::axes::AxisArgs;
use super::serial::one_line;
use crate::column::{LogArgs, positive};
use crate::exit::Usage;
use crate::output::{Outputs, StagedOutput, command_line, print_json, print_lines, say, warn};
use crate::picture::Pictures;
use anyhow::Result;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use zerorate_jobs::tempcal::{Tempcal, TempcalOptions, UnitLog, tempcal};
use zerorate_view::tempcal::{
    AxisCurve, Points, TempcalPage, ardupilot, csv, over_temperature, px4, table, tempcal_page, warnings_of_axes,
};

/// Find the bias over temperature of all axes in logs of any IMU at rest
///
/// The command reads whatever `zerorate imu` reads, if it has a temperature: a table with a column in °C, a PX4 log
/// with all sensor_gyro and sensor_accel, an ArduPilot log with all IMU messages. The sensor lies still while it warms
/// or cools by at least 5 °C, best both. Several logs of one unit are fitted together, and show how much the bias
/// differs from start to start.
///
/// For each axis it prints the bias at a reference temperature, its slope, how late the bias follows the thermometer,
/// and the span of the bias before and after the correction. An accelerometer sees gravity, so of its bias only the
/// change over temperature is known.
#[derive(Args, Clone, Debug)]
pub struct TempcalArgs {
    /// The logs, all of the same unit; - reads from stdin.
    #[arg(value_name = "LOG", required = true)]
    pub logs: Vec<PathBuf>,

    /// The file to write.
    #[arg(short, long, value_name = "FILE", help_heading = "Result")]
    output: Option<PathBuf>,

    /// The form of that file.
    #[arg(long, value_enum, default_value = "toml", requires = "output", help_heading = "Result")]
    format: Form,

    /// The temperature at which the bias is stated, °C [default: 25, or the middle of the temperatures].
    #[arg(long, value_name = "C", help_heading = "Temperature")]
    reference_c: Option<f64>,

    /// Refuse the curve of a gyroscope that is more uncertain than this anywhere in the log (one standard uncertainty,
    /// °/s).
    #[arg(long, value_name = "DPS", value_parser = positive, help_heading = "Temperature")]
    max_u: Option<f64>,

    /// The column with the temperature, °C [default: the only one whose unit or name says so].
    #[arg(long, value_name = "NAME", help_heading = "Temperature")]
    temp_column: Option<String>,

    /// The serial number of the unit, for the file.
    #[arg(long, value_name = "SN", value_parser = one_line, requires = "output", help_heading = "Result")]
    serial: Option<String>,

    /// Draw means, curve and band of each axis (.svg, .png).
    #[arg(long, value_name = "PICTURE", help_heading = "Result")]
    plot: Vec<PathBuf>,

    /// Write one self-contained HTML page with numbers, curves and what they leave over temperature and time.
    #[arg(long, value_name = "PAGE", help_heading = "Result")]
    report: Option<PathBuf>,

    /// Print the result as one JSON object.
    #[arg(long, help_heading = "Result")]
    json: bool,

    /// Overwrite existing files.
    #[arg(long, help_heading = "Result")]
    force: bool,

    #[command(flatten)]
    axes: AxisArgs,

    #[command(flatten)]
    reading: LogArgs,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Form {
    /// A calibration of the gyroscopes, which `zerorate correct`, `zerorate export` and Python take.
    Toml,
    /// Parameters of PX4: TC_Gn and TC_An of all sensors in the log.
    Px4,
    /// Parameters of ArduPilot: INS_TCALn of all IMUs in the log.
    Ardupilot,
    /// A table of all curves: axis, temperature, bias, uncertainty.
    Csv,
}

impl Form {
    /// The usual file extensions of the format, and its description.
    fn row(self) -> (&'static [&'static str], &'static str) {
        match self {
            Self::Toml => (&["toml"], "(a calibration of the gyroscopes)"),
            Self::Px4 => (&["params"], "for PX4"),
            Self::Ardupilot => (&["parm", "param"], "for ArduPilot"),
            Self::Csv => (&["csv"], "(all curves)"),
        }
    }

    fn name(self) -> String {
        self.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
    }
}

fn check_ending(args: &TempcalArgs) -> Result<()> {
    let Some(ending) = args.output.as_ref().and_then(|path| path.extension()?.to_str()) else { return Ok(()) };
    let is_of = |form: &&Form| form.row().0.contains(&ending);
    match Form::value_variants().iter().find(is_of) {
        Some(other) if *other != args.format => {
            let (given, name) = (args.format.name(), other.name());
            Err(Usage(format!("-o: .{ending} is the ending of --format {name}, and the form is {given}; give either"))
                .into())
        }
        _ => Ok(()),
    }
}

#[derive(Serialize)]
struct Report<'a> {
    axes: &'a [AxisCurve],
    warnings: &'a [String],
}

/// The name of the part in every calibration that this command writes.
const PART: &str = "gyroscope";

pub fn run(args: &TempcalArgs) -> Result<()> {
    let logs: Vec<&Path> = args.logs.iter().map(PathBuf::as_path).collect();
    let mut outputs = Outputs::new(args.force).printing().reading(logs)?;
    check_ending(args)?;
    let codes = args.axes.codes.options(&mut outputs)?;
    let file = args.output.as_ref().map(|path| outputs.derived(path)).transpose()?;
    let page = args.report.as_ref().map(|path| outputs.derived(path)).transpose()?;
    let pictures = Pictures::claim(&args.plot, &mut outputs)?;
    if args.reading.only.len() > 1 {
        return Err(Usage("--where: tempcal takes one; run it once for each".to_owned()).into());
    }
    let options = TempcalOptions {
        axes: args.axes.options(&args.reading),
        codes,
        temperature: args.temp_column.clone(),
        reference_c: args.reference_c,
        max_u_dps: args.max_u,
    };
    let logs: Vec<UnitLog> = args.logs.iter().cloned().map(UnitLog::File).collect();
    let found = tempcal(&logs, &options)?;
    let text = args.output.as_ref().map(|_| self::text(args, &logs, &found)).transpose()?;
    let drawn = pictures.write(|| over_temperature(&found.axes.iter().zip(&found.points).collect::<Vec<_>>()));
    let written = drawn.and_then(|()| write(args, &found, page, file.zip(text)));
    let Tempcal { axes, notes, .. } = &found;
    let printed = if args.json { print_json(&Report { axes, warnings: notes }) } else { print_lines(&table(axes)) };
    warn(&[&notes[..], &warnings_of_axes(axes)].concat());
    if let (Ok(()), Some(path)) = (&written, &args.output) {
        say(format_args!("wrote {} {}", path.display(), args.format.row().1));
    }
    written?;
    printed
}

fn text(args: &TempcalArgs, logs: &[UnitLog], found: &Tempcal) -> Result<String> {
    Ok(match args.format {
        Form::Csv => csv(&found.axes),
        Form::Px4 => px4(&found.axes).map_err(|why| Usage(why.0))?,
        Form::Ardupilot => ardupilot(&found.axes).map_err(|why| Usage(why.0))?,
        Form::Toml => found.calibration(PART, args.serial.clone(), logs)?.to_toml(),
    })
}

fn write(
    args: &TempcalArgs,
    found: &Tempcal,
    page: Option<StagedOutput>,
    file: Option<(StagedOutput, String)>,
) -> Result<()> {
    if let Some(page) = page {
        page.fill(self::page(args, &found.axes, &found.points, &found.notes)?.as_bytes())?;
    }
    file.map_or(Ok(()), |(file, text)| Ok(file.fill(text.as_bytes())?))
}

fn page(args: &TempcalArgs, axes: &[AxisCurve], points: &[Points], warnings: &[String]) -> Result<String> {
    let logs = args.logs.iter().map(|log| log.display().to_string()).collect::<Vec<_>>().join(", ");
    let title = format!("Bias over temperature in {logs}");
    tempcal_page(TempcalPage { title, command: command_line(), warnings, axes, points })
}
