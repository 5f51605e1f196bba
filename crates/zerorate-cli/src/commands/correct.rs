//! `zerorate correct`: corrects a capture and keeps its raw columns, or corrects the gyroscope of a log.

use super::imu::axes::option;
use super::serial::{self, one_line};
use crate::column::{LogArgs, UNITS, listed, positive};
use crate::exit::Usage;
use crate::interrupt;
use crate::output::{Outputs, say, warn};
use crate::part::PartArgs;
use crate::wording::{coded, flag, form};
use anyhow::{Context, Error, Result, anyhow, bail};
use clap::Args;
use std::io::{BufWriter, ErrorKind};
use std::path::{Path, PathBuf};
use zerorate::{Calibration, Wording};
use zerorate_imu::{ImuOptions, KindOptions};
use zerorate_input::limits;
use zerorate_jobs::JobWarning;
use zerorate_jobs::code_scales::CodeOptions;
use zerorate_jobs::correct::Job;
use zerorate_jobs::tempcal::{CorrectedLog, TempcalOptions, UnitLog};
use zerorate_logs::{Names, Unit};
use zerorate_record::{CaptureInfo, Format};
use zerorate_view::SessionWarning;

/// Correct a recorded file with a calibration
///
/// The corrected rate is RATE + PBC + d · BTC, with d = TEMP − T3, and + d² · BTC2 + d³ · BTC3 where the calibration
/// has these terms.
///
/// The result keeps all raw columns and adds rate_dps, temp_c, rate_corrected_dps and flags. For a part with several
/// axes these are NAME_dps, NAME_corrected_dps and NAME_flags of each axis. Impossible readings (bit errors), readings
/// out of range and readings of a sensor that had stopped are flagged and have no corrected rate. A row without a
/// temperature takes the last temperature before it. The result carries the id of the calibration and is never
/// corrected again.
///
/// A calibration of `zerorate tempcal` corrects the gyroscope of any log of that unit. The result is a table (.csv)
/// with t_s at the mean rate, temp_c, and NAME_dps and NAME_corrected_dps of each axis. The correction follows the
/// temperature with the lag of the calibration; at the start of the log, the sensor counts as warmed through.
#[derive(Args, Debug)]
pub struct CorrectArgs {
    /// The capture, in any form, or the log.
    #[arg(value_name = "CAPTURE|LOG")]
    pub capture: PathBuf,

    /// The calibration file.
    #[arg(long, value_name = "FILE")]
    cal: PathBuf,

    /// The file to write.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// The serial number of the sensor, where the capture does not state it.
    #[arg(long, value_name = "SN", value_parser = one_line)]
    serial: Option<String>,

    /// The form of the file [default: as its ending states, or arrows without an ending].
    #[arg(long, value_enum)]
    format: Option<Format>,

    #[command(flatten)]
    part: PartArgs,

    /// Overwrite an existing file, and only warn where the calibration has another serial number.
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    log: LoggedArgs,
}

/// Options for facts that a log does not state. They have the same names as in `zerorate tempcal`.
#[derive(Args, Debug, Default, PartialEq)]
struct LoggedArgs {
    /// The columns of the gyroscope, by name or by number from 0, in the order of the calibration's axes, if their
    /// names differ from these.
    #[arg(long, value_name = "LIST", help_heading = UNITS)]
    gyro: Option<String>,

    /// The unit of the gyroscope's columns [default: the one that their names state].
    #[arg(long, value_name = "UNIT", help_heading = UNITS)]
    gyro_unit: Option<Unit>,

    /// The size of a step of 1 in the gyroscope's columns, in their unit, such as 1/131.
    #[arg(long, value_name = "X", value_parser = positive, requires = "gyro_unit", help_heading = UNITS)]
    gyro_scale: Option<f64>,

    /// The column with the temperature, °C [default: the only one whose unit or name says so].
    #[arg(long, value_name = "NAME", help_heading = UNITS)]
    temp_column: Option<String>,

    #[command(flatten)]
    reading: LogArgs,
}

pub fn run(args: &CorrectArgs) -> Result<()> {
    let mut outputs = Outputs::new(args.force);
    let calibration = load(&args.cal, &mut outputs)?;
    if calibration.is_of_logs() {
        return log(args, &calibration, outputs);
    }
    if args.log != LoggedArgs::default() {
        let what = "corrects captures; options of logs need a calibration of `zerorate tempcal`";
        return Err(Usage(format!("{} {what}", args.cal.display())).into());
    }
    let reader = outputs.capture(&args.capture)?;
    let part = args.part.of(reader.info(), &mut outputs)?;
    let job = Job::new(&args.capture, reader, &part, &calibration)?;
    check_serial(args, job.info(), &calibration)?;
    let format = form(args.format, &args.output)?;
    interrupt::listen();
    let output = outputs.derived(&args.output)?;
    let name = args.capture.display();
    let rows = job.run(output, format, interrupt::stop(), flag, &mut |warning| match warning {
        of_file @ JobWarning::Source(_) => warn(&[coded(of_file)]),
        other => warn(&[format!("{}: {name}: {}", other.code(), other.with(flag))]),
    })?;
    say(format_args!("{}: {rows} samples, corrected with calibration {}", args.output.display(), calibration.id()));
    Ok(())
}

