//! The C header and the Rust module: templates, filled in.

use super::Export;
use crate::exit::Usage;
use anyhow::{Result, ensure};
use zerorate::{IntegerCorrection, RowIndex};

/// The C header.
pub fn c(export: &Export) -> Result<String> {
    fill(include_str!("calibration.h.in"), export)
}

/// The Rust module.
pub fn rust(export: &Export) -> Result<String> {
    fill(include_str!("calibration.rs.in"), export)
}

/// Replaces each `@KEY@` of the template.
fn fill(template: &str, export: &Export) -> Result<String> {
    let entries = entries(export)?;
    Ok(entries.iter().fold(template.to_owned(), |text, (key, value)| text.replace(&format!("@{key}@"), value)))
}

fn entries(export: &Export) -> Result<Vec<(&'static str, String)>> {
    let Export { calibration, integer: IntegerCorrection { offset_q, slope_q, t3_code }, rows, .. } = export;
    let correction = calibration.correction;
    let text = |value: &Option<String>| value.as_deref().map_or("not stated".to_owned(), comment);
    let span = calibration.validity.map(|span| format!("{:.1} to {:.1} deg C", span.temp_min_c, span.temp_max_c));
    let index = RowIndex::new(rows.len(), export.step_c, correction.t3_c);
    let codes: Result<Vec<i32>> = rows.iter().map(|row| millionths(row.correction_dps)).collect();
    Ok(vec![
        ("SOFTWARE", crate::SOFTWARE.to_owned()),
        ("SERIAL", text(&calibration.serial)),
        ("CREATED", text(&calibration.created)),
        ("METHOD", text(&calibration.method)),
        ("VALID", span.unwrap_or("not stated".to_owned())),
        ("ID", calibration.id()),
        ("PBC", correction.pbc_dps.to_string()),
        ("BTC", correction.btc_dps_per_c.to_string()),
        ("T3", correction.t3_c.to_string()),
        ("PBC_UDPS", millionths(correction.pbc_dps)?.to_string()),
        ("OFFSET_Q", offset_q.to_string()),
        ("SLOPE_Q", slope_q.to_string()),
        ("T3_CODE", t3_code.to_string()),
        ("Q", IntegerCorrection::Q.to_string()),
        ("LSB_PER_DPS", adis16130::RATE_LSB_PER_DPS.to_string()),
        ("LSB_PER_C", adis16130::TEMP_LSB_PER_C.to_string()),
        ("STEP_C", export.step_c.to_string()),
        ("SPAN_C", export.span_c.to_string()),
        ("STEP_UC", whole_millionths("--step-c", export.step_c)?.to_string()),
        ("SPAN_UC", whole_millionths("--span-c", export.span_c)?.to_string()),
        ("MIDDLE_Q", index.middle_q.to_string()),
        ("ROWS_PER_CODE_Q", index.rows_per_code_q.to_string()),
        ("ROW_Q", RowIndex::Q.to_string()),
        ("ROWS", rows.len().to_string()),
        ("TABLE", lines(&codes?)),
    ])
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
