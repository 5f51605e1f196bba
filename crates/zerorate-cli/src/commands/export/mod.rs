//! `zerorate export`: a calibration in the form that firmware takes: table and integer coefficients.

mod firmware;
mod layout;
mod prefix;

use super::correct::load;
use super::{print, warn};
use crate::exit::Usage;
use crate::output::Outputs;
use anyhow::{Result, ensure};
use clap::{Args, ValueEnum};
use layout::Layout;
use prefix::Prefix;
use serde::Serialize;
use std::path::PathBuf;
use zerorate::{Axis, Calibration, Correction, IntegerCorrection, TableRow};

/// Writes the correction for firmware: C header, Rust module, CSV or JSON.
///
/// The table holds (TEMP − T3) · BTC, without PBC, for TEMP − T3 from +span down to −span. The C and Rust forms also
/// hold the integer coefficients, with a function from raw code to corrected code that needs no table, and the range
/// that the calibration holds for: their look-up says whether a temperature lies inside. Two units fit into one
/// program under two prefixes; in Rust, two modules do as well.
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
    /// The table: delta_c,correction_dps.
    Csv,
    /// Coefficients and table.
    Json,
}

/// The axis whose codes are corrected.
const AXIS: Axis = Axis::ADIS16130;

/// A correction, ready to be written down.
struct Export {
    calibration: Calibration,
    correction: Correction,
    integer: IntegerCorrection,
    layout: Layout,
    rows: Vec<TableRow>,
}

pub fn run(args: &ExportArgs) -> Result<()> {
    ensure!(
        args.prefix.is_none() || matches!(args.format, Form::C | Form::Rust),
        Usage("--prefix is for names in C and Rust; the other forms have none".to_owned())
    );
    let mut outputs = Outputs::new(args.force).reading([&*args.cal])?;
    let calibration = load(&args.cal)?;
    ensure!(calibration.schema() == 1, "{}: several axes cannot be exported yet", args.cal.display());
    let correction = calibration.axes[0].correction;
    let layout = Layout::new(&calibration, args.step_c, args.span_c);
    let rows = layout.rows(&correction)?;
    let integer = correction.to_integer(&AXIS.rate, &AXIS.temp)?;
    warn(&layout.warnings(&correction));
    let export = Export { calibration, correction, integer, layout, rows };
    let text = match args.format {
        Form::C => firmware::c(&export, args.prefix.as_ref())?,
        Form::Rust => firmware::rust(&export, args.prefix.as_ref())?,
        Form::Csv => csv(&export),
        Form::Json => json(&export)?,
    };
    match &args.output {
        None => print(&text),
        Some(path) => Ok(outputs.derived(path)?.fill(text.as_bytes())?),
    }
}

fn csv(export: &Export) -> String {
    let row = |row: &TableRow| format!("{},{}\n", tidy(row.delta_c), tidy(row.correction_dps));
    std::iter::once("delta_c,correction_dps\n".to_owned()).chain(export.rows.iter().map(row)).collect()
}

/// Twelve significant digits, the shortest decimal that has them, and no negative zero: 3 · 0.02 is 0.06.
fn tidy(value: f64) -> f64 {
    // formatted numbers parse
    let rounded = format!("{value:.11e}").parse().unwrap_or(value);
    if rounded == 0.0 { 0.0 } else { rounded }
}

#[derive(Serialize)]
struct Json<'a> {
    calibration_id: String,
    serial: Option<&'a str>,
    pbc_dps: f64,
    btc_dps_per_c: f64,
    t3_c: f64,
    temp_min_c: Option<f64>,
    temp_max_c: Option<f64>,
    valid: Valid,
    integer: Integer,
    table: Table,
}

#[derive(Serialize)]
struct Integer {
    q: u32,
    offset_q: i64,
    slope_q: i32,
    t3_code: i32,
}

/// Where the correction is taken to hold.
#[derive(Serialize)]
struct Valid {
    /// Whether the calibration says so; else it is assumed.
    stated: bool,
    temp_min_c: f64,
    temp_max_c: f64,
    temp_min_code: i64,
    temp_max_code: i64,
}

#[derive(Serialize)]
struct Table {
    step_c: f64,
    span_c: f64,
    rows: Vec<JsonRow>,
}

#[derive(Serialize)]
struct JsonRow {
    delta_c: f64,
    correction_dps: f64,
}

fn json(export: &Export) -> Result<String> {
    let Export { calibration, correction, integer, layout, .. } = export;
    let valid = layout.valid;
    let row = |row: &TableRow| JsonRow { delta_c: tidy(row.delta_c), correction_dps: tidy(row.correction_dps) };
    let object = Json {
        calibration_id: calibration.id(),
        serial: calibration.serial.as_deref(),
        pbc_dps: correction.pbc_dps,
        btc_dps_per_c: correction.btc_dps_per_c,
        t3_c: correction.t3_c,
        temp_min_c: calibration.validity.map(|span| span.temp_min_c),
        temp_max_c: calibration.validity.map(|span| span.temp_max_c),
        valid: Valid {
            stated: layout.stated,
            temp_min_c: valid.temp_min_c,
            temp_max_c: valid.temp_max_c,
            temp_min_code: AXIS.temp.nearest_code(valid.temp_min_c),
            temp_max_code: AXIS.temp.nearest_code(valid.temp_max_c),
        },
        integer: Integer {
            q: IntegerCorrection::Q,
            offset_q: integer.offset_q,
            slope_q: integer.slope_q,
            t3_code: integer.t3_code,
        },
        table: Table { step_c: layout.step_c, span_c: layout.span_c, rows: export.rows.iter().map(row).collect() },
    };
    Ok(serde_json::to_string_pretty(&object)? + "\n")
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
