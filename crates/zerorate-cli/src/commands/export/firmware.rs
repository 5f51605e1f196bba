//! The C header and the Rust module: templates, filled in.

use super::layout::Layout;
use super::prefix::Prefix;
use super::{AXIS, Export};
use crate::exit::Usage;
use anyhow::{Result, ensure};
use zerorate::{IntegerCorrection, RowIndex, Validity};

/// The C header. Without a prefix its names begin with `zerorate`.
pub fn c(export: &Export, prefix: Option<&Prefix>) -> Result<String> {
    let functions = prefix.map_or("zerorate_".to_owned(), Prefix::of_functions);
    let constants = prefix.map_or("ZERORATE_".to_owned(), Prefix::of_constants);
    fill(include_str!("calibration.h.in"), export, [("f", functions), ("C", constants)])
}

/// The Rust module. Without a prefix its name tells units apart.
pub fn rust(export: &Export, prefix: Option<&Prefix>) -> Result<String> {
    let functions = prefix.map_or_else(String::new, Prefix::of_functions_in_rust);
    let constants = prefix.map_or_else(String::new, Prefix::of_constants);
    fill(include_str!("calibration.rs.in"), export, [("f", functions), ("C", constants)])
}

/// Replaces each `@KEY@` of the template, the prefixes first: what follows them may look like a key.
fn fill(template: &str, export: &Export, prefixes: [(&'static str, String); 2]) -> Result<String> {
    let entries = [&prefixes[..], &entries(export)?, &valid_range(&export.layout)].concat();
    Ok(entries.iter().fold(template.to_owned(), |text, (key, value)| text.replace(&format!("@{key}@"), value)))
}

fn entries(export: &Export) -> Result<Vec<(&'static str, String)>> {
    let Export { calibration, correction, integer: IntegerCorrection { offset_q, slope_q, t3_code }, layout, rows } =
        export;
    let text = |value: &Option<String>| value.as_deref().map_or("not stated".to_owned(), comment);
    let index = RowIndex::new(rows.len(), layout.step_c, correction.t3_c, &AXIS.temp);
    let codes: Result<Vec<i32>> = rows.iter().map(|row| millionths(row.correction_dps)).collect();
    Ok(vec![
        ("SOFTWARE", crate::SOFTWARE.to_owned()),
        ("SERIAL", text(&calibration.serial)),
        ("CREATED", text(&calibration.created)),
        ("METHOD", text(&calibration.method)),
        ("ID", calibration.id()),
        ("PBC", correction.pbc_dps.to_string()),
        ("BTC", correction.btc_dps_per_c.to_string()),
        ("T3", correction.t3_c.to_string()),
        ("PBC_UDPS", millionths(correction.pbc_dps)?.to_string()),
        ("OFFSET_Q", offset_q.to_string()),
        ("SLOPE_Q", slope_q.to_string()),
        ("T3_CODE", t3_code.to_string()),
        ("Q", IntegerCorrection::Q.to_string()),
        ("LSB_PER_DPS", AXIS.rate.lsb_per_unit.to_string()),
        ("LSB_PER_C", AXIS.temp.lsb_per_unit.to_string()),
        ("STEP_C", layout.step_c.to_string()),
        ("SPAN_C", layout.span_c.to_string()),
        ("STEP_UC", whole_millionths("--step-c", layout.step_c)?.to_string()),
        ("SPAN_UC", whole_millionths("--span-c", layout.span_c)?.to_string()),
        ("STEP_DPS", format!("{:.5}", correction.btc_dps_per_c.abs() * layout.step_c / 2.0)),
        ("MIDDLE_Q", index.middle_q.to_string()),
        ("ROWS_PER_CODE_Q", index.rows_per_code_q.to_string()),
        ("ROW_Q", RowIndex::Q.to_string()),
        ("ROWS", rows.len().to_string()),
        ("BYTES", (4 * rows.len()).to_string()),
        ("TABLE", lines(&codes?)),
    ])
}

/// Where the correction holds, in words, in °C and as codes.
fn valid_range(Layout { valid, stated, .. }: &Layout) -> Vec<(&'static str, String)> {
    let Validity { temp_min_c, temp_max_c, .. } = *valid;
    let whence = if *stated { "seen while measuring" } else { "assumed, the calibration states none" };
    vec![
        ("VALID", format!("{temp_min_c:.1} to {temp_max_c:.1} deg C, {whence}")),
        ("TEMP_MIN_C", format!("{temp_min_c:?}")),
        ("TEMP_MAX_C", format!("{temp_max_c:?}")),
        ("TEMP_MIN_CODE", AXIS.temp.nearest_code(temp_min_c).to_string()),
        ("TEMP_MAX_CODE", AXIS.temp.nearest_code(temp_max_c).to_string()),
        ("MARGIN_C", Validity::MARGIN_C.to_string()),
        ("MARGIN_CODE", (Validity::MARGIN_C * AXIS.temp.lsb_per_unit).round().to_string()),
    ]
}

/// In millionths of its unit, to nearest.
fn millionths(value: f64) -> Result<i32> {
    let scaled = (value * 1e6).round();
    ensure!(
        scaled.abs() <= f64::from(i32::MAX),
        "{value} does not fit 32 bits in millionths: choose a smaller --span-c"
    );
    Ok(scaled as i32)
}

/// The same, of a value that must lose nothing by it.
fn whole_millionths(option: &str, value: f64) -> Result<i32> {
    let whole = millionths(value)?;
    ensure!(
        (value * 1e6 - f64::from(whole)).abs() < 1e-6,
        Usage(format!("{option} {value} is no whole number of millionths of a degree"))
    );
    Ok(whole)
}

/// Eight numbers a line.
fn lines(numbers: &[i32]) -> String {
    let line = |numbers: &[i32]| {
        let numbers: Vec<String> = numbers.iter().map(i32::to_string).collect();
        format!("    {},", numbers.join(", "))
    };
    numbers.chunks(8).map(line).collect::<Vec<_>>().join("\n")
}

/// Text of the calibration file that can neither end a comment nor bring what a compiler might trip over.
fn comment(text: &str) -> String {
    let plain =
        |c: char| if c.is_ascii_graphic() && !matches!(c, '@' | '*' | '\\' | '?') || c == ' ' { c } else { '.' };
    text.chars().map(plain).collect()
}
