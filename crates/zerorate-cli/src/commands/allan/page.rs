//! The result as one HTML page.

use super::picture::Group;
use super::words::advice::advice;
use super::words::units::{self, GaussMarkov, deviation_unit, noise};
use super::words::warnings;
use crate::output::StagedOutput;
use anyhow::Result;
use zerorate_allan::{Estimate, Fit, Line};
use zerorate_imu::Record;
use zerorate_view::Interval;
use zerorate_view::plot::number;
use zerorate_view::report::{self, AllanPage, AllanRow, Coefficient, CoefficientValue, Fact, Table, allan_page};

/// The head of the page, for all records together.
#[derive(Default)]
pub struct Head {
    pub title: String,
    pub facts: Vec<Fact>,
    pub warnings: Vec<String>,
    pub tables: Vec<Table>,
}

/// Writes the page of all records, with a group for each quantity.
pub fn write(file: StagedOutput, head: Head, records: &[Record]) -> Result<()> {
    let Head { title, facts, warnings, tables } = head;
    let first = records.first();
    let page = AllanPage {
        title,
        command: std::iter::once("zerorate".to_owned()).chain(std::env::args().skip(1)).collect::<Vec<_>>().join(" "),
        quantity: first.map(Record::title).unwrap_or_default().to_owned(),
        interval: first.map(|record| units::interval(record.confidence)).unwrap_or_default(),
        coefficient_interval: "95 % intervals".to_owned(),
        facts,
        warnings,
        tables,
        groups: Group::all(records).iter().map(|group| of_group(group, records.len() > 1)).collect(),
        records: records.iter().map(section).collect(),
    };
    Ok(file.fill(allan_page(&page)?.as_bytes())?)
}

/// Tables and pictures of one quantity. A single record has its coefficients in its own section.
fn of_group(group: &Group<'_>, is_one_of_several: bool) -> report::Group {
    let tables = match is_one_of_several {
        true => [by_axis(group), lines(group)].into_iter().filter(|table| !table.rows.is_empty()).collect(),
        false => Vec::new(),
    };
    let name = if is_one_of_several { group.heading() } else { "" };
    report::Group { name: name.to_owned(), tables, pictures: group.pictures() }
}