/// Corrects the gyroscope of a log.
fn log(args: &CorrectArgs, calibration: &Calibration, outputs: Outputs) -> Result<()> {
    let is_csv = args.output.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("csv"));
    if args.format.map_or(!is_csv, |format| format != Format::Csv) {
        return Err(Usage("a corrected log is a table: give -o a name that ends in .csv".to_owned()).into());
    }
    let (log_name, serial) = (args.capture.display().to_string(), args.serial.as_deref());
    if serial.is_some()
        && let Err(mismatch) = serial::check(calibration, &args.cal, (&log_name, serial))
    {
        if !args.force {
            bail!("{mismatch} (--force corrects nevertheless)");
        }
        warn(&[mismatch]);
    }
    let LoggedArgs { gyro, gyro_unit, gyro_scale, temp_column, reading } = &args.log;
    if reading.only.len() > 1 {
        return Err(Usage("--where: correct takes one; run it once for each".to_owned()).into());
    }
    let columns = gyro.as_deref().and_then(listed).unwrap_or_default();
    let options = TempcalOptions {
        axes: ImuOptions {
            columns: None,
            gyro: KindOptions { columns, unit: *gyro_unit, scale: *gyro_scale, codes: None },
            accel: KindOptions::default(),
            log: reading.options(Names(option)),
            more_topics: reading.more_topics().to_vec(),
        },
        codes: CodeOptions::default(),
        temperature: temp_column.clone(),
        reference_c: None,
        max_u_dps: None,
    };
    let mut outputs = outputs.reading([args.capture.as_path()])?;
    let output = outputs.derived(&args.output)?;
    let corrected = CorrectedLog::new(&UnitLog::File(args.capture.clone()), &options, calibration)?;
    let written = corrected.write_csv(&mut BufWriter::new(output.file()?));
    written.with_context(|| format!("cannot write {}", args.output.display()))?;
    output.publish()?;
    warn(&corrected.notes);
    let (file, rows) = (args.output.display(), corrected.rows());
    warn(&of_axes(calibration));
    warn(&corrected.warnings.into_iter().map(coded).collect::<Vec<_>>());
    say(format_args!("{file}: {rows} samples, corrected with calibration {}", calibration.id()));
    Ok(())
}

/// The warnings that a calibration holds about its axes, without repetitions.
fn of_axes(calibration: &Calibration) -> Vec<String> {
    let mut all: Vec<String> = calibration.axes.iter().flat_map(|axis| axis.warnings.clone()).collect();
    all.sort();
    all.dedup();
    all
}

/// Reads a calibration and prints the warnings about its file.
pub(super) fn load(path: &Path, outputs: &mut Outputs) -> Result<Calibration> {
    let name = path.display();
    let text = outputs.try_text(path, limits::TEXT)?.map_err(|error| match error.kind() {
        ErrorKind::InvalidData => other_file(path),
        ErrorKind::FileTooLarge => anyhow!("{}; {error}", other_file(path)),
        _ => Error::from(error).context(format!("cannot read {name}")),
    })?;
    let (calibration, warnings) = Calibration::parse(&text).map_err(|error| {
        match text.contains("correction]") || Calibration::is_begun_by(&text) {
            true => Error::from(error).context(name.to_string()),
            false => other_file(path),
        }
    })?;
    let of_file = |warning| coded(SessionWarning::OfCalibration { cal: name.to_string(), warning });
    warn(&warnings.into_iter().map(of_file).collect::<Vec<_>>());
    Ok(calibration)
}

/// The error for a log or another file that was given as a calibration.
fn other_file(path: &Path) -> Error {
    anyhow!(
        "{} is not a calibration file: give the TOML file that `zerorate calibrate -o` writes, or `tempcal -o` for \
         logs",
        path.display()
    )
}

fn check_serial(args: &CorrectArgs, info: &CaptureInfo, calibration: &Calibration) -> Result<()> {
    let name = args.capture.display().to_string();
    let serial = match (info.serial.as_deref(), args.serial.as_deref()) {
        (Some(recorded), Some(given)) if recorded != given => {
            return Err(Usage(format!("{name} states that its part is {recorded}; leave out --serial {given}")).into());
        }
        (recorded, given) => recorded.or(given),
    };
    match serial::check(calibration, &args.cal, (&name, serial)) {
        Err(mismatch) if args.force => warn(&[mismatch]),
        Err(mismatch) => bail!("{mismatch} (--force corrects nevertheless)"),
        Ok(doubt) => warn(doubt.map(coded).as_slice()),
    }
    Ok(())
}
