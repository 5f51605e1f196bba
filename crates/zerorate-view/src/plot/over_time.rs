//! Plots of several quantities over a common time axis, each in a panel with its own scale.

use super::allan::COLOURS;
use super::axes::{Axis, range_with_margins};
use super::canvas::{Area, clipped, path, rectangle, stroke};
use super::stack::Stack;

/// A quantity over time.
#[derive(Clone, Debug)]
pub struct Series {
    /// The name, with the unit.
    pub name: String,
    /// Time, s, and value of each point. Points whose value is not finite are left out.
    pub points: Vec<(f64, f64)>,
}

const HEIGHT: f64 = 120.0;

/// Draws the plot as SVG. `windows_s` holds the start and the end of spans of time, s, which are shaded.
#[must_use]
pub fn over_time(title: &str, all: &[Series], windows_s: &[(f64, f64)]) -> String {
    let ends = all.iter().flat_map(|one| one.points.iter().map(|point| point.0)).chain(windows_s.iter().map(|w| w.1));
    let end_s = ends.fold(0.0, f64::max);
    let (per_s, x_name) = if end_s <= 600.0 { (1.0, "time, s") } else { (1.0 / 60.0, "time, min") };
    let stack = Stack { title, subtitle: "", x_name, y_name: "", panels: all.len(), height: HEIGHT };
    let x = Axis::linear(0.0, end_s.max(1e-9) * per_s, stack.across());
    let mut paper = stack.paper();
    for (index, (one, colour)) in all.iter().zip(COLOURS.into_iter().cycle()).enumerate() {
        let finite = || one.points.iter().copied().filter(|(_, value)| value.is_finite());
        // space for the panel's name above the curve
        let (low, high) = range_with_margins(finite().map(|(_, value)| value), 0.05, 0.3);
        let y = Axis::linear(low, high, stack.upright(index));
        let area = stack.area(index);
        let shade = |&(from_s, to_s): &(f64, f64)| {
            let (left, right) = (x.at(from_s * per_s), x.at(to_s * per_s));
            // at least 2 pixels wide, since a window of seconds would be invisible in an hour
            rectangle(&Area { left, right: right.max(left + 2.0), ..area }).set("fill", "#bbbbbb").set("opacity", 0.5)
        };
        let line = stroke(path(finite().map(|(at_s, value)| (x.at(at_s * per_s), y.at(value)))), colour, 1.4);
        let inside = windows_s.iter().map(shade).fold(clipped(&area), svg::node::element::Group::add).add(line);
        paper = paper.add(stack.frame(index, &x, &y)).add(inside).add(stack.name(index, &one.name).0);
    }
    paper.to_string()
}
