//! Plots of noise analyses.

use super::{GaussMarkov, are_axes, gauss_markov, interval, name};
use crate::plot::{self, Curve, Minimum, PowerLaw, Signal, Spectrum, Tone, number};
use zerorate_allan::{Fit, Line, Point, Prediction};
use zerorate_imu::{FitReport, Named, Record, coefficients};
use zerorate_logs::Quantity;

/// Draws all records in one plot. The fit describes Allan deviations, so other statistics are drawn without the fit.
#[must_use]
pub fn svg(records: &[Record]) -> String {
    let is_of_one_log = are_axes(records);
    let named = |record: &Record| Curve { label: name(is_of_one_log, record), ..curve(record) };
    let curves: Vec<Curve> = records.iter().map(named).collect();
    let quantity = records.first().map(Record::title).unwrap_or_default().to_owned();
    let unit = records.first().and_then(Record::deviation_unit).unwrap_or_default();
    let title = match records {
        [only] => Some(only.label()),
        [first, ..] if is_of_one_log => Some(first.file.display().to_string()),
        _ => None,
    };
    let subtitle = Some(subtitle(records)).filter(|text| !text.is_empty());
    plot::allan(
        &curves,
        &plot::Options {
            title,
            subtitle,
            quantity,
            unit: unit.to_owned(),
            marks: marks(records),
            ..plot::Options::default()
        },
    )
}

/// Draws the axes of an IMU in one picture, one plot per axis, gyroscopes above accelerometers.
#[must_use]
pub fn axes_svg(records: &[Record]) -> String {
    plot::stacked(&Group::all(records).iter().map(Group::multiples).collect::<Vec<_>>())
}

/// The averaging times of AN-1042, if a record is from an ADIS16130, which that note describes.
fn marks(records: &[Record]) -> Vec<plot::Mark> {
    if records.iter().any(Record::is_of_adis16130) { plot::an1042() } else { Vec::new() }
}

/// A plot of a group of records.
pub struct Picture {
    /// The kind of plot: `allan`, `spectrum` or `record`.
    pub what: &'static str,
    /// The plot as SVG.
    pub svg: String,
}

impl Picture {
    /// The title of this kind of plot.
    #[must_use]
    pub fn title(&self) -> &'static str {
        match self.what {
            "allan" => "Allan deviation",
            "spectrum" => "spectrum",
            _ => "the record",
        }
    }
}

/// Consecutive records of one quantity.
pub struct Group<'a> {
    /// One or more records, in the order of the logs.
    pub records: &'a [Record],
    is_of_one_log: bool,
}

impl<'a> Group<'a> {
    /// Groups consecutive records of one quantity.
    #[must_use]
    pub fn all(records: &'a [Record]) -> Vec<Self> {
        let is_of_one_log = are_axes(records);
        let groups = records.chunk_by(|a, b| a.quantity == b.quantity);
        groups.map(|records| Self { records, is_of_one_log }).collect()
    }

    /// The names that distinguish the records from each other.
    #[must_use]
    pub fn names(&self) -> Vec<String> {
        self.records.iter().map(|record| name(self.is_of_one_log, record)).collect()
    }

