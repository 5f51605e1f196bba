//! Drawing elements that all plots share: background, frame, text.

use super::axes::{Axis, Tick};
use crate::printable;
use svg::Document;
use svg::node::element::{ClipPath, Definitions, Group, Line, Path, Rectangle, Text, Title, path::Data};

/// Fonts in order of preference. The PNG uses the first.
const FONTS: &str = "Inter, 'Noto Sans', 'DejaVu Sans', 'Segoe UI', Helvetica, Arial, sans-serif";
/// Mean width of a character relative to the font size. It is generous for ordinary text in DejaVu Sans, the widest
/// of the fonts.
const CHARACTER: f64 = 0.62;
pub const INK: &str = "#222222";
const MAJOR: &str = "#cccccc";
const MINOR: &str = "#ebebeb";

/// Font sizes, in pixels of the plot.
pub const SMALL: f64 = 13.0;
const LETTERING: f64 = 15.0;
const HEADING: f64 = 18.0;

/// A rectangle in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Area {
    pub left: f64,
    pub right: f64,
    pub top: f64,
    pub bottom: f64,
}

/// The name of an axis of a picture, with its unit if it is known.
pub fn with_unit(quantity: &str, unit: &str) -> String {
    if unit.is_empty() { quantity.to_owned() } else { format!("{quantity}, {unit}") }
}

impl Area {
    /// The area of a line of text that is anchored at x on its baseline, with a small margin at both ends.
    pub fn of_text(text: &str, (x, baseline): (f64, f64), anchor: Anchor) -> Self {
        let width = width(text, SMALL);
        let left = x - width * anchor.share();
        Self { left: left - 4.0, right: left + width + 4.0, top: baseline - SMALL, bottom: baseline + 0.3 * SMALL }
    }

    pub fn contains(&self, (x, y): (f64, f64)) -> bool {
        (self.left..=self.right).contains(&x) && (self.top..=self.bottom).contains(&y)
    }

    pub fn overlaps(&self, other: &Self) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    pub fn holds(&self, other: &Self) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right, other.bottom))
    }
}

/// The point of a text that is placed at the given position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

impl Anchor {
    fn share(self) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

/// Estimated width of a line of text, pixels.
pub fn width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * CHARACTER
}

/// Shortens a text to this many characters. The middle is cut out, because file names differ at their ends.
pub fn shortened(text: &str, characters: usize) -> String {
    let all: Vec<char> = text.chars().collect();
    if all.len() <= characters {
        return text.to_owned();
    }
    let tail = (characters - 1) / 2;
    let head = characters - 1 - tail;
    all[..head].iter().chain(&['…']).chain(&all[all.len() - tail..]).collect()
}

/// Shortens a text of font size `size` so that it fits into `room` pixels.
pub fn fitting(text: &str, size: f64, room: f64) -> String {
    shortened(text, (room / (size * CHARACTER)) as usize)
}

/// Rounds a number of pixels to two decimals.
pub fn px(value: f64) -> f64 {
    (value * 100.0).round() / 100.0
}

/// An empty white drawing; screen readers read `title`. The caller leaves space for the headings.
pub fn paper(size: (u32, u32), title: &str) -> Document {
    let (width, height) = size;
    Document::new()
        .set("viewBox", (0, 0, width, height))
        .set("width", width)
        .set("height", height)
        .set("role", "img")
        .set("font-family", FONTS)
        .set("font-size", SMALL)
        .set("fill", INK)
        .add(Title::new(printable::line(title)))
        .add(Rectangle::new().set("width", width).set("height", height).set("fill", "white"))
}

