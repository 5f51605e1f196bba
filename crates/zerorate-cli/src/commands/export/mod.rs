//! `zerorate export`: a calibration in the form that firmware takes: table and integer coefficients.

mod codes;
mod firmware;
mod json;
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
use std::path::PathBuf;
use zerorate::{Calibration, TableRow};

/// Writes the correction for firmware: C header, Rust module, CSV or JSON.
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
    };
    match &args.output {
        None => print(&text),
        Some(path) => Ok(outputs.derived(path)?.fill(text.as_bytes())?),
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
