//! The result as a picture.

use super::record::Record;
use super::units::{self, Named, coefficients, deviation_unit};
use crate::exit::Usage;
use crate::output::Staged;
use anyhow::Result;
use std::path::Path;
use zerorate::allan::{Expected, Fit, Line, Term};
use zerorate_data::column::Quantity;
use zerorate_view::plot::{self, Curve, Minimum, PowerLaw, Signal, Spectrum, Tone, number};

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

/// Whether these are columns of one log.
pub fn are_axes(records: &[Record]) -> bool {
    records.len() > 1 && records.windows(2).all(|pair| pair[0].file == pair[1].file)
}

/// What tells a record from the others in a picture.
pub fn name(records: &[Record], record: &Record) -> String {
    if are_axes(records) { record.column.clone() } else { record.label() }
}

/// What records of a quantity are of.
pub fn heading(records: &[Record]) -> &'static str {
    match records.first().and_then(|record| record.quantity) {
        Some(Quantity::AngularRate) => "Gyroscope",
        Some(Quantity::Acceleration) => "Accelerometer",
        Some(Quantity::Temperature) => "Temperature",
        None => "Of no stated unit",
    }
}

/// The unit of what was recorded.
pub fn unit(record: &Record) -> &'static str {
    record.quantity.map_or("unit", Quantity::unit)
}

/// A panel for each of several axes.
pub fn multiples(records: &[Record]) -> String {
    let short = |record: &Record| {
        let mut curve = curve(record);
        curve.label = name(records, record);
        for (law, named) in curve.laws.iter_mut().zip(drawn(record)) {
            let (letter, unit) = (named.letter, &named.units[0].0);
            law.label = match named.coefficient.identified {
                true => format!("{letter} {} {unit}", number(named.in_unit(0).value)),
                false => format!("{letter} < {} {unit}", number(named.in_unit(0).hi)),
            };
        }
        curve
    };
    let curves: Vec<Curve> = records.iter().map(short).collect();
    let interval = records.first().map(|record| units::interval(record.confidence)).unwrap_or_default();
    let options = plot::Options {
        title: Some(format!("{}: {}", heading(records), records.first().map(Record::title).unwrap_or_default())),
        subtitle: Some(format!("{interval}; black: the model and its 95 % band; B is drawn at 0.664 B")),
        quantity: "deviation".to_owned(),
        unit: records.first().and_then(deviation_unit).unwrap_or_default().to_owned(),
        marks: if records.iter().any(Record::is_of_adis16130) { plot::an1042() } else { Vec::new() },
        ..plot::Options::default()
    };
    plot::allan_multiples(&curves, &options)
}

/// The spectra, where all records have one.
pub fn spectra(records: &[Record]) -> Option<String> {
    let unit = records.first().map(unit)?;
    let amplitude = |density: f64| (2.0 * density).sqrt();
    let spectrum = |record: &Record| {
        let look = record.look.as_ref().filter(|look| !look.spectrum.is_empty())?;
        let points = look.spectrum.iter().map(|one| (one.frequency_hz, amplitude(one.density)));
        let rate_hz = record.analysis.rate_hz;
        let model = |fit: &Fit| {
            let of_model = |hz: f64| (hz, amplitude(fit.density(hz, rate_hz)));
            look.spectrum.iter().step_by(3).map(|one| of_model(one.frequency_hz)).collect()
        };
        let tone = |term: &Term| match term {
            &Term::Line(Line { frequency_hz, rms, .. }) => Some(Tone {
                frequency_hz,
                rms,
                label: format!("{} Hz, {} {unit} rms", number(frequency_hz), number(rms)),
            }),
            _ => None,
        };
        let terms = record.model().map_or(&[][..], |fit| &fit.terms);
        Some(Spectrum {
            label: name(records, record),
            points: points.collect(),
            model: record.model().map(model).unwrap_or_default(),
            tones: terms.iter().filter_map(tone).collect(),
        })
    };
    let all: Vec<Spectrum> = records.iter().map(spectrum).collect::<Option<_>>()?;
    Some(plot::spectra(&format!("{}: spectrum", heading(records)), &all, &format!("{unit}/√Hz")))
}

/// The records over time, where they were kept.
pub fn signals(records: &[Record]) -> Option<String> {
    let signal = |record: &Record| {
        let steps = record.model().map_or(&[][..], |fit| &fit.cleaned.steps);
        Some(Signal {
            label: name(records, record),
            envelope: record.look.as_ref()?.envelope.clone(),
            marks_s: steps.iter().map(|step| step.at_s).collect(),
        })
    };
    let all: Vec<Signal> = records.iter().map(signal).collect::<Option<_>>()?;
    Some(plot::signals(&format!("{}: the record", heading(records)), &all, records.first().map(unit)?))
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
    let laws = drawn(record).into_iter().map(law).collect();
    let minimum = record.minimum().map(|(tau_s, dev)| Minimum { tau_s, dev });
    let expected = record.drawn().points.iter().filter_map(|point| {
        let Expected { dev, lo, hi } = record.model()?.expected(record.drawn(), point)?;
        Some(plot::Point { tau_s: point.tau_s, dev, lo, hi })
    });
    Curve { label: record.label(), points: points.collect(), model: expected.collect(), laws, minimum }
}

/// The coefficients that have a line: of Allan deviations, and above zero.
fn drawn(record: &Record) -> Vec<Named<'_>> {
    let is_drawn = |named: &Named<'_>| record.analysis.stat.is_allan() && named.coefficient.value > 0.0;
    coefficients(record).into_iter().filter(is_drawn).collect()
}
