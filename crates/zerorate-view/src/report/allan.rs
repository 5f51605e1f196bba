//! The HTML page of an Allan analysis.

mod tables;

use super::Fact;
use crate::noise::{self, Group, TermRow, holds_below, misfit, removed, term_rows};
use crate::plot::number;
use crate::printable;
use anyhow::Result;
use askama::Template;
use zerorate_allan::span;
use zerorate_imu::{AllanReport, PointReport, Record};

/// The content of the page.
#[derive(Default)]
pub struct AllanPage<'a> {
    /// The heading.
    pub title: String,
    /// The command line that made the page.
    pub command: String,
    /// Facts about the log as a whole.
    pub facts: Vec<Fact>,
    /// Warnings about several axes.
    pub warnings: Vec<String>,
    /// Tables about the whole log, such as the comparison with a data sheet.
    pub tables: Vec<Table>,
    /// A record for each file or axis.
    pub records: &'a [Record],
}

/// A table of texts and numbers.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The heading above the table.
    pub title: String,
    /// The heads of the columns.
    pub head: Vec<String>,
    /// The rows of cells. The first cell names the row.
    pub rows: Vec<Vec<String>>,
    /// The note below the table.
    pub note: String,
}

/// The part of the page about the records of one quantity.
struct Section {
    /// The heading; no heading if empty.
    name: &'static str,
    tables: Vec<Table>,
    /// The plots as SVG, which the page includes unchanged.
    pictures: Vec<String>,
}

impl Section {
    /// Makes the section of a group. It has tables only if the page has several records, because a single record has
    /// tables of its own.
    fn new(group: &Group<'_>, is_one_of_several: bool) -> Self {
        let tables = match is_one_of_several {
            true => [tables::by_axis(group), tables::lines(group)].into(),
            false => Vec::new(),
        };
        Self {
            name: if is_one_of_several { group.heading() } else { "" },
            tables: tables.into_iter().filter(|table| !table.rows.is_empty()).collect(),
            pictures: group.pictures().into_iter().map(|picture| picture.svg).collect(),
        }
    }
}

struct Single {
    name: String,
    facts: Vec<Fact>,
    terms: Vec<TermRow>,
    unavailable: Vec<Fact>,
    report: AllanReport,
}

impl Single {
    fn new(report: AllanReport) -> Self {
        let facts = [
            Fact::new("samples", report.samples.to_string()),
            Fact::new("missing", report.missing.to_string()),
            Fact::new("sample rate", format!("{:.6} Hz", report.rate_hz)),
            Fact::new("length", span(report.samples as f64 / report.rate_hz)),
        ];
        let model = report.valid_model().map(|fit| Fact::new("noise model", misfit(fit)));
        let removed = removed(&report).into_iter().map(|text| Fact::new("removed before", text));
        let holds = holds_below(&report).map(|hz| Fact::new("it holds below", format!("{} Hz", number(hz))));
        let unavailable = report.unavailable.iter();
        Self {
            name: report.label(),
            facts: facts.into_iter().chain(removed).chain(model).chain(holds).collect(),
            terms: term_rows(&report),
            unavailable: unavailable.map(|at| Fact::new(format!("{} s", number(at.tau_s)), &*at.reason)).collect(),
            report,
        }
    }

    fn unit(&self) -> &str {
        self.report.unit.unwrap_or_default()
    }

    /// True if the table also has values in °/h.
    fn is_hourly(&self) -> bool {
        self.unit() == "°/s"
    }

    /// The cells of a table row, in the order of the table's head.
    fn cells(&self, point: &PointReport) -> Vec<String> {
        let interval = format!("{} … {}", number(point.lo), number(point.hi));
        let per_hour = self.is_hourly().then(|| number(point.dev * 3600.0));
        let left = [six_digits(point.tau_s), number(point.dev), interval].into_iter();
        left.chain(per_hour).chain([number(point.edf), point.n.to_string()]).collect()
    }
}

/// Formats an averaging time with six digits: 10.24, not 10.2.
fn six_digits(value: f64) -> String {
    format!("{value:.5e}").parse().unwrap_or(value).to_string()
}

#[derive(Template)]
#[template(path = "allan.html")]
struct Page<'a> {
    title: &'a str,
    software: &'a str,
    page: &'a AllanPage<'a>,
    /// The quantity in the tables, such as `overlapping Allan deviation`.
    quantity: &'a str,
    /// The kind of the deviations' intervals, such as `68.3 % intervals`.
    interval: String,
    sections: Vec<Section>,
    records: Vec<Single>,
}

/// Makes the page as HTML.
///
/// # Errors
/// Returns an error if the template cannot be filled. That is not expected, since the compiler checks the template.
pub fn allan_page(page: &AllanPage<'_>) -> Result<String> {
    let (records, first) = (page.records, page.records.first());
    let sections = Group::all(records);
    let page = Page {
        title: &page.title,
        software: zerorate::SOFTWARE,
        page,
        quantity: first.map(Record::title).unwrap_or_default(),
        interval: first.map(|record| noise::interval(record.confidence)).unwrap_or_default(),
        sections: sections.iter().map(|group| Section::new(group, records.len() > 1)).collect(),
        records: records.iter().map(|record| Single::new(AllanReport::new(record))).collect(),
    };
    Ok(printable::page(&page.render()?))
}