/// Stacks several plots one below the other in one SVG.
#[must_use]
pub fn stacked(pictures: &[String]) -> String {
    let size = |picture: &str, name: &str| -> Option<u32> {
        let (_, rest) = picture.split_once(&format!(" {name}=\""))?;
        rest.split_once('"')?.0.parse().ok()
    };
    let [only] = pictures else {
        let (mut top, mut width, mut inside) = (0, 0, String::new());
        for picture in pictures {
            inside += &picture.replacen("<svg ", &format!("<svg y=\"{top}\" "), 1);
            top += size(picture, "height").unwrap_or(0);
            width = width.max(size(picture, "width").unwrap_or(0));
        }
        let root = format!("<svg viewBox=\"0 0 {width} {top}\" width=\"{width}\" height=\"{top}\"");
        return format!("{root} role=\"img\" xmlns=\"http://www.w3.org/2000/svg\">\n{inside}\n</svg>");
    };
    only.clone()
}

/// The title and up to two subtitle lines, if given.
pub fn headings(left: f64, title: Option<&str>, subtitle: Option<&str>, room: f64) -> Group {
    let title =
        title.map(|title| text(&fitting(title, HEADING, room), (left, 28.0), Anchor::Start).set("font-size", HEADING));
    let below = subtitle.into_iter().flat_map(str::lines).zip([49.0, 66.0]);
    let below =
        below.map(|(line, y)| text(&fitting(line, SMALL, room), (left, y), Anchor::Start).set("fill", "#555555"));
    title.into_iter().chain(below).fold(Group::new(), Group::add)
}

pub fn text(content: &str, (x, y): (f64, f64), anchor: Anchor) -> Text {
    Text::new(printable::line(content)).set("x", px(x)).set("y", px(y)).set("text-anchor", anchor.name())
}

/// A line of text with a white halo, so that it stays readable on top of lines. The halo is a second text below the
/// first, because some renderers do not support `paint-order`.
pub fn label(content: &str, at: (f64, f64), anchor: Anchor, colour: &str) -> Group {
    let halo = text(content, at, anchor)
        .set("fill", "white")
        .set("stroke", "white")
        .set("stroke-width", 4)
        .set("stroke-linejoin", "round")
        .set("aria-hidden", "true");
    Group::new().add(halo).add(text(content, at, anchor).set("fill", colour))
}

pub fn line((x1, y1): (f64, f64), (x2, y2): (f64, f64)) -> Line {
    Line::new().set("x1", px(x1)).set("y1", px(y1)).set("x2", px(x2)).set("y2", px(y2))
}

pub fn path(points: impl IntoIterator<Item = (f64, f64)>) -> Data {
    points.into_iter().fold(Data::new(), |data, (x, y)| {
        let at = (px(x), px(y));
        if data.is_empty() { data.move_to(at) } else { data.line_to(at) }
    })
}

/// The outline of the path `data`, without a fill.
pub fn stroke(data: Data, colour: &str, width: f64) -> Path {
    Path::new()
        .set("d", data)
        .set("fill", "none")
        .set("stroke", colour)
        .set("stroke-width", width)
        .set("stroke-linejoin", "round")
}

/// A group that is clipped at the frame. Its clip path is named after the position of the frame, because all plots of
/// a page share one set of names.
pub fn clipped(area: &Area) -> Group {
    let Area { left, right, top, bottom } = area;
    let name = format!("inside-{left:.0}-{right:.0}-{top:.0}-{bottom:.0}");
    let inside = ClipPath::new().set("id", name.as_str()).add(rectangle(area));
    Group::new().set("clip-path", format!("url(#{name})")).add(Definitions::new().add(inside))
}

pub fn rectangle(area: &Area) -> Rectangle {
    Rectangle::new()
        .set("x", px(area.left))
        .set("y", px(area.top))
        .set("width", px(area.right - area.left))
        .set("height", px(area.bottom - area.top))
}

/// Grid, frame and labels of the left and the lower axis.
pub struct Frame<'a> {
    pub area: Area,
    pub x: &'a Axis,
    pub y: &'a Axis,
    /// The label of the horizontal axis. With `None`, the axis has neither label nor numbers.
    pub x_name: Option<&'a str>,
    /// The label of the vertical axis. With `None`, the axis has neither label nor numbers; with an empty label,
    /// numbers only.
    pub y_name: Option<&'a str>,
}