    /// The heading: the kind of sensor that the records come from, if their unit tells it.
    #[must_use]
    pub fn heading(&self) -> &'static str {
        match self.records.first().and_then(|record| record.quantity) {
            Some(Quantity::AngularRate) => "Gyroscope",
            Some(Quantity::Acceleration) => "Accelerometer",
            Some(Quantity::Temperature) => "Temperature",
            None => "Of no stated unit",
        }
    }

    /// The unit of the recorded quantity; `unit` if the quantity is unknown.
    #[must_use]
    pub fn unit(&self) -> &'static str {
        self.records.first().and_then(|record| record.quantity).map_or("unit", Quantity::unit)
    }

    /// Draws the deviations, and the spectra and the records over time if all records have them.
    #[must_use]
    pub fn pictures(&self) -> Vec<Picture> {
        let is_of_axes = self.is_of_one_log && self.records.len() > 1;
        let curves = if is_of_axes { self.multiples() } else { svg(self.records) };
        let drawn = [("allan", Some(curves)), ("spectrum", self.spectra()), ("record", self.signals())];
        drawn.into_iter().filter_map(|(what, svg)| Some(Picture { what, svg: svg? })).collect()
    }

    /// Draws the deviations of several axes, one plot each.
    fn multiples(&self) -> String {
        let panel = |(record, label): (&Record, String)| {
            let laws = valid_coefficients(record).iter().map(law).collect();
            Curve { label, laws, remarks: remarks(record), ..curve(record) }
        };
        let curves: Vec<Curve> = self.records.iter().zip(self.names()).map(panel).collect();
        let (first, heading) = (self.records.first(), self.heading());
        let interval = first.map(|record| interval(record.confidence)).unwrap_or_default();
        let has_memory = curves.iter().flat_map(|curve| &curve.remarks).any(|remark| remark.starts_with(MEMORY));
        let memory = if has_memory { ", GM: Gauss–Markov σ and time" } else { "" };
        let options = plot::Options {
            title: Some(format!("{heading}: {}", first.map(Record::title).unwrap_or_default())),
            subtitle: Some(format!(
                "coloured band: {interval}; black: the model; dashed: its terms, B at 0.664 B{memory}\n\
                 grey: where 95 % of other records should lie; dotted: where this one should"
            )),
            quantity: "deviation".to_owned(),
            unit: first.and_then(Record::deviation_unit).unwrap_or_default().to_owned(),
            marks: marks(self.records),
            ..plot::Options::default()
        };
        plot::allan_multiples(&curves, &options)
    }

    /// Draws the spectra, if all records have one.
    fn spectra(&self) -> Option<String> {
        let unit = self.unit();
        let spectrum = |(record, label)| spectrum(record, label, unit);
        let all: Vec<Spectrum> = self.records.iter().zip(self.names()).map(spectrum).collect::<Option<_>>()?;
        Some(plot::spectra(&format!("{}: spectrum", self.heading()), &all, &format!("{unit}/√Hz")))
    }

    /// Draws the records over time, if all of them kept the data for this plot.
    fn signals(&self) -> Option<String> {
        let signal = |(record, label): (&Record, String)| {
            let steps = record.model().map_or(&[][..], |fit| &fit.cleaned.steps);
            let envelope = record.plot_data.as_ref()?.envelope.clone();
            Some(Signal { label, envelope, marks_s: steps.iter().map(|step| step.at_s).collect() })
        };
        let all: Vec<Signal> = self.records.iter().zip(self.names()).map(signal).collect::<Option<_>>()?;
        Some(plot::signals(&format!("{}: the record", self.heading()), &all, self.unit()))
    }
}

fn spectrum(record: &Record, label: String, unit: &str) -> Option<Spectrum> {
    let amplitude = |density: f64| (2.0 * density).sqrt();
    let look = record.plot_data.as_ref().filter(|look| !look.spectrum.is_empty())?;
    let points = look.spectrum.iter().map(|one| (one.frequency_hz, amplitude(one.density)));
    let rate_hz = record.analysis.rate_hz;
    let model = |fit: &Fit| {
        let of_model = |hz: f64| (hz, amplitude(fit.density(hz, rate_hz)));
        let holds = look.spectrum.iter().filter(|one| one.frequency_hz <= fit.max_freq_hz);
        holds.step_by(3).map(|one| of_model(one.frequency_hz)).collect()
    };
    let tone = |&Line { frequency_hz, rms, .. }: &Line| {
        let label = format!("{} Hz, {} {unit} rms", number(frequency_hz), number(rms));
        Tone { frequency_hz, rms, label }
    };
    Some(Spectrum {
        label,
        points: points.collect(),
        model: record.model().map(model).unwrap_or_default(),
        tones: record.lines().map(tone).collect(),
    })
}

