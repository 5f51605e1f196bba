//! The result as a picture.

use super::record::Record;
use super::units::{self, Named, coefficients, deviation_unit};
use crate::exit::Usage;
use crate::output::Staged;
use anyhow::Result;
use std::path::Path;
use zerorate::allan::{Expected, Term};
use zerorate_view::plot::{self, Curve, Minimum, PowerLaw, number};

/// Form of a picture.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Svg,
    Png,
}

impl Kind {
    /// As the name says.
    pub fn of(path: &Path) -> Result<Self, Usage> {
        match path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("svg") => Ok(Self::Svg),
            Some("png") => Ok(Self::Png),
            _ => Err(Usage(format!("{}: a picture must end in .svg or .png", path.display()))),
        }
    }
}

/// Writes a picture in its form.
pub fn write(kind: Kind, file: Staged, svg: &str) -> Result<()> {
    match kind {
        Kind::Svg => Ok(file.fill(svg.as_bytes())?),
        Kind::Png => Ok(file.fill(&plot::png(svg)?)?),
    }
}

/// The picture of all records. The fit is one of Allan deviations, so another statistic is drawn without it.
pub fn svg(records: &[Record]) -> String {
    let curves: Vec<Curve> = records.iter().map(curve).collect();
    let quantity = records.first().map(Record::title).unwrap_or_default().to_owned();
    let unit = records.first().and_then(deviation_unit).unwrap_or_default();
    let title = match records {
        [only] => Some(only.label()),
        _ => None,
    };
    let subtitle = records.first().map(subtitle);
    let marks = if records.iter().any(Record::is_of_adis16130) { plot::an1042() } else { Vec::new() };
    plot::allan(
        &curves,
        &plot::Options { title, subtitle, quantity, unit: unit.to_owned(), marks, ..plot::Options::default() },
    )
}

/// What is drawn, and what was left out of it.
fn subtitle(record: &Record) -> String {
    let mut text = format!("{}, {}", record.title(), units::interval(record.confidence));
    let Some(fit) = record.model() else { return text };
    let lines = fit.terms.iter().filter(|term| matches!(term, Term::Line(_))).count();
    let (glitches, steps) = (fit.cleaned.glitches as usize, fit.cleaned.steps.len());
    let counted = [
        (glitches, "glitch out", "glitches out"),
        (steps, "step out", "steps out"),
        (lines, "line masked", "lines masked"),
    ];
    for (count, one, more) in counted.into_iter().filter(|(count, ..)| *count > 0) {
        text += &format!(", {count} {}", if count == 1 { one } else { more });
    }
    text
}

fn curve(record: &Record) -> Curve {
    let points = record.drawn().points.iter();
    let points = points.map(|point| plot::Point { tau_s: point.tau_s, dev: point.dev, lo: point.lo, hi: point.hi });
    let found = coefficients(record).into_iter().filter(|_| record.analysis.stat.is_allan());
    let law = |named: Named<'_>| {
        let value = named.in_unit(0).value;
        let floor = if named.letter == 'B' { ", drawn at 0.664 B" } else { "" };
        let doubt = if named.coefficient.identified { "" } else { " (not identified)" };
        PowerLaw {
            label: format!("{} = {} {}{floor}{doubt}", named.letter, number(value), named.units[0].0),
            at_1s: named.coefficient.value * named.at_1s,
            slope: named.slope,
        }
    };
    let laws = found.filter(|named| named.coefficient.value > 0.0).map(law).collect();
    let minimum = record.minimum().map(|(tau_s, dev)| Minimum { tau_s, dev });
    let expected = record.drawn().points.iter().filter_map(|point| {
        let Expected { dev, lo, hi } = record.model()?.expected(record.drawn(), point)?;
        Some(plot::Point { tau_s: point.tau_s, dev, lo, hi })
    });
    Curve { label: record.label(), points: points.collect(), model: expected.collect(), laws, minimum }
}
