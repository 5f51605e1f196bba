//! Panels one below the other with a common horizontal axis.

use super::axes::Axis;
use super::canvas::{self, Anchor, Area, Frame, SMALL};
use svg::Document;
use svg::node::element::Group;

/// Size of the plot and margins around its panels, pixels.
const WIDTH: f64 = 960.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 28.0;
const HEAD: f64 = 62.0;
const FOOT: f64 = 68.0;
const GAP: f64 = 20.0;

/// The layout of panels of equal height.
pub struct Stack<'a> {
    pub title: &'a str,
    pub subtitle: &'a str,
    pub x_name: &'a str,
    pub y_name: &'a str,
    pub panels: usize,
    pub height: f64,
}

impl Stack<'_> {
    pub fn area(&self, index: usize) -> Area {
        let top = HEAD + (self.height + GAP) * index as f64;
        Area { left: LEFT, right: WIDTH - RIGHT, top, bottom: top + self.height }
    }

    /// The first and last horizontal pixel of all panels.
    pub fn across(&self) -> (f64, f64) {
        (LEFT, WIDTH - RIGHT)
    }

    /// The lower and upper vertical pixel of a panel, in the order that `Axis` expects.
    pub fn upright(&self, index: usize) -> (f64, f64) {
        let Area { top, bottom, .. } = self.area(index);
        (bottom, top)
    }

    /// An empty drawing with the headings and the label of the vertical axes.
    pub fn paper(&self) -> Document {
        let bottom = self.area(self.panels.saturating_sub(1)).bottom;
        let all = Area { bottom, ..self.area(0) };
        let size = (WIDTH as u32, (bottom + FOOT) as u32);
        canvas::paper(size, &format!("{}: {}", self.title, self.subtitle))
            .add(canvas::headings(LEFT, Some(self.title), Some(self.subtitle), WIDTH - LEFT - RIGHT))
            .add(canvas::upright(self.y_name, LEFT - 66.0, 0.5 * (all.top + all.bottom)))
    }

    /// Grid and numbers of a panel. Only the last panel has the numbers of the horizontal axis.
    pub fn frame(&self, index: usize, x: &Axis, y: &Axis) -> Group {
        let x_name = (index + 1 == self.panels).then_some(self.x_name);
        Frame { area: self.area(index), x, y, x_name, y_name: Some("") }.draw()
    }

    /// The name of a panel in its upper left corner, and the area that it covers.
    pub fn name(&self, index: usize, name: &str) -> (Group, Area) {
        let area = self.area(index);
        let at = (area.left + 10.0, area.top + 6.0 + SMALL);
        let name = canvas::shortened(name, 70);
        let label = canvas::label(&name, at, Anchor::Start, canvas::INK).set("font-weight", 600);
        (Group::new().add(label), Area::of_text(&name, at, Anchor::Start))
    }
}
