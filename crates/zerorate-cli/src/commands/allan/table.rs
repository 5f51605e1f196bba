//! Formats deviations and noise coefficients as text, and deviations as CSV.

use anyhow::Result;
use std::fmt::Write;
use zerorate_imu::{AllanReport, PointReport};
use zerorate_view::noise::{self, TermRow, term_rows};
use zerorate_view::plot::number;

pub fn heading(report: &AllanReport) -> String {
    format!(
        "{}: {} samples at {:.6} Hz, {}, {}",
        report.label(),
        report.samples,
        report.rate_hz,
        report.stat.title(),
        noise::interval(report.confidence),
    )
}

/// Formats a row for each averaging time, then a line for each averaging time without a deviation.
pub fn text(report: &AllanReport) -> Result<String> {
    let per_hour = report.unit == Some("°/s");
    let mut text = String::new();
    let suffix = suffix(report);
    write!(text, "{:>14} {:>10}", "tau_s", "m")?;
    ["dev", "lo", "hi"].iter().try_for_each(|name| write!(text, " {:>13}", format!("{name}{suffix}")))?;
    if per_hour {
        write!(text, " {:>13}", "dev_deg_per_h")?;
    }
    writeln!(text, " {:>9} {:>10}  noise", "edf", "n")?;
    for PointReport { tau_s, m, dev, lo, hi, edf, n, noise, .. } in &report.points {
        write!(text, "{tau_s:>14.6} {m:>10} {dev:>13.6e} {lo:>13.6e} {hi:>13.6e}")?;
        if per_hour {
            write!(text, " {:>13.6e}", dev * 3600.0)?;
        }
        writeln!(text, " {edf:>9.1} {n:>10}  {}", noise.unwrap_or("?"))?;
    }
    for missing in &report.unavailable {
        writeln!(text, "{:>14.6} not computed: {}", missing.tau_s, missing.reason)?;
    }
    Ok(text)
}

pub fn coefficients_text(report: &AllanReport) -> Result<String> {
    let mut text = String::from("\nNoise coefficients with their 95 % intervals\n");
    if let Some(why) = &report.rejection {
        writeln!(text, "  none: {why}")?;
    }
    for TermRow { name, values, remark, .. } in term_rows(report) {
        for (index, (interval, unit)) in values.iter().enumerate() {
            let (title, remark) = if index == 0 { (&*name, &*remark) } else { ("", "") };
            let line = format!("  {title:22} {interval} {unit}  {remark}");
            writeln!(text, "{}", line.trim_end())?;
        }
        if values.is_empty() {
            writeln!(text, "  {name:22} {remark}")?;
        }
    }
    if let Some((fit, p_value)) = report.valid_model().and_then(|fit| Some((fit, fit.p_value?))) {
        let chance = match noise::is_without_misfit(fit) {
            true => format!(" (p = {p_value:.2})"),
            false => format!(" (p = {p_value:.2} with that)"),
        };
        writeln!(text, "\nNoise model: {}{chance}.", noise::misfit(fit))?;
    }
    if let Some(hz) = noise::holds_below(report) {
        writeln!(text, "It holds below {} Hz; above it the sensor's filter shapes the noise.", number(hz))?;
    }
    if let Some(predicts) = noise::predicts(report) {
        writeln!(text, "{predicts}")?;
    }
    text.push('\n');
    report.advice.iter().try_for_each(|advice| writeln!(text, "{advice}"))?;
    Ok(text)
}

/// Formats all records as one CSV table. With several records, the table has a column with the file. If several
/// records are of one file, it also has a column with the name of the log's column.
pub fn csv(reports: &[AllanReport]) -> Result<String> {
    let several = reports.len() > 1;
    let of_columns = reports.windows(2).any(|pair| pair[0].file == pair[1].file);
    let suffix = reports.first().map(suffix).unwrap_or_default();
    let mut rows = csv::Writer::from_writer(Vec::new());
    let head = ["tau_s", "m", "dev", "lo", "hi", "edf", "alpha", "n"];
    let named =
        head.map(|name| if matches!(name, "dev" | "lo" | "hi") { format!("{name}{suffix}") } else { name.to_owned() });
    let [file, column] = [(several, "file"), (of_columns, "column")].map(|(is_there, name)| is_there.then_some(name));
    rows.write_record(file.into_iter().chain(column).map(str::to_owned).chain(named))?;
    for report in reports {
        for PointReport { tau_s, m, dev, lo, hi, edf, alpha, n, .. } in &report.points {
            let file = several.then(|| report.file.clone());
            let cells = [tau_s.to_string(), m.to_string(), dev.to_string(), lo.to_string(), hi.to_string()];
            let last = [edf.to_string(), alpha.to_string(), n.to_string()];
            let column = of_columns.then(|| report.column.clone());
            rows.write_record(file.into_iter().chain(column).chain(cells).chain(last))?;
        }
    }
    Ok(String::from_utf8(rows.into_inner()?)?)
}

fn suffix(report: &AllanReport) -> &'static str {
    match report.unit {
        Some("°/s") => "_dps",
        Some("°") => "_deg",
        Some("m/s²") => "_mps2",
        Some("m/s") => "_mps",
        Some("°C") => "_c",
        Some(_) => "_c_s",
        None => "",
    }
}
