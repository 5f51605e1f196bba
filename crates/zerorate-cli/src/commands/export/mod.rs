//! `zerorate export`: a calibration in the form that firmware takes: table and integer coefficients.

mod autopilot;
mod codes;
mod firmware;
mod json;
mod layout;
mod prefix;

use super::correct::load;
use super::{print, warn};
use crate::exit::Usage;
use crate::output::{Outputs, say};
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use layout::Layout;
use prefix::Prefix;
use std::path::PathBuf;
use zerorate::{Calibration, TableRow};

/// Writes the correction for firmware: C header, Rust module, CSV or JSON, and parameters of PX4 and ArduPilot.
///
/// The table holds what is added beside PBC, (TEMP − T3) · BTC and the terms of a curve, for TEMP − T3 from +span
/// down to −span. The C and Rust forms also hold the integer coefficients, with a function from raw code to
/// corrected code that needs no table, and the range that the calibration holds for: their look-up says whether a
/// temperature lies inside. Two units fit into one program under two prefixes; in Rust, two modules do as well.
/// Where a calibration has several axes, all are in one file, and their names carry that of the axis:
/// zerorate_x_correct_code.
#[derive(Args, Debug)]
pub struct ExportArgs {
    /// The calibration file.
    #[arg(value_name = "CALIBRATION")]
    cal: PathBuf,

    /// What to write.
    #[arg(long, value_enum)]
    format: Form,

    /// Step of the table, °C [default: 0.02; without --span-c the finest of 0.02, 0.05, 0.1, … that makes at most 1025
    /// rows, 4.1 kB].
    #[arg(long, value_name = "C")]
    step_c: Option<f64>,

    /// The table reaches this far from T3 on both sides, °C [default: so far that it covers the temperatures that the
    /// calibration holds for].
    #[arg(long, value_name = "C")]
    span_c: Option<f64>,

    /// What names begin with in C and Rust [default: zerorate in C, nothing in Rust].
    #[arg(long, value_name = "NAME")]
    prefix: Option<Prefix>,

    /// Which gyroscope of the flight controller it is: 0 to 3 of PX4, 1 to 3 of ArduPilot [default: its first].
    #[arg(long, value_name = "N")]
    sensor: Option<u32>,

    /// The device_id of that gyroscope, as PX4 states it in sensor_gyro.
    #[arg(long, value_name = "ID", allow_negative_numbers = true)]
    device_id: Option<i32>,

    /// The file to write [default: stdout].
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,

    /// Overwrite an existing file, but never a capture.
    #[arg(long, requires = "output")]
    force: bool,
}

/// Forms of the export.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum Form {
    /// A C99 header that needs nothing but <stdbool.h> and <stdint.h>.
    C,
    /// A Rust module without dependencies, no_std.
    Rust,
    /// The table: delta_c,correction_dps; several axes: delta_c,x_correction_dps,y_correction_dps,…
    Csv,
    /// Coefficients and table.
    Json,
    /// Parameters of PX4, TC_Gn_…: the bias of three axes, cubic about the middle of the temperatures.
    Px4,
    /// Parameters of ArduPilot, INS_TCALn_…: the same about its 35 °C.
    Ardupilot,
    /// Refused: Kalibr has no place for a bias.
    Kalibr,
    /// Refused: ROS has no place for a bias over temperature.
    Ros,
}

/// Corrections, ready to be written down.
struct Export {
    calibration: Calibration,
    layout: Layout,
    /// The table of each axis of the calibration.
    tables: Vec<Vec<TableRow>>,
}

