//! The result as text and as CSV.

use super::words::advice::advice;
use super::words::units::{self, DETREND_METHOD, TermRow, noise};
use anyhow::Result;
use std::fmt::Write;
use zerorate_allan::Point;
use zerorate_imu::Record;

/// Averages in the record from which the exponent of its noise can be told: the exponent is found to about 2/√averages
/// and rounded to a whole number, which 62 averages get right 19 times of 20.
const TELLING: f64 = 62.0;

/// Formats the line above the table.
pub fn heading(record: &Record) -> String {
    let analysis = &record.analysis;
    format!(
        "{}: {} samples at {:.6} Hz, {}, {}",
        record.label(),
        analysis.samples,
        analysis.rate_hz,
        record.title(),
        units::interval(record.confidence),
    )
}

/// Formats what was removed from the record before the analysis, a line each.
pub fn removed(record: &Record) -> Vec<String> {
    let skipped = (record.skipped_s > 0.0).then(|| format!("without the first {}", units::span(record.skipped_s)));
    let unit = units::deviation_unit(record).unwrap_or("");
    let detrended = record.detrended.as_ref().map(|detrended| {
        let terms = detrended.coefficients.iter().zip(["/°C", "/°C²", "/°C³"]);
        let terms = terms.map(|(value, per)| format!("{value:.4e} {unit}{per}")).collect::<Vec<_>>().join(", ");
        format!(
            "less a polynomial of order {} over temperature ({DETREND_METHOD}): {terms}; it explains {:.1} % of the \
             slow variance and took {} of the degrees of freedom. Of a random walk {:.0} % are left, so K is stated \
             with what was lost, and long averages with fewer degrees of freedom",
            detrended.lost_dof,
            detrended.explained * 100.0,
            detrended.lost_dof,
            detrended.walk_kept() * 100.0
        )
    });
    skipped.into_iter().chain(detrended).collect()
}

/// Formats a row for each averaging time, then a line for each time that could not be computed.
pub fn text(record: &Record) -> Result<String> {
    let per_hour = units::deviation_unit(record) == Some("°/s");
    let mut text = String::new();
    let suffix = suffix(record);
    write!(text, "{:>14} {:>10}", "tau_s", "m")?;
    ["dev", "lo", "hi"].iter().try_for_each(|name| write!(text, " {:>13}", format!("{name}{suffix}")))?;
    if per_hour {
        write!(text, " {:>13}", "dev_deg_per_h")?;
    }
    writeln!(text, " {:>9} {:>10}  noise", "edf", "n")?;
    for Point { tau_s, m, dev, lo, hi, edf, alpha, n } in &record.analysis.points {
        write!(text, "{tau_s:>14.6} {m:>10} {dev:>13.6e} {lo:>13.6e} {hi:>13.6e}")?;
        if per_hour {
            write!(text, " {:>13.6e}", dev * 3600.0)?;
        }
        let is_told = record.analysis.samples as f64 >= TELLING * *m as f64;
        let noise = if is_told { noise(*alpha, record.quantity) } else { "?" };
        writeln!(text, " {edf:>9.1} {n:>10}  {noise}")?;
    }
    for missing in &record.analysis.unavailable {
        writeln!(text, "{:>14.6} not computed: {}", missing.tau_s, missing.reason)?;
    }
    Ok(text)
}

/// Formats the noise model with its intervals, then the advice.
pub fn coefficients_text(record: &Record) -> Result<String> {
    let mut text = String::from("\nNoise coefficients with their 95 % intervals\n");
    if let Some(Err(why)) = &record.fit {
        writeln!(text, "  none: {why}")?;
    }
    for row in units::term_rows(record) {
        let TermRow { name, values, remark } = row;
        for (index, (interval, unit)) in values.iter().enumerate() {
            let (title, remark) = if index == 0 { (&*name, &*remark) } else { ("", "") };
            let line = format!("  {title:22} {interval} {unit}  {remark}");
            writeln!(text, "{}", line.trim_end())?;
        }
        if values.is_empty() {
            writeln!(text, "  {name:22} {remark}")?;
        }
    }
    if let Some(fit) = record.model() {
        let with_that = if units::is_without_misfit(fit) { "" } else { " with that" };
        writeln!(text, "\nNoise model: {} (p = {:.2}{with_that}).", units::misfit(fit), fit.p_value)?;
    }
    if let Some(holds) = units::holds_below(record) {
        writeln!(text, "{holds}")?;
    }
    if let Some(predicts) = units::predicts(record) {
        writeln!(text, "{predicts}")?;
    }
    text.push('\n');
    advice(record).iter().try_for_each(|advice| writeln!(text, "{advice}"))?;
    Ok(text)
}

/// Formats all records as one table. Several records add a column with the file, and several records of one file add
/// one with the name of the column.
pub fn csv(records: &[Record]) -> Result<String> {
    let several = records.len() > 1;
    let of_columns = records.windows(2).any(|pair| pair[0].file == pair[1].file);
    let suffix = records.first().map(suffix).unwrap_or_default();
    let mut rows = csv::Writer::from_writer(Vec::new());
    let head = ["tau_s", "m", "dev", "lo", "hi", "edf", "alpha", "n"];
    let named =
        head.map(|name| if matches!(name, "dev" | "lo" | "hi") { format!("{name}{suffix}") } else { name.to_owned() });
    let [file, column] = [(several, "file"), (of_columns, "column")].map(|(is_there, name)| is_there.then_some(name));
    rows.write_record(file.into_iter().chain(column).map(str::to_owned).chain(named))?;
    for record in records {
        for Point { tau_s, m, dev, lo, hi, edf, alpha, n } in &record.analysis.points {
            let file = several.then(|| record.file.display().to_string());
            let cells = [tau_s.to_string(), m.to_string(), dev.to_string(), lo.to_string(), hi.to_string()];
            let last = [edf.to_string(), alpha.to_string(), n.to_string()];
            let column = of_columns.then(|| record.column.clone());
            rows.write_record(file.into_iter().chain(column).chain(cells).chain(last))?;
        }
    }
    Ok(String::from_utf8(rows.into_inner()?)?)
}

/// The ending of a column name that states the unit.
fn suffix(record: &Record) -> &'static str {
    match units::deviation_unit(record) {
        Some("°/s") => "_dps",
        Some("°") => "_deg",
        Some("m/s²") => "_mps2",
        Some("m/s") => "_mps",
        Some("°C") => "_c",
        Some(_) => "_c_s",
        None => "",
    }
}
