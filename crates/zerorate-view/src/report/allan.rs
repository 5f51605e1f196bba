//! The page of an Allan analysis.

use super::Fact;
use crate::plot::number;
use crate::printable;
use anyhow::Result;
use askama::Template;

/// The content of the page.
#[derive(Clone, Debug, Default)]
pub struct AllanPage {
    /// The heading.
    pub title: String,
    /// The command line that made it.
    pub command: String,
    /// The quantity in the tables, such as `overlapping Allan deviation`.
    pub quantity: String,
    /// The kind of the deviations' intervals, such as `68.3 % interval`.
    pub interval: String,
    /// The kind of the coefficients' intervals.
    pub coefficient_interval: String,
    /// Facts about the log as a whole.
    pub facts: Vec<Fact>,
    /// Warnings that concern several axes.
    pub warnings: Vec<String>,
    /// Tables about the whole log, such as the comparison with a data sheet.
    pub tables: Vec<Table>,
    /// Records that belong together.
    pub groups: Vec<Group>,
    /// A record for each file or axis.
    pub records: Vec<Record>,
}

/// Records of one quantity.
#[derive(Clone, Debug, Default)]
pub struct Group {
    /// The heading; an empty name has none.
    pub name: String,
    /// Tables of the group, such as the coefficients by axis.
    pub tables: Vec<Table>,
    /// SVG as [`crate::plot`] makes it; the page includes it unchanged.
    pub pictures: Vec<String>,
}

/// A table of words and numbers.
#[derive(Clone, Debug, Default)]
pub struct Table {
    /// The heading above the table.
    pub title: String,
    /// Names of the columns.
    pub head: Vec<String>,
    /// Rows of cells; the first cell of a row names it.
    pub rows: Vec<Vec<String>>,
    /// The note below the table.
    pub note: String,
}

/// The results of one file or axis.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// The name of the file.
    pub name: String,
    /// The unit of the deviations; with °/s, the table also has °/h.
    pub unit: String,
    /// Facts of the record: column, samples, rate, losses.
    pub facts: Vec<Fact>,
    /// Warnings about the record or the result.
    pub warnings: Vec<String>,
    /// How to read the result.
    pub advice: Vec<String>,
    /// The coefficients of the fit, if there was one.
    pub coefficients: Vec<Coefficient>,
    /// The deviations, by averaging time.
    pub points: Vec<AllanRow>,
    /// Averaging times without a deviation, with the reason.
    pub unavailable: Vec<Fact>,
}

/// A noise coefficient in several units.
#[derive(Clone, Debug, Default)]
pub struct Coefficient {
    /// The name, such as `N, angle random walk`.
    pub name: String,
    /// The same value in each unit.
    pub values: Vec<CoefficientValue>,
    /// A remark such as `not identified: record 3 h`; it may be empty.
    pub remark: String,
}

/// A coefficient in one unit.
#[derive(Clone, Debug, Default)]
pub struct CoefficientValue {
    /// The value.
    pub value: String,
    /// Lower and upper end of its interval, where it has one.
    pub limits: Option<[String; 2]>,
    /// The unit.
    pub unit: String,
}

/// A deviation.
#[derive(Clone, Debug, Default)]
#[expect(missing_docs, reason = "as the fields of `zerorate_allan::Point`")]
pub struct AllanRow {
    pub tau_s: f64,
    pub dev: f64,
    pub lo: f64,
    pub hi: f64,
    pub edf: f64,
    pub n: u64,
    /// Name of the noise type.
    pub noise: String,
}

impl Record {
    fn hourly(&self) -> bool {
        self.unit == "°/s"
    }
}

impl AllanRow {
    /// The numbers of a row, in the order of the head of the table.
    fn cells(&self, hourly: bool) -> Vec<String> {
        let interval = format!("{} … {}", number(self.lo), number(self.hi));
        let per_hour = hourly.then(|| number(self.dev * 3600.0));
        let left = [six_digits(self.tau_s), number(self.dev), interval].into_iter();
        left.chain(per_hour).chain([number(self.edf), self.n.to_string()]).collect()
    }
}

/// Formats an averaging time exactly: 10.24, not 10.2.
fn six_digits(value: f64) -> String {
    format!("{value:.5e}").parse().unwrap_or(value).to_string()
}

#[derive(Template)]
#[template(path = "allan.html")]
struct Page<'a> {
    title: &'a str,
    software: &'a str,
    page: &'a AllanPage,
}

/// The page as HTML.
///
/// # Errors
/// No error is known, because the template is compiled.
pub fn allan_page(page: &AllanPage) -> Result<String> {
    let page = Page { title: &page.title, software: zerorate::SOFTWARE, page };
    Ok(printable::page(&page.render()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn page() -> AllanPage {
        let row =
            AllanRow { tau_s: 0.01, dev: 0.0937, lo: 0.09, hi: 0.1, edf: 1e6, n: 360_000, noise: "white".into() };
        let value = CoefficientValue {
            value: "0.557".into(),
            limits: Some(["0.55".into(), "0.56".into()]),
            unit: "°/√h".into(),
        };
        let record = Record {
            name: "<img src=x onerror=alert(1)>.csv".into(),
            facts: vec![Fact::new("samples", "360000")],
            warnings: vec!["too <short>".into()],
            advice: vec!["average for 46 s".into()],
            coefficients: vec![Coefficient { name: "N".into(), values: vec![value], remark: "identified".into() }],
            points: vec![row],
            unit: "°/s".into(),
            unavailable: vec![Fact::new("4096 s", "the record is too short")],
        };
        let table = Table {
            title: "Beside <b>".into(),
            head: vec!["axis".into()],
            rows: vec![vec!["gyro x".into(), "<i>".into()]],
            note: "a note".into(),
        };
        let pictures = vec!["<svg><path/></svg>".into()];
        AllanPage {
            title: "of <u>".into(),
            facts: vec![Fact::new("length", "2.8 h")],
            warnings: vec!["three <axes>".into()],
            tables: vec![table.clone()],
            groups: vec![Group { name: "Gyroscope".into(), tables: vec![table], pictures }],
            command: "zerorate allan '\"><script>'".into(),
            quantity: "overlapping Allan deviation".into(),
            interval: "68.3 % interval".into(),
            coefficient_interval: "95 % interval".into(),
            records: vec![record],
        }
    }

    #[test]
    fn the_page_has_everything_and_escapes_what_others_named() {
        let html = allan_page(&page()).unwrap();
        for expected in [
            "<svg><path/></svg>",
            "360000",
            "average for 46 s",
            "0.557",
            "°/√h",
            "0.0937",
            "337", // °/h
            "the record is too short",
            "68.3 % interval",
            "<h2>Gyroscope</h2>",
            "2.8 h",
            "a note",
            "gyro x",
        ] {
            assert!(html.contains(expected), "{expected} in {html}");
        }
        for hostile in ["<img", "<script", "<short>", "<axes>", "<b>", "<i>", "<u>"] {
            assert!(!html.contains(hostile), "{hostile} in {html}");
        }
        assert!(!html.contains("http"), "no external resource");
    }
}
