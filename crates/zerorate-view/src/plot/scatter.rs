//! Plot of dots with a curve and its band, one panel per axis of a sensor.

use super::axes::{Axis, range_with_margins};
use super::canvas::{self, Anchor, SMALL, clipped, path, px, stroke};
use super::stack::Stack;
use svg::node::element::path::Data;
use svg::node::element::{Circle, Group, Path};

/// The texts and the panels of a plot of dots.
#[derive(Clone, Debug, Default)]
pub struct Scatter {
    /// The heading.
    pub title: String,
    /// The line below the heading.
    pub subtitle: String,
    /// Label of the horizontal axis.
    pub x_name: String,
    /// The panels, from top to bottom. Each has its own vertical scale.
    pub panels: Vec<ScatterPanel>,
}

/// The panel of one axis.
#[derive(Clone, Debug, Default)]
pub struct ScatterPanel {
    /// The name of the axis, with its unit.
    pub label: String,
    /// The points to draw as dots.
    pub dots: Vec<Dot>,
    /// The points of the curve: x, y, and half width of the interval.
    pub curve: Vec<(f64, f64, f64)>,
}

/// A dot, coloured by warming or cooling.
#[derive(Clone, Copy, Debug)]
pub struct Dot {
    /// The position: x and y.
    pub at: (f64, f64),
    /// True if the sensor was warming.
    pub is_warming: bool,
}

const HEIGHT: f64 = 190.0;
const WARMING: &str = "#d55e00";
const COOLING: &str = "#0072b2";
const CURVE: &str = "#222222";
const DOT: f64 = 3.6;

/// Draws the plot as SVG.
#[must_use]
pub fn scatter(scatter: &Scatter) -> String {
    let Scatter { title, subtitle, x_name, panels } = scatter;
    let stack = Stack { title, subtitle, x_name, y_name: "", panels: panels.len(), height: HEIGHT };
    let places = panels.iter().flat_map(|panel| panel.dots.iter().map(|dot| dot.at.0));
    let (first, last) = range_with_margins(places, 0.0, 0.0);
    let x = Axis::linear(first, last, stack.across());
    let mut paper = stack.paper().add(legend(stack.across().1));
    for (index, panel) in panels.iter().enumerate() {
        let band = panel.curve.iter().flat_map(|(_, value, half)| [value - half, value + half]);
        let (low, high) = range_with_margins(panel.dots.iter().map(|dot| dot.at.1).chain(band), 0.08, 0.08);
        // space for the panel's name
        let high = high + 0.12 * (high - low);
        let y = Axis::linear(low, high, stack.upright(index));
        let [warming, cooling] = [true, false].map(|is_warming| dots(panel, is_warming, &x, &y));
        let inside = clipped(&stack.area(index)).add(cooling).add(warming).add(curve(panel, &x, &y));
        paper = paper.add(stack.frame(index, &x, &y)).add(inside).add(stack.name(index, &panel.label).0);
    }
    paper.to_string()
}

/// The dots of one colour, as one path of zero-length lines with round ends.
fn dots(panel: &ScatterPanel, is_warming: bool, x: &Axis, y: &Axis) -> Path {
    let colour = if is_warming { WARMING } else { COOLING };
    let all = panel.dots.iter().filter(|dot| dot.is_warming == is_warming);
    let point = |data: Data, dot: &Dot| data.move_to((px(x.at(dot.at.0)), px(y.at(dot.at.1)))).horizontal_line_by(0);
    let path = Path::new().set("d", all.fold(Data::new(), point)).set("fill", "none").set("stroke", colour);
    path.set("stroke-width", DOT).set("stroke-linecap", "round").set("stroke-opacity", 0.45)
}

fn curve(panel: &ScatterPanel, x: &Axis, y: &Axis) -> Group {
    let edge = |sign: f64| move |(at, value, half): &(f64, f64, f64)| (x.at(*at), y.at(value + sign * half));
    let outline = panel.curve.iter().map(edge(1.0)).chain(panel.curve.iter().rev().map(edge(-1.0)));
    let band = Path::new().set("d", path(outline).close()).set("fill", CURVE).set("fill-opacity", 0.18);
    match panel.curve.is_empty() {
        true => Group::new(),
        false => Group::new().add(band).add(stroke(path(panel.curve.iter().map(edge(0.0))), CURVE, 1.6)),
    }
}

fn legend(right: f64) -> Group {
    let entry = |(index, (name, colour)): (usize, (&str, &str))| {
        let at = (right - 90.0 * (index + 1) as f64, 30.0);
        let dot = Circle::new().set("cx", at.0).set("cy", at.1 - SMALL / 3.0).set("r", 4).set("fill", colour);
        Group::new().add(dot).add(canvas::text(name, (at.0 + 9.0, at.1), Anchor::Start))
    };
    [("warming", WARMING), ("cooling", COOLING)].into_iter().enumerate().map(entry).fold(Group::new(), Group::add)
}
