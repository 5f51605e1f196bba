//! The findings about several axes: a line for each kind of finding, the important ones first.

use super::units::{deviation_unit, span};
use super::{picture, temperature};
use zerorate_allan::{AllanWarning, LONGEST_RECORD_S, Misfit};
use zerorate_logs::{LogWarning, Record};
use zerorate_view::plot::number;

/// Codes of findings, the most damaging first. Findings with other codes come before all: they concern the log.
const BY_WEIGHT: [&str; 18] = [
    "model-rejected",
    "follows-temperature",
    "short-record",
    "leakage",
    "off-curve",
    "many-steps",
    "step",
    "glitches",
    "warm-up",
    "drift",
    "unsteady",
    "gaps",
    "lines",
    "memory-or-filter",
    "memory-or-flicker",
    "drift-or-walk",
    "quantisation-limited",
    "not-identified",
];

/// No line about several axes is longer.
const MOST_CHARS: usize = 100;

/// One kind of finding, with the axes that have it.
struct Finding {
    weight: usize,
    /// Identifies the kind: the code of a finding about the model, or a whole text.
    key: String,
    /// The axes, each with its numbers.
    axes: Vec<(String, Vec<String>)>,
    /// Its meaning, and what to do.
    meaning: String,
    /// The same for a single axis, with the name of the axis.
    of_one: Option<String>,
}

/// Formats the findings of all records, a line for each kind.
pub fn condensed(records: &[Record]) -> Vec<String> {
    let mut all: Vec<Finding> = Vec::new();
    let mut add = |finding: Finding| match all.iter_mut().find(|one| one.key == finding.key) {
        Some(same) => same.join(finding),
        None => all.push(finding),
    };
    let is_of_one_log = records.len() == 1 || picture::are_axes(records);
    for record in records {
        let name = picture::name(is_of_one_log, record);
        let follows = record.follows.as_ref().map(temperature::text);
        let of_log = record.notes.iter().map(LogWarning::coded).chain(follows);
        let column = format!("column {}", record.column);
        let whole = |text: String| {
            let meaning = text.replace(&column, "these columns");
            Finding {
                weight: 0,
                key: meaning.clone(),
                axes: vec![(name.clone(), Vec::new())],
                of_one: (meaning != text).then_some(text),
                meaning,
            }
        };
        of_log.map(whole).for_each(&mut add);
        record.of_model().iter().map(|warning| Finding::of(record, &name, warning)).for_each(&mut add);
    }
    all.sort_by_key(|finding| finding.weight);
    all.into_iter().map(|finding| finding.line(records.len())).collect()
}

impl Finding {
    fn of(record: &Record, name: &str, warning: &AllanWarning) -> Self {
        let unit = deviation_unit(record).unwrap_or("of its unit");
        let (detail, meaning) = condensed_words(warning, unit);
        let code = warning.code();
        let weight = BY_WEIGHT.iter().position(|known| *known == code).map_or(0, |place| place + 1);
        let axes = vec![(name.to_owned(), Some(detail).filter(|detail| !detail.is_empty()).into_iter().collect())];
        Self { weight, key: code.to_owned(), axes, meaning: format!("{code}: {meaning}"), of_one: None }
    }

    /// Adds a finding of the same kind, about the same or another axis.
    fn join(&mut self, other: Self) {
        for (name, details) in other.axes {
            match self.axes.iter_mut().find(|(known, _)| *known == name) {
                Some((_, known)) => known.extend(details),
                None => self.axes.push((name, details)),
            }
        }
    }

    fn line(&self, axes: usize) -> String {
        let Self { meaning, of_one, .. } = self;
        let is_of_log = self.axes.len() == axes && self.key == self.meaning;
        match of_one {
            Some(text) if self.axes.len() == 1 => text.clone(),
            // a finding that all axes share concerns the log
            None if is_of_log => meaning.clone(),
            _ => self.with_axes(),
        }
    }

    /// Names the axes, with as much about them as a line has room for.
    fn with_axes(&self) -> String {
        let Self { meaning, axes, .. } = self;
        let named = |(name, details): &(String, Vec<String>)| match details.is_empty() {
            true => name.clone(),
            false => format!("{name} ({})", details.join("; ")),
        };
        let whole = axes.iter().map(named).collect::<Vec<_>>().join(", ");
        let first = axes.first().map(named).unwrap_or_default();
        let one = format!("{first} and {} more", axes.len().saturating_sub(1));
        let lines = [whole, one].map(|axes| format!("{meaning}: {axes}"));
        let has_details = axes.iter().any(|(_, details)| !details.is_empty());
        let fits = |line: &String| !has_details || line.chars().count() <= MOST_CHARS;
        let short = lines.into_iter().find(fits);
        short.unwrap_or_else(|| format!("{meaning}: {} columns", axes.len()))
    }
}

fn said(detail: String, meaning: &str) -> (String, String) {
    (detail, meaning.to_owned())
}

