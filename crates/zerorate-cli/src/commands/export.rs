//! `zerorate export`: writes a calibration for firmware, as tables and integer coefficients.

use super::correct::load;
use crate::exit::Usage;
use crate::output::{Outputs, print, say, warn};
use anyhow::{Result, ensure};
use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser};
use std::path::PathBuf;
use zerorate_view::export::{Export, ExportForm, ExportWarning, InvalidOptions, Options, Prefix};

/// Export a calibration for firmware: C, Rust, CSV, JSON, PX4 or ArduPilot
///
/// The table holds the terms that are added to PBC: (TEMP − T3) · BTC and the terms of a curve, for TEMP − T3 from
/// +span down to −span. The C and Rust forms also hold integer coefficients, with a function from raw code to
/// corrected code that needs no table. They state the temperatures for which the calibration holds, and their look-up
/// says whether a temperature lies inside. Two units fit into one program under two prefixes; in Rust, two modules do
/// as well. All axes of a calibration are in one file, and their names carry the name of the axis, as in
/// zerorate_x_correct_code.
#[derive(Args, Clone, Debug)]
pub struct ExportArgs {
    /// The calibration file.
    #[arg(value_name = "CALIBRATION")]
    cal: PathBuf,

    /// The form to write.
    #[arg(long, value_parser = formats())]
    format: String,

    /// The step of the table, °C [default: 0.02; without --span-c the finest of 0.02, 0.05, 0.1, … that gives at most
    /// 1025 rows, 4.1 kB].
    #[arg(long, value_name = "C")]
    step_c: Option<f64>,

    /// The reach of the table on both sides of T3, °C [default: it covers the temperatures for which the calibration
    /// holds].
    #[arg(long, value_name = "C")]
    span_c: Option<f64>,

    /// The prefix of names in C and Rust [default: zerorate in C, none in Rust].
    #[arg(long, value_name = "NAME")]
    prefix: Option<Prefix>,

    /// The number of the gyroscope in the flight controller: 0 to 3 in PX4, 1 to 3 in ArduPilot [default: the first].
    #[arg(long, value_name = "N")]
    sensor: Option<u32>,

    /// The device_id of the gyroscope, as PX4 states it in sensor_gyro.
    #[arg(long, value_name = "ID")]
    device_id: Option<i32>,

    /// The file to write [default: stdout].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Overwrite an existing file, but never a capture.
    #[arg(long, requires = "output")]
    force: bool,
}

/// Formats that users may ask for but that cannot hold a bias.
const REFUSED: [(&str, &str); 2] = [
    ("kalibr", "Refused: Kalibr has no place for a bias"),
    ("ros", "Refused: ROS has no place for a bias over temperature"),
];

fn formats() -> PossibleValuesParser {
    let written = ExportForm::ALL.map(|form| (form.row().name, form.row().help));
    let all = written.into_iter().chain(REFUSED);
    PossibleValuesParser::new(all.map(|(name, help)| PossibleValue::new(name).help(help)))
}

pub fn run(args: &ExportArgs) -> Result<()> {
    let form = ExportForm::named(&args.format.to_lowercase());
    ensure!(
        args.prefix.is_none() || form.is_some_and(ExportForm::is_code),
        Usage("--prefix is for names in C and Rust; the other forms have none".to_owned())
    );
    args.check_autopilot(form)?;
    let form = form.ok_or_else(|| no_place(&args.format))?;
    let mut outputs = Outputs::new(args.force);
    let export = Export::new(load(&args.cal, &mut outputs)?, args.options()).map_err(usage)?;
    export.check_axes(form)?;
    args.check_device_id(form)?;
    let coded = |warning: &ExportWarning| format!("{}: {warning}", warning.code());
    warn(&export.warnings().iter().map(coded).collect::<Vec<_>>());
    let text = export.text(form).map_err(usage)?;
    if form == ExportForm::Csv {
        export.lost_by_rows().iter().for_each(|lost| say(format_args!("{lost}")));
    }
    match &args.output {
        None => print(&text),
        Some(path) => Ok(outputs.derived(path)?.fill(text.as_bytes())?),
    }
}

fn usage(error: anyhow::Error) -> anyhow::Error {
    match error.downcast::<InvalidOptions>() {
        Ok(InvalidOptions(text)) => Usage(text).into(),
        Err(error) => error,
    }
}

impl ExportArgs {
    fn options(&self) -> Options {
        let Self { step_c, span_c, prefix, sensor, device_id, .. } = self.clone();
        Options { step_c, span_c, prefix, sensor, device_id }
    }

    /// Checks that the format supports the given options for flight controllers and for the table.
    fn check_autopilot(&self, form: Option<ExportForm>) -> Result<()> {
        let autopilot = form.is_some_and(ExportForm::is_autopilot);
        let px4 = form == Some(ExportForm::Px4);
        ensure!(self.sensor.is_none() || autopilot, Usage("--sensor is for --format px4 and ardupilot".to_owned()));
        ensure!(self.device_id.is_none() || px4, Usage("--device-id is for --format px4".to_owned()));
        let table = self.step_c.is_some() || self.span_c.is_some();
        ensure!(
            !(autopilot && table),
            Usage("--step-c and --span-c are for tables; parameters are a curve".to_owned())
        );
        Ok(())
    }

    /// Checks that `--device-id` is given for PX4.
    fn check_device_id(&self, form: ExportForm) -> Result<()> {
        let lacks_id = self.device_id.is_none() && form == ExportForm::Px4;
        let give = "--format px4: give --device-id ID, by which PX4 finds a gyroscope: the device_id in the topic \
                    sensor_gyro (`listener sensor_gyro` in its console)";
        ensure!(!lacks_id, Usage(give.to_owned()));
        Ok(())
    }
}

/// The error for the formats of [`REFUSED`], which have no place for a bias over temperature.
fn no_place(format: &str) -> anyhow::Error {
    let (why, instead) = match format {
        "kalibr" => (
            "an imu.yaml of Kalibr holds noise densities, a rate and a topic, and its filter estimates the bias",
            "for the noise",
        ),
        _ => (
            "sensor_msgs/Imu holds rates and their covariance, and there is no agreed parameter for a bias",
            "for the covariance",
        ),
    };
    Usage(format!(
        "--format {format} has no place for a bias over temperature: {why}. Correct the rates before they reach it \
         (`zerorate stream`, `zerorate correct`, or --format c in the driver), and take \
         `zerorate imu LOG --format {format} -o FILE` {instead}"
    ))
    .into()
}