impl Frame<'_> {
    pub fn draw(&self) -> Group {
        let Area { left, right, top, bottom } = self.area;
        let ruled = |tick: &Tick, from, to| {
            line(from, to).set("stroke", if tick.major { MAJOR } else { MINOR }).set("stroke-width", 1)
        };
        let vertical = |tick: &Tick| {
            let x = self.x.at(tick.value);
            ruled(tick, (x, top), (x, bottom))
        };
        let horizontal = |tick: &Tick| {
            let y = self.y.at(tick.value);
            ruled(tick, (left, y), (right, y))
        };
        let (x_ticks, y_ticks) = (self.x.ticks(), self.y.ticks());
        // minor lines come first, so that major ones cross on top of them
        let lines = [false, true].into_iter().flat_map(|major| {
            let of_kind = move |tick: &&Tick| tick.major == major;
            x_ticks.iter().filter(of_kind).map(vertical).chain(y_ticks.iter().filter(of_kind).map(horizontal))
        });
        let grid = lines.fold(Group::new(), Group::add);
        let border = rectangle(&self.area).set("fill", "none").set("stroke", INK);
        Group::new().add(grid).add(border).add(self.lettering(&x_ticks, &y_ticks))
    }

    fn lettering(&self, x_ticks: &[Tick], y_ticks: &[Tick]) -> Group {
        let Area { left, right, top, bottom } = self.area;
        let below = x_ticks.iter().filter(|_| self.x_name.is_some()).filter_map(|tick| {
            Some(text(tick.label.as_ref()?, (self.x.at(tick.value), bottom + 20.0), Anchor::Middle))
        });
        let beside = y_ticks.iter().filter(|_| self.y_name.is_some()).filter_map(|tick| {
            Some(text(tick.label.as_ref()?, (left - 8.0, self.y.at(tick.value) + 4.5), Anchor::End))
        });
        let x_name = self
            .x_name
            .filter(|name| !name.is_empty())
            .map(|name| text(name, (0.5 * (left + right), bottom + 48.0), Anchor::Middle).set("font-size", LETTERING));
        let y_name = self.y_name.filter(|name| !name.is_empty());
        let y_name = y_name.map(|name| upright(name, left - 66.0, 0.5 * (top + bottom)));
        below.chain(beside).chain(x_name).chain(y_name).fold(Group::new(), Group::add)
    }
}

/// A second scale on the right side of the frame, with ticks instead of a grid.
pub fn right_scale(area: &Area, axis: &Axis, name: &str) -> Group {
    let marks = axis.ticks().into_iter().flat_map(|tick| {
        let y = axis.at(tick.value);
        let length = if tick.major { 8.0 } else { 4.0 };
        let mark = line((area.right - length, y), (area.right, y)).set("stroke", INK);
        let label = tick.label.map(|label| text(&label, (area.right + 8.0, y + 4.5), Anchor::Start));
        [Some(Group::new().add(mark)), label.map(|label| Group::new().add(label))].into_iter().flatten()
    });
    marks.fold(Group::new(), Group::add).add(upright(name, area.right + 72.0, 0.5 * (area.top + area.bottom)))
}

/// A vertical axis label, which reads upwards.
pub fn upright(name: &str, x: f64, y: f64) -> Text {
    text(name, (x, y), Anchor::Middle)
        .set("font-size", LETTERING)
        .set("transform", format!("rotate(-90 {} {})", px(x), px(y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_names_lose_their_middle() {
        assert_eq!(shortened("unit.arrows", 11), "unit.arrows");
        assert_eq!(shortened("a-very-long-name.arrows", 12), "a-very…rrows");
        assert_eq!(shortened("ÄÖÜäöü", 5), "ÄÖ…öü");
    }
}