/// The table with a row for each coefficient and unit, and a column for each axis.
fn by_axis(group: &Group<'_>) -> Table {
    let models: Vec<_> = group.records.iter().map(Record::model).collect();
    let all: Vec<_> = group.records.iter().map(units::coefficients).collect();
    let mut rows = Vec::new();
    for letter in ['N', 'B', 'K', 'Q', 'R'] {
        let of_axes: Vec<_> = all.iter().map(|named| named.iter().find(|one| one.letter == letter)).collect();
        let Some(some) = of_axes.iter().flatten().next() else { continue };
        for (index, (unit, _)) in some.units.iter().enumerate() {
            let title = if index == 0 { format!("{letter}, {}", some.name) } else { String::new() };
            let cell = |(named, model): (&Option<&units::Named<'_>>, &Option<&Fit>)| match named {
                Some(named) if model.is_some_and(|fit| !fit.is_rejected) => {
                    units::stated(named.in_unit(index), named.coefficient.identified)
                }
                _ => NONE.to_owned(),
            };
            rows.push(row(title, of_axes.iter().zip(&models).map(cell), unit));
        }
    }
    if rows.is_empty() {
        return Table::default();
    }
    rows.extend(gauss_markov(group));
    let error = |model: &Option<&Fit>| match model {
        Some(fit) if fit.is_rejected => format!("{:.1} %: rejected", fit.model_error * 100.0),
        Some(fit) if units::is_without_misfit(fit) => "none found".to_owned(),
        Some(fit) => format!("{:.1} %", fit.model_error * 100.0),
        None => "no model".to_owned(),
    };
    rows.push(row("misfit of the model".to_owned(), models.iter().map(error), ""));
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

/// The cell of an axis that lacks the value.
const NONE: &str = "–";

fn head(title: &str, group: &Group<'_>) -> Vec<String> {
    row(title.to_owned(), group.names().into_iter(), "unit")
}

fn row(title: String, cells: impl Iterator<Item = String>, unit: &str) -> Vec<String> {
    std::iter::once(title).chain(cells).chain([unit.to_owned()]).collect()
}

/// The rows of Gauss–Markov terms, two for each term of an axis.
fn gauss_markov(group: &Group<'_>) -> Vec<Vec<String>> {
    let of = |record: &Record| -> Vec<GaussMarkov> {
        record.valid_model().map_or_else(|_| Vec::new(), |fit| units::gauss_markov(fit, record.quantity).collect())
    };
    let all: Vec<_> = group.records.iter().map(of).collect();
    let rows = (0..all.iter().map(Vec::len).max().unwrap_or(0)).flat_map(|index| {
        let cells = |stated: fn(&GaussMarkov) -> Estimate| {
            let cell = move |terms: &Vec<GaussMarkov>| {
                terms.get(index).map_or_else(|| NONE.to_owned(), |term| units::stated(stated(term), true))
            };
            all.iter().map(cell)
        };
        let unit = all.iter().find_map(|terms| terms.get(index)).map_or("", |term| &*term.unit);
        [
            row("Gauss–Markov σ".to_owned(), cells(|term| term.sigma), unit),
            row("its correlation time".to_owned(), cells(|term| term.tau_s), "s"),
        ]
    });
    rows.collect()
}

/// The table of spectral lines by frequency. Lines that lie side by side share a row, which sums up those of each
/// axis.
fn lines(group: &Group<'_>) -> Table {
    let of_axis = |(axis, record)| Record::lines(record).map(move |line| (axis, line));
    let mut found: Vec<(usize, &Line)> = group.records.iter().enumerate().flat_map(of_axis).collect();
    found.sort_by(|(_, a), (_, b)| a.frequency_hz.total_cmp(&b.frequency_hz));
    let is_beside = |(_, a): &(usize, &Line), (_, b): &(usize, &Line)| {
        b.frequency_hz - a.frequency_hz <= (0.5 * a.width_hz.max(b.width_hz)).max(BESIDE * a.frequency_hz)
    };
    let stretch = |lines: &[(usize, &Line)]| {
        let strongest = lines.iter().max_by(|(_, a), (_, b)| a.rms.total_cmp(&b.rms));
        let frequency = strongest.map(|(_, line)| format!("{:.4} Hz", line.frequency_hz)).unwrap_or_default();
        let cell = |axis| {
            let of_axis = || lines.iter().filter(move |(of, _)| *of == axis);
            let rms = of_axis().map(|(_, line)| line.rms * line.rms).sum::<f64>().sqrt();
            match of_axis().count() {
                0 => NONE.to_owned(),
                1 => number(rms),
                count => format!("{} ({count})", number(rms)),
            }
        };
        row(frequency, (0..group.records.len()).map(cell), &format!("{} rms", group.unit()))
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

/// Lines closer than this share of their frequency are one line to a reader.
const BESIDE: f64 = 0.01;

fn section(record: &Record) -> report::Record {
    let analysis = &record.analysis;
    let model = record.model().map(|fit| Fact::new("noise model", units::misfit(fit)));
    let holds = record.max_freq_hz().map(|hz| Fact::new("it holds below", format!("{} Hz", number(hz))));
    let facts = [
        Fact::new("samples", analysis.samples.to_string()),
        Fact::new("missing", analysis.missing.to_string()),
        Fact::new("sample rate", format!("{:.6} Hz", analysis.rate_hz)),
        Fact::new("length", units::span(analysis.samples as f64 / analysis.rate_hz)),
    ];
    let row = |point: &zerorate_allan::Point| {
        let &zerorate_allan::Point { tau_s, dev, lo, hi, edf, alpha, n, .. } = point;
        AllanRow { tau_s, dev, lo, hi, edf, n, noise: noise(alpha, record.quantity).to_owned() }
    };
    let unavailable = |missing: &zerorate_allan::Unavailable| {
        Fact::new(format!("{} s", number(missing.tau_s)), missing.reason.to_string())
    };
    report::Record {
        name: record.label(),
        unit: deviation_unit(record).unwrap_or_default().to_owned(),
        facts: facts.into_iter().chain(model).chain(holds).collect(),
        warnings: warnings::of_record(record),
        advice: advice(record),
        coefficients: units::term_rows(record).into_iter().map(coefficient).collect(),
        points: analysis.points.iter().map(row).collect(),
        unavailable: analysis.unavailable.iter().map(unavailable).collect(),
    }
}

fn coefficient(row: units::TermRow) -> Coefficient {
    let value = |(interval, unit): (Interval, String)| CoefficientValue {
        value: interval.value(),
        limits: interval.limits(),
        unit,
    };
    Coefficient { name: row.name, values: row.values.into_iter().map(value).collect(), remark: row.remark }
}
