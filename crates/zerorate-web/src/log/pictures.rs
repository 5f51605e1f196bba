//! The pictures of a log: for each kind of axis its curves, its spectra and its records.

use super::axis::coefficients;
use super::message::LogPicture;
use std::path::Path;
use zerorate_allan::{Fit, Line, Prediction};
use zerorate_imu::Named;
use zerorate_imu::{PlotData, Record};
use zerorate_logs::Quantity;
use zerorate_view::plot::{self, Curve, PowerLaw, Signal, Spectrum, Tone, number};

/// All pictures of a log.
pub fn of(path: &Path, axes: &[Record]) -> Vec<LogPicture> {
    let groups = axes.chunk_by(|a, b| a.quantity == b.quantity);
    groups.flat_map(|group| of_kind(path, group)).collect()
}

fn of_kind(path: &Path, axes: &[Record]) -> Vec<LogPicture> {
    let Some(first) = axes.first() else { return Vec::new() };
    let (word, heading) = match first.quantity {
        Some(Quantity::AngularRate) => ("gyroscope", "Gyroscope"),
        Some(Quantity::Acceleration) => ("accelerometer", "Accelerometer"),
        Some(Quantity::Temperature) => ("temperature", "Temperature"),
        None => ("columns", "Columns"),
    };
    let unit = first.quantity.map_or("unit", Quantity::unit);
    let picture =
        |what: &str, title: String, svg: String| LogPicture { name: format!("{word}-{what}.svg"), title, svg };
    let mut all = vec![picture("allan", format!("{heading}: Allan deviation"), curves(path, heading, unit, axes))];
    let spectra: Vec<Spectrum> = axes.iter().filter_map(|axis| spectrum(axis, unit)).collect();
    if !spectra.is_empty() {
        let title = format!("{heading}: spectrum");
        let svg = plot::spectra(&title, &spectra, &format!("{unit}/√Hz"));
        all.push(picture("spectrum", title, svg));
    }
    let title = format!("{heading}: the record");
    let signals: Vec<Signal> = axes.iter().map(signal).collect();
    let svg = plot::signals(&title, &signals, unit);
    all.push(picture("record", title, svg));
    all
}

fn curves(path: &Path, heading: &str, unit: &str, axes: &[Record]) -> String {
    let curves: Vec<Curve> = axes.iter().map(curve).collect();
    let options = plot::Options {
        title: Some(format!("{heading} in {}", path.display())),
        subtitle: Some(
            "one-sigma intervals (black: model, grey: 95 % of other records, dotted: of this; B is drawn at 0.664 B)"
                .to_owned(),
        ),
        unit: unit.to_owned(),
        ..plot::Options::default()
    };
    if curves.len() > 1 { plot::allan_multiples(&curves, &options) } else { plot::allan(&curves, &options) }
}

fn curve(axis: &Record) -> Curve {
    let points = axis.analysis.points.iter();
    let expected = axis.analysis.points.iter().filter_map(|point| {
        let Prediction { dev, lo, hi } = axis.expected(point)?;
        Some(plot::Point { tau_s: point.tau_s, dev, lo, hi })
    });
    let predicted = axis.analysis.points.iter().filter_map(|point| {
        let Prediction { dev, lo, hi } = axis.predicted(point)?;
        Some(plot::Point { tau_s: point.tau_s, dev, lo, hi })
    });
    let believed = if axis.valid_model().is_ok() { coefficients(axis) } else { Vec::new() };
    Curve {
        label: axis.column.clone(),
        points: points
            .map(|point| plot::Point { tau_s: point.tau_s, dev: point.dev, lo: point.lo, hi: point.hi })
            .collect(),
        model: expected.collect(),
        predicted: predicted.collect(),
        laws: believed.iter().map(law).collect(),
        minimum: None,
        remarks: Vec::new(),
    }
}

/// A law at its value, or at its upper limit if it is not identified.
fn law(named: &Named<'_>) -> PowerLaw {
    let (letter, unit, coefficient) = (named.letter, &named.units[0].0, named.coefficient);
    let (label, value) = match coefficient.identified {
        true => (format!("{letter} {} {unit}", number(named.in_unit(0).value)), coefficient.value),
        false => (format!("{letter} < {} {unit}", number(named.in_unit(0).hi)), coefficient.hi),
    };
    PowerLaw { label, at_1s: value * named.at_1s, slope: named.slope }
}

fn spectrum(axis: &Record, unit: &str) -> Option<Spectrum> {
    let amplitude = |density: f64| (2.0 * density).sqrt();
    let (PlotData { spectrum: all, .. }, rate_hz) = (axis.plot_data.as_ref()?, axis.analysis.rate_hz);
    let model = |fit: &Fit| {
        let of_model = |hz: f64| (hz, amplitude(fit.density(hz, rate_hz)));
        let holds = all.iter().filter(|one| one.frequency_hz <= fit.max_freq_hz);
        holds.step_by(3).map(|one| of_model(one.frequency_hz)).collect()
    };
    let tone = |&Line { frequency_hz, rms, .. }: &Line| {
        let label = format!("{} Hz, {} {unit} rms", number(frequency_hz), number(rms));
        Tone { frequency_hz, rms, label }
    };
    (!all.is_empty()).then(|| Spectrum {
        label: axis.column.clone(),
        points: all.iter().map(|one| (one.frequency_hz, amplitude(one.density))).collect(),
        model: axis.model().map(model).unwrap_or_default(),
        tones: axis.lines().map(tone).collect(),
    })
}

fn signal(axis: &Record) -> Signal {
    let steps = axis.model().map_or(&[][..], |fit| &fit.cleaned.steps);
    Signal {
        label: axis.column.clone(),
        envelope: axis.plot_data.as_ref().map(|look| look.envelope.clone()).unwrap_or_default(),
        marks_s: steps.iter().map(|step| step.at_s).collect(),
    }
}
