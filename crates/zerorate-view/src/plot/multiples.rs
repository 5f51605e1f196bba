//! Allan deviations side by side: one panel per axis on common scales, with model, band and coefficients.

use super::allan::{COLOURS, Curve, Mark, Options, drawable, ranges};
use super::axes::Axis;
use super::canvas::{self, Anchor, Area, Frame, INK, SMALL, clipped, line, path, stroke, with_unit};
use super::curve::Scales;
use super::label::Labels;
use svg::node::element::Group;

const WIDTH: f64 = 960.0;
const LEFT: f64 = 92.0;
const RIGHT: f64 = 20.0;
const HEAD: f64 = 76.0;
const FOOT: f64 = 68.0;
const GAP: f64 = 36.0;
const COLUMNS: usize = 3;
/// Height of a panel, and of the panel's name above it, pixels.
const HEIGHT: f64 = 250.0;
const NAME: f64 = 24.0;

/// Draws the plot as SVG, up to three panels in a row. The size in `options` is ignored.
#[must_use]
pub fn allan_multiples(curves: &[Curve], options: &Options) -> String {
    let curves: Vec<Curve> = curves.iter().map(drawable).collect();
    let (x, y) = ranges(&curves);
    let rows = curves.len().div_ceil(COLUMNS).max(1);
    let columns = curves.len().clamp(1, COLUMNS);
    let width = (WIDTH - LEFT - RIGHT - GAP * (columns - 1) as f64) / columns as f64;
    let area = |index: usize| {
        let (row, column) = (index / columns, index % columns);
        let left = LEFT + (width + GAP) * column as f64;
        let top = HEAD + NAME + (HEIGHT + NAME + GAP) * row as f64;
        Area { left, right: left + width, top, bottom: top + HEIGHT }
    };
    let bottom = area(rows * columns - 1).bottom;
    let all = Area { left: LEFT, right: WIDTH - RIGHT, top: HEAD, bottom };
    let (title, subtitle) = (options.title.as_deref(), options.subtitle.as_deref());
    let y_name = with_unit(&options.quantity, &options.unit);
    let mut paper = canvas::paper((WIDTH as u32, (bottom + FOOT) as u32), title.unwrap_or(&y_name))
        .add(canvas::headings(LEFT, title, subtitle, WIDTH - LEFT - RIGHT))
        .add(canvas::upright(&y_name, LEFT - 66.0, 0.5 * (all.top + all.bottom)))
        .add(canvas::text("averaging time τ, s", (0.5 * (all.left + all.right), bottom + 48.0), Anchor::Middle));
    for (index, (curve, colour)) in curves.iter().zip(COLOURS.into_iter().cycle()).enumerate() {
        let area = area(index);
        let scales = Scales {
            x: Axis::log(x.0, x.1, (area.left, area.right)),
            y: Axis::log(y.0, y.1, (area.bottom, area.top)),
        };
        let is_lowest = index + columns >= curves.len();
        let frame = Frame {
            area,
            x: &scales.x,
            y: &scales.y,
            x_name: is_lowest.then_some(""),
            y_name: (index % columns == 0).then_some(""),
        };
        let name = canvas::fitting(&curve.label, SMALL, width);
        let name = canvas::text(&name, (area.left, area.top - 8.0), Anchor::Start).set("font-weight", 600);
        paper = paper.add(frame.draw()).add(name).add(panel(curve, colour, &scales, area, &options.marks));
    }
    paper.to_string()
}

fn panel(curve: &Curve, colour: &str, scales: &Scales, area: Area, marks: &[Mark]) -> Group {
    let mut inside = clipped(&area).add(scales.band(&curve.points, colour)).add(scales.band(&curve.predicted, INK));
    inside = inside.add(scales.edges(&curve.model, INK));
    for mark in marks {
        let x = scales.x.at(mark.tau_s);
        let rule = line((x, area.top), (x, area.bottom));
        inside = inside.add(rule.set("stroke", "#777777").set("stroke-dasharray", "5 4"));
    }
    for law in &curve.laws {
        inside = inside.add(stroke(path(scales.law(law)), law.colour(), 1.3).set("stroke-dasharray", "6 4"));
    }
    inside = inside.add(stroke(path(scales.model(curve)), INK, 1.6)).add(scales.line(curve, colour, "none"));
    let mut labels = Labels::new(area);
    labels.avoid(&scales.track(curve));
    labels.avoid(&scales.model(curve));
    scales.limits(&curve.points).iter().for_each(|limit| labels.avoid(limit));
    Group::new().add(inside).add(legend(curve, &labels))
}

/// The legend of a panel: the coefficients in the colours of their lines and the remarks, in the emptiest corner.
fn legend(curve: &Curve, labels: &Labels) -> Group {
    let laws = curve.laws.iter().map(|law| (&law.label, law.colour()));
    let rows: Vec<(&String, &str)> = laws.chain(curve.remarks.iter().map(|remark| (remark, INK))).collect();
    if rows.is_empty() {
        return Group::new();
    }
    let widest = rows.iter().map(|(text, _)| canvas::width(text, SMALL)).fold(0.0, f64::max);
    let height = 19.0;
    let place = labels.corner((widest + 8.0, height * rows.len() as f64 + 6.0));
    let paper = Group::new().add(canvas::rectangle(&place).set("fill", "white").set("fill-opacity", 0.85));
    rows.iter().enumerate().fold(paper, |group, (k, (text, colour))| {
        let at = (place.left + 4.0, place.top + height * (k as f64 + 0.5) + 7.0);
        group.add(canvas::text(text, at, Anchor::Start).set("fill", *colour))
    })
}