/// The line of a coefficient in a plot: at its value, or at its upper limit if it is not identified.
fn law(named: &Named<'_>) -> PowerLaw {
    let (letter, unit, coefficient) = (named.letter, &named.units[0].0, named.coefficient);
    let (label, value) = match coefficient.identified {
        true => (format!("{letter} {} {unit}", number(named.in_unit(0).value)), coefficient.value),
        false => (format!("{letter} < {} {unit}", number(named.in_unit(0).hi)), coefficient.hi),
    };
    PowerLaw { label, at_1s: value * named.at_1s, slope: named.slope }
}

/// The abbreviation of Gauss–Markov.
const MEMORY: &str = "GM";

/// The Gauss–Markov terms of the model, or a note that the model is missing or rejected.
fn remarks(record: &Record) -> Vec<String> {
    match (&record.fit, record.model()) {
        (None, _) => Vec::new(),
        (Some(_), None) => vec!["no model".to_owned()],
        (_, Some(fit)) if fit.motion_ratio.is_some() => vec!["rejected: the sensor moves".to_owned()],
        (_, Some(fit)) if fit.is_rejected => vec![format!("rejected: off by {:.0} %", fit.model_error * 100.0)],
        (_, Some(fit)) => {
            let text = |term: GaussMarkov| {
                format!("{MEMORY} {} {}, {} s", number(term.sigma.value), term.unit, number(term.tau_s.value))
            };
            gauss_markov(&FitReport::new(Some(fit), record.quantity)).map(text).collect()
        }
    }
}

fn subtitle(records: &[Record]) -> String {
    let Some(first) = records.first() else { return String::new() };
    let interval = interval(first.confidence);
    let mut text = if records.len() > 1 { interval } else { format!("{}, {interval}", first.title()) };
    let models = || records.iter().filter_map(Record::model);
    let counted = [
        (models().map(|fit| fit.cleaned.glitches as usize).sum(), "glitch out", "glitches out"),
        (models().map(|fit| fit.cleaned.steps.len()).sum(), "step out", "steps out"),
        (records.iter().flat_map(Record::lines).count(), "line masked", "lines masked"),
    ];
    for (count, one, more) in counted.into_iter().filter(|(count, ..)| *count > 0) {
        text += &format!(", {count} {}", if count == 1 { one } else { more });
    }
    match models().filter(|fit| fit.is_rejected).count() {
        0 => {}
        count if records.len() > 1 => text += &format!(", {count} of the models rejected"),
        _ if models().any(|fit| fit.motion_ratio.is_some()) => text += ", rejected: the sensor moves",
        _ => text += ", the model rejected",
    }
    if first.analysis.stat.is_allan() && models().next().is_some() {
        text += match records {
            [_] => "\ngrey: where 95 % of other records should lie; dotted: where this one should",
            _ => "\ndashed: the models, with bands where they expect 95 % of other records",
        };
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
    let above_zero = |named: &Named<'_>| named.coefficient.value > 0.0;
    let laws = valid_coefficients(record).into_iter().filter(above_zero).map(law).collect();
    let minimum = record.minimum().map(|(tau_s, dev)| Minimum { tau_s, dev });
    let band = |of: &dyn Fn(&Point) -> Option<Prediction>| {
        let at = |point: &Point| {
            of(point).map(|Prediction { dev, lo, hi }| plot::Point { tau_s: point.tau_s, dev, lo, hi })
        };
        record.drawn().points.iter().filter_map(at).collect()
    };
    let model = band(&|point| record.model()?.expected(record.drawn(), point));
    let (points, predicted) = (points.collect(), band(&|point| record.predicted(point)));
    Curve { label: record.label(), points, model, predicted, laws, minimum, remarks: Vec::new() }
}

/// The coefficients, if the statistic is an Allan deviation and the model is valid; empty otherwise.
fn valid_coefficients(record: &Record) -> Vec<Named<'_>> {
    match record.valid_model() {
        Ok(fit) if record.analysis.stat.is_allan() => coefficients(fit, record.quantity),
        _ => Vec::new(),
    }
}
