//! The tables that compare several axes.

use super::Table;
use crate::noise::{GaussMarkov, Group, gauss_markov, is_without_misfit, stated};
use crate::plot::number;
use zerorate_allan::{Estimate, Line, hertz};
use zerorate_imu::{CoefficientReport, FitReport, Record};

/// The table of coefficients: a row for each coefficient and unit, a column for each axis.
pub fn by_axis(group: &Group<'_>) -> Table {
    let fits: Vec<_> = group.records.iter().map(|record| FitReport::new(record.model(), record.quantity)).collect();
    let mut rows = Vec::new();
    for letter in ['N', 'B', 'K', 'Q', 'R'] {
        let of_axes: Vec<_> = fits.iter().map(|fit| coefficient(fit, letter)).collect();
        let Some(some) = of_axes.iter().flatten().next() else { continue };
        for (index, in_unit) in some.units.iter().enumerate() {
            let title = if index == 0 { format!("{letter}, {}", some.name) } else { String::new() };
            let cell = |of: &Option<&CoefficientReport>| {
                let value = of.and_then(|of| Some((of.in_unit(index)?, of.identified)));
                value.map_or_else(|| NONE.to_owned(), |(value, identified)| stated(value, identified))
            };
            rows.push(row(title, &in_unit.unit, of_axes.iter().map(cell)));
        }
    }
    if fits.iter().all(|fit| fit.model_error.is_none()) {
        return Table::default();
    }
    rows.extend(gauss_markov_rows(&fits));
    let error = |fit: &FitReport| match fit.model_error {
        _ if fit.motion_ratio.is_some() => "motion: rejected".to_owned(),
        Some(error) if fit.rejected => format!("{:.1} %: rejected", error * 100.0),
        Some(_) if is_without_misfit(fit) => "none found".to_owned(),
        Some(error) => format!("{:.1} %", error * 100.0),
        None => "no model".to_owned(),
    };
    rows.push(row("misfit of the model".to_owned(), "", fits.iter().map(error)));
    Table {
        title: "Coefficients by axis".to_owned(),
        head: head("", group),
        rows,
        note:
            "In brackets 95 % intervals; < upper limit where the coefficient cannot be told from zero. B is drawn at \
               0.664·B, where its floor lies."
                .to_owned(),
    }
}

/// A coefficient, if the model has it and is not rejected.
fn coefficient(fit: &FitReport, letter: char) -> Option<&CoefficientReport> {
    let is_wanted = |(of, found): &(char, &CoefficientReport)| *of == letter && found.value.is_some();
    fit.coefficients().find(is_wanted).map(|(_, found)| found).filter(|_| !fit.rejected)
}

/// The text of a cell without a value.
const NONE: &str = "–";

fn head(title: &str, group: &Group<'_>) -> Vec<String> {
    row(title.to_owned(), "unit", group.names().into_iter())
}

fn row(title: String, unit: &str, cells: impl Iterator<Item = String>) -> Vec<String> {
    [title, unit.to_owned()].into_iter().chain(cells).collect()
}

/// The rows of the Gauss–Markov terms, two for each term: σ and correlation time.
fn gauss_markov_rows(fits: &[FitReport]) -> Vec<Vec<String>> {
    let of = |fit: &FitReport| if fit.rejected { Vec::new() } else { gauss_markov(fit).collect() };
    let all: Vec<Vec<GaussMarkov>> = fits.iter().map(of).collect();
    let rows = (0..all.iter().map(Vec::len).max().unwrap_or(0)).flat_map(|index| {
        let cells = |value: fn(&GaussMarkov) -> Estimate| {
            let cell = move |terms: &Vec<GaussMarkov>| {
                terms.get(index).map_or_else(|| NONE.to_owned(), |term| stated(value(term), true))
            };
            all.iter().map(cell)
        };
        let unit = all.iter().find_map(|terms| terms.get(index)).map_or("", |term| &*term.unit);
        [
            row("Gauss–Markov σ".to_owned(), unit, cells(|term| term.sigma)),
            row("its correlation time".to_owned(), "s", cells(|term| term.tau_s)),
        ]
    });
    rows.collect()
}

/// The table of spectral lines by frequency. Neighbouring lines share a row, which sums up the lines of each axis.
pub fn lines(group: &Group<'_>) -> Table {
    let of_axis = |(axis, record)| Record::lines(record).filter(|line| line.rms > 0.0).map(move |line| (axis, line));
    let mut found: Vec<(usize, &Line)> = group.records.iter().enumerate().flat_map(of_axis).collect();
    found.sort_by(|(_, a), (_, b)| a.frequency_hz.total_cmp(&b.frequency_hz));
    let is_beside = |(_, a): &(usize, &Line), (_, b): &(usize, &Line)| {
        b.frequency_hz - a.frequency_hz <= (0.5 * a.width_hz.max(b.width_hz)).max(BESIDE * a.frequency_hz)
    };
    let stretch = |lines: &[(usize, &Line)]| {
        let strongest = lines.iter().max_by(|(_, a), (_, b)| a.rms.total_cmp(&b.rms));
        let frequency = strongest.map(|(_, line)| hertz(line.frequency_hz)).unwrap_or_default();
        let cell = |axis| {
            let of_axis = || lines.iter().filter(move |(of, _)| *of == axis);
            let rms = of_axis().map(|(_, line)| line.rms * line.rms).sum::<f64>().sqrt();
            match of_axis().count() {
                0 => NONE.to_owned(),
                1 => number(rms),
                count => format!("{} ({count})", number(rms)),
            }
        };
        row(frequency, &format!("{} rms", group.unit()), (0..group.records.len()).map(cell))
    };
    Table {
        title: "Lines in the spectrum".to_owned(),
        head: head("frequency", group),
        rows: found.chunk_by(is_beside).map(stretch).collect(),
        note: "Disturbances or resonances: they are left out of N, B and K but are part of the curve. The number in \
               brackets counts lines side by side; the strongest gives the frequency. Lines that all axes share come \
               from the table on which the sensor stands."
            .to_owned(),
    }
}

/// Lines closer than this share of their frequency share a row. Wide lines may be farther apart.
const BESIDE: f64 = 0.01;
