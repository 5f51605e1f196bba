//! Plots of records over time, one panel per axis. Each short interval of time is drawn as the range from its smallest
//! to its largest sample.

use super::allan::COLOURS;
use super::axes::{Axis, number, range_with_margins};
use super::canvas::{clipped, line, path, px, stroke, with_unit};
use super::stack::Stack;
use svg::node::element::{Group, Path, path::Data};
use zerorate_allan::Envelope;

/// The record of one axis.
#[derive(Clone, Debug, Default)]
pub struct Signal {
    /// The name of the axis.
    pub label: String,
    /// The smallest and the largest sample in each interval of time.
    pub envelope: Envelope,
    /// Times at which steps were removed, s.
    pub marks_s: Vec<f64>,
}

const HEIGHT: f64 = 120.0;

/// Draws the records minus their means as SVG, in `unit` and on one common scale.
#[must_use]
pub fn signals(title: &str, signals: &[Signal], unit: &str) -> String {
    let span_s = signals.iter().map(|signal| signal.envelope.span_s).fold(0.0, f64::max);
    let (per_s, time) = match span_s {
        s if s <= 600.0 => (1.0, "time, s"),
        s if s <= 10_800.0 => (1.0 / 60.0, "time, min"),
        _ => (1.0 / 3600.0, "time, h"),
    };
    let is_marked = signals.iter().any(|signal| !signal.marks_s.is_empty());
    let marks = if is_marked { " (dashed: steps, taken out before the fit)" } else { "" };
    let stack = Stack {
        title,
        subtitle: &format!("minus its mean: smallest and largest sample of each pixel{marks}"),
        x_name: time,
        y_name: &with_unit("deviation from the mean", unit),
        panels: signals.len(),
        height: HEIGHT,
    };
    let x = Axis::linear(0.0, span_s * per_s, stack.across());
    let (low, high) = range(signals);
    let mut paper = stack.paper();
    for (index, (signal, colour)) in signals.iter().zip(COLOURS.into_iter().cycle()).enumerate() {
        let y = Axis::linear(low, high, stack.upright(index));
        let area = stack.area(index);
        let text = format!("{}, mean {} {unit}", signal.label, number(signal.envelope.mean));
        let (name, written) = stack.name(index, &text);
        let rules = signal.marks_s.iter().map(|at_s| {
            let at = x.at(at_s * per_s);
            let top = if at < written.right + 4.0 { written.bottom } else { area.top };
            line((at, top), (at, area.bottom)).set("stroke", "#222222").set("stroke-dasharray", "5 4")
        });
        let rules = rules.fold(Group::new(), Group::add);
        let band = clipped(&area).add(band(&signal.envelope, per_s, &x, &y, colour));
        paper = paper.add(stack.frame(index, &x, &y)).add(band).add(rules).add(name);
    }
    paper.to_string()
}

/// The range of all records minus their means, with space for the panels' names.
fn range(signals: &[Signal]) -> (f64, f64) {
    let ends = signals.iter().flat_map(|signal| {
        let mean = signal.envelope.mean;
        signal.envelope.stretches.iter().flatten().flat_map(move |(low, high)| [low - mean, high - mean])
    });
    range_with_margins(ends, 0.05, 0.3)
}

/// The filled area between smallest and largest samples. Gaps in the record interrupt it.
fn band(envelope: &Envelope, per_s: f64, x: &Axis, y: &Axis, colour: &str) -> Path {
    let Envelope { span_s, mean, stretches } = envelope;
    let width_s = span_s / stretches.len().max(1) as f64;
    let at = |index: usize| x.at((index as f64 + 0.5) * width_s * per_s);
    let tenth = |value: f64| (value * 10.0).round() / 10.0;
    let numbered: Vec<(usize, Option<(f64, f64)>)> = stretches.iter().copied().enumerate().collect();
    let mut all = Data::new();
    for run in numbered.split(|(_, ends)| ends.is_none()).filter(|run| !run.is_empty()) {
        let ends = || run.iter().filter_map(|(index, ends)| ends.map(|(low, high)| (*index, low - mean, high - mean)));
        let upper = ends().map(|(index, _, high)| (tenth(at(index)), tenth(y.at(high))));
        let lower = ends().rev().map(|(index, low, _)| (tenth(at(index)), tenth(y.at(low))));
        for command in path(upper.chain(lower)).close().iter() {
            all.append(command.clone());
        }
    }
    let width = px(0.8);
    stroke(all, colour, width).set("fill", colour).set("fill-opacity", 0.5)
}