pub fn run(args: &ExportArgs) -> Result<()> {
    ensure!(
        args.prefix.is_none() || matches!(args.format, Form::C | Form::Rust),
        Usage("--prefix is for names in C and Rust; the other forms have none".to_owned())
    );
    args.check_autopilot()?;
    let mut outputs = Outputs::new(args.force).reading([&*args.cal])?;
    let calibration = load(&args.cal)?;
    let layout = Layout::new(&calibration, args.step_c, args.span_c);
    let tables = calibration.axes.iter().map(|axis| layout.rows(&axis.correction)).collect::<Result<_>>()?;
    warn(&layout.warnings(&calibration));
    let export = Export { calibration, layout, tables };
    let text = match args.format {
        Form::C => firmware::c(&export, args.prefix.as_ref())?,
        Form::Rust => firmware::rust(&export, args.prefix.as_ref())?,
        Form::Csv => csv(&export),
        Form::Json => json::text(&export)?,
        Form::Px4 => autopilot::px4(&export, args.sensor, args.device_id)?,
        Form::Ardupilot => autopilot::ardupilot(&export, args.sensor)?,
        Form::Kalibr => return Err(autopilot::no_place("kalibr")),
        Form::Ros => return Err(autopilot::no_place("ros")),
    };
    if matches!(args.format, Form::Csv) {
        export.tell_what_rows_lose();
    }
    match &args.output {
        None => print(&text),
        Some(path) => Ok(outputs.derived(path)?.fill(text.as_bytes())?),
    }
}

impl Export {
    /// CSV has no place for it. Rows of a line lose nothing between them.
    fn tell_what_rows_lose(&self) {
        let Layout { step_c, span_c, .. } = self.layout;
        for axis in self.calibration.axes.iter().filter(|axis| !axis.correction.is_line()) {
            let (name, curve) = (&axis.name, &axis.correction);
            say(format_args!(
                "axis {name}: straight lines between rows are off the curve by up to {:.1e} °/s, the nearest row \
                 by up to {:.1e} °/s",
                curve.bend_dps(step_c, span_c),
                curve.steepest_dps_per_c(span_c) * step_c / 2.0
            ));
        }
    }
}

impl ExportArgs {
    /// Which options belong to which form, before anything is read.
    fn check_autopilot(&self) -> Result<()> {
        let Self { format, .. } = self;
        match format {
            Form::Kalibr => return Err(autopilot::no_place("kalibr")),
            Form::Ros => return Err(autopilot::no_place("ros")),
            _ => {}
        }
        let autopilot = matches!(format, Form::Px4 | Form::Ardupilot);
        ensure!(self.sensor.is_none() || autopilot, Usage("--sensor is for --format px4 and ardupilot".to_owned()));
        ensure!(
            self.device_id.is_none() || matches!(format, Form::Px4),
            Usage("--device-id is for --format px4".to_owned())
        );
        let table = self.step_c.is_some() || self.span_c.is_some();
        ensure!(
            !(autopilot && table),
            Usage("--step-c and --span-c are for tables; parameters are a curve".to_owned())
        );
        Ok(())
    }
}

/// One column for the only axis of an ADIS16130; else one for each axis, under its name.
fn csv(export: &Export) -> String {
    let Export { calibration, tables, .. } = export;
    let names = calibration.axes.iter().map(|axis| format!(",{}_correction_dps", axis.name));
    let header = if calibration.is_plain() { ",correction_dps".to_owned() } else { names.collect() };
    let mut text = format!("delta_c{header}\n");
    for (index, row) in tables.first().into_iter().flatten().enumerate() {
        text += &tidy(row.delta_c).to_string();
        for corrections in tables {
            text += &format!(",{}", tidy(corrections[index].correction_dps));
        }
        text.push('\n');
    }
    text
}

/// Twelve significant digits, the shortest decimal that has them, and no negative zero: 3 · 0.02 is 0.06.
fn tidy(value: f64) -> f64 {
    // formatted numbers parse
    let rounded = format!("{value:.11e}").parse().unwrap_or(value);
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_without_noise() {
        assert_eq!(
            [0.1 + 0.2, -0.0, 6.0 * 0.02 * -0.04, 3.0 * 0.02].map(|x| tidy(x).to_string()),
            ["0.3", "0", "-0.0048", "0.06"]
        );
    }
}