/// The numbers of one axis, and their meaning on any axis.
fn condensed_words(warning: &AllanWarning, unit: &str) -> (String, String) {
    match *warning {
        AllanWarning::Rejected { error, most, misfit: Misfit { from_hz, to_hz, .. } } => (
            format!("off by {:.0} %, {from_hz:.3} to {to_hz:.3} Hz", error * 100.0),
            format!("off by more than {:.0} %, so not a result; look for motion", most * 100.0),
        ),
        AllanWarning::ShortRecord { samples, needed } => (
            format!("{samples} samples"),
            format!("too few samples, N may be off by a quarter; record {needed} or more"),
        ),
        AllanWarning::Leakage { frequency_hz, share } => said(
            format!("{frequency_hz:.3} Hz, up to {:.0} %", share * 100.0),
            "a strong line leaks into the fitted noise; record without it",
        ),
        AllanWarning::OffCurve { tau_s, ratio, octaves } => said(
            format!("{octaves} octaves, {ratio:.2} times at {}", span(tau_s)),
            "the curve leaves the model; do not use the model there",
        ),
        AllanWarning::FollowsTemperature { explained, span_c, .. } => said(
            format!("{:.0} % of the slow variance, over {span_c:.1} °C", explained * 100.0),
            "temperature drives slow variance (--detrend temp, --skip 45m)",
        ),
        AllanWarning::ManySteps { most } => {
            (String::new(), format!("more than {most} jumps of level, which K and B describe; look for knocks"))
        }
        AllanWarning::Step { at_s, size } => said(
            format!("{} {unit} at {at_s:.1} s", number(size)),
            "the level jumps and stays; taken out, look for a knock",
        ),
        AllanWarning::Glitches { glitches, samples, .. } => {
            said(format!("{glitches}, {samples} samples"), "knocks or bit errors; replaced by straight lines")
        }
        ref other => words_of_terms(other, unit),
    }
}

/// The same for findings about the terms of the model.
fn words_of_terms(warning: &AllanWarning, unit: &str) -> (String, String) {
    match *warning {
        AllanWarning::WarmUp { size, tau_s } => said(
            format!("{} {unit} in {}", number(size), span(tau_s)),
            "it hides K; let the sensor settle, or cut the beginning",
        ),
        AllanWarning::Drift { over_record, .. } => said(
            format!("{} {unit} in all", number(over_record)),
            "temperature or warm-up, which hides K; let the sensor settle",
        ),
        AllanWarning::Unsteady { tau_s, ratio } => {
            let noisier = if ratio > 1.0 { "first" } else { "second" };
            let detail = format!("{noisier} half {:.2} times, at {}", ratio.max(1.0 / ratio), span(tau_s));
            said(detail, "the halves differ; this record does not predict another")
        }
        AllanWarning::Gaps { missing, samples } => {
            said(format!("{missing} of {samples}"), "missing samples; allowed for if losses do not depend on the rate")
        }
        AllanWarning::Lines { count, frequency_hz, rms } => said(
            format!("{count}, strongest {frequency_hz:.3} Hz, {} {unit} rms", number(rms)),
            "disturbances or resonances, left out of N, B and K",
        ),
        AllanWarning::MemoryOrFlicker { .. } => {
            said(String::new(), "Gauss–Markov terms or B; do not extrapolate beyond a quarter")
        }
        AllanWarning::MemoryOrFilter { tau_s, n } => {
            said(format!("{}, N is then {}", span(tau_s), number(n)), "a memory may be a low-pass of white noise")
        }
        AllanWarning::DriftOrWalk { has_drift, .. } => said(
            if has_drift { "a drift was taken" } else { "a random walk was taken" }.to_owned(),
            "a record cannot tell drift from random walk; record again",
        ),
        AllanWarning::NotIdentified { noise, needed_s, .. } => {
            let letter = noise.name().rsplit(' ').next().unwrap_or_default();
            let detail = match needed_s <= LONGEST_RECORD_S {
                true => format!("{letter}, record {}", span(needed_s)),
                false => format!("{letter}, no record is long enough"),
            };
            said(detail, "cannot be told from zero in so short a record")
        }
        ref other => (String::new(), other.to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zerorate_allan::{Cause, Noise};

    /// Room for the number of columns, where nothing else fits.
    const ROOM: usize = ": 12 columns".len();

    #[test]
    fn a_finding_leaves_room_for_its_axes() {
        let noise = Noise::AngleRandomWalk;
        let misfit = Misfit { from_hz: 12.345, to_hz: 23.456, ratio: 1.23, cause: Cause::Resonance };
        let all = [
            AllanWarning::Rejected { error: 0.23, most: 0.1, misfit },
            AllanWarning::ShortRecord { samples: 1234, needed: 20_000 },
            AllanWarning::Leakage { frequency_hz: 123.456, share: 0.12 },
            AllanWarning::OffCurve { tau_s: 123.456, ratio: 1.23, octaves: 3 },
            AllanWarning::FollowsTemperature { explained: 0.93, slope: 1.2e-3, span_c: 12.3 },
            AllanWarning::ManySteps { most: 40 },
            AllanWarning::Step { at_s: 12345.6, size: -1.234e-3 },
            AllanWarning::Glitches { glitches: 123, samples: 1234, ratio: 1.2 },
            AllanWarning::WarmUp { size: -1.234e-3, tau_s: 1234.0 },
            AllanWarning::Drift { r: -1.2e-6, over_record: -1.2e-3 },
            AllanWarning::Unsteady { tau_s: 123.4, ratio: 0.8 },
            AllanWarning::Gaps { missing: 12345, samples: 12_345_678 },
            AllanWarning::Lines { count: 12, frequency_hz: 123.4, rms: 1.2e-3 },
            AllanWarning::MemoryOrFlicker { markovs: 2, others: 1, worse: 1.2 },
            AllanWarning::MemoryOrFilter { tau_s: 12.345, n: 1.234e-3 },
            AllanWarning::DriftOrWalk { has_drift: true, worse: 1.2 },
            AllanWarning::NotIdentified { noise, record_s: 1e4, needed_s: 6e5 },
        ];
        for warning in all {
            let line = format!("{}: {}", warning.code(), condensed_words(&warning, "°/s").1);
            assert!(line.chars().count() + ROOM <= MOST_CHARS, "{line}");
        }
    }
}
