//! Plots of several lines over one quantity: one panel per case, with the same lines in each.

use super::allan::COLOURS;
use super::axes::{Axis, range};
use super::canvas::{self, Anchor, INK, SMALL, clipped, line, path, stroke};
use super::stack::Stack;
use svg::node::element::Group;

/// The texts and the panels of a plot of lines.
#[derive(Clone, Debug, Default)]
pub struct Lines {
    /// The heading.
    pub title: String,
    /// Names of the lines, the same in each panel.
    pub names: Vec<String>,
    /// Label of the horizontal axis.
    pub x_name: String,
    /// Label of the vertical axes.
    pub y_name: String,
    /// True if the vertical axes are logarithmic. If so, values at or below zero are left out.
    pub is_log: bool,
    /// A reference value, drawn as a dashed line.
    pub rule: Option<f64>,
    /// The panels, from top to bottom.
    pub panels: Vec<Panel>,
}

/// The panel of one case.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// The name of the case.
    pub label: String,
    /// The points of each line, in the order of the names; empty lines are left out.
    pub lines: Vec<Vec<(f64, f64)>>,
}

const HEIGHT: f64 = 170.0;
/// The baseline of the legend and the length of its samples, pixels.
const NAMES: f64 = 49.0;
const SAMPLE: f64 = 22.0;

/// Draws the plot as SVG, with all panels on one scale.
#[must_use]
pub fn lines(lines: &Lines) -> String {
    let stack = Stack {
        title: &lines.title,
        subtitle: "",
        x_name: &lines.x_name,
        y_name: &lines.y_name,
        panels: lines.panels.len(),
        height: HEIGHT,
    };
    let (x_range, y_range) = lines.ranges();
    let x = Axis::linear(x_range.0, x_range.1, stack.across());
    let mut paper = stack.paper().add(lines.legend(stack.across().0));
    for (index, panel) in lines.panels.iter().enumerate() {
        let upright = stack.upright(index);
        let y = if lines.is_log {
            Axis::log(y_range.0, y_range.1, upright)
        } else {
            Axis::linear(y_range.0, y_range.1, upright)
        };
        let area = stack.area(index);
        let mut inside = clipped(&area);
        if let Some(rule) = lines.rule {
            let at = y.at(rule);
            inside =
                inside.add(line((area.left, at), (area.right, at)).set("stroke", INK).set("stroke-dasharray", "6 4"));
        }
        for (points, colour) in panel.lines.iter().zip(COLOURS.into_iter().cycle()) {
            let drawn = points.iter().filter(|point| lines.shows(point)).map(|(to, value)| (x.at(*to), y.at(*value)));
            inside = inside.add(stroke(path(drawn), colour, 1.8));
        }
        paper = paper.add(stack.frame(index, &x, &y)).add(inside).add(stack.name(index, &panel.label).0);
    }
    paper.to_string()
}

impl Lines {
    fn shows(&self, (x, y): &(f64, f64)) -> bool {
        x.is_finite() && y.is_finite() && (!self.is_log || *y > 0.0)
    }

    /// The ranges of all points and the reference value; on linear vertical axes with space for the panels' names.
    fn ranges(&self) -> ((f64, f64), (f64, f64)) {
        let points = || {
            let points = self.panels.iter().flat_map(|panel| panel.lines.iter().flatten());
            points.copied().filter(|point| self.shows(point))
        };
        let x = range(points().map(|point| point.0)).unwrap_or((1.0, 1.0));
        let (low, high) = range(points().map(|point| point.1).chain(self.rule)).unwrap_or((1.0, 1.0));
        let room = 0.05 * (high - low);
        (x, if self.is_log { (low, high) } else { (low - room, high + 4.0 * room) })
    }

    fn legend(&self, left: f64) -> Group {
        let mut at = left;
        let name = |(name, colour): (&String, &'static str)| {
            let (from, y) = (at, NAMES - 4.0);
            at += SAMPLE + canvas::width(name, SMALL) + 28.0;
            let sample = line((from, y), (from + SAMPLE, y)).set("stroke", colour).set("stroke-width", 3);
            Group::new().add(sample).add(canvas::text(name, (from + SAMPLE + 6.0, NAMES), Anchor::Start))
        };
        self.names.iter().zip(COLOURS.into_iter().cycle()).map(name).fold(Group::new(), Group::add)
    }
}
