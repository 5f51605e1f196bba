//! Plot of a unit's correction over temperature, with its uncertainty band and the measured temperature range.

use super::axes::{Axis, range};
use super::canvas::{self, Anchor, Area, Frame, INK, line, path, stroke};
use svg::node::element::{Circle, Group, Path};

/// The correction of a unit over temperature, and the means that it was fitted to.
#[derive(Clone, Debug)]
pub struct CorrectionCurve {
    /// Points of the curve, in order of temperature.
    pub points: Vec<CorrectionPoint>,
    /// The means that the curve was fitted to: minus the mean rate at each mean temperature. They are drawn as dots
    /// with intervals.
    pub means: Vec<CorrectionPoint>,
    /// Reference temperature T3, °C.
    pub t3_c: f64,
    /// Lowest and highest temperature of the measurement, °C; `None` if unknown.
    pub valid_c: Option<(f64, f64)>,
}

/// A correction at one temperature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CorrectionPoint {
    /// Temperature, °C.
    pub temp_c: f64,
    /// The correction, which is added to the rate, °/s.
    pub correction_dps: f64,
    /// Half the width of the correction's interval, °/s; 0 if the interval is unknown.
    pub half_dps: f64,
}

const SIZE: (u32, u32) = (960, 420);
const BLUE: &str = "#0072b2";
const SPAN: &str = "#e3f1e9";

/// Draws the plot as SVG.
pub fn correction(curve: &CorrectionCurve) -> String {
    let area = Area { left: 100.0, right: f64::from(SIZE.0) - 28.0, top: 40.0, bottom: f64::from(SIZE.1) - 68.0 };
    let temps = curve.points.iter().map(|point| point.temp_c);
    let (coldest, hottest) = range(temps).unwrap_or((0.0, 1.0));
    let ends = curve
        .points
        .iter()
        .chain(&curve.means)
        .flat_map(|p| [p.correction_dps - p.half_dps, p.correction_dps + p.half_dps]);
    let (low, high) = range(ends).unwrap_or((0.0, 1.0));
    let margin = (0.06 * (high - low)).max(1e-6);
    let x = Axis::linear(coldest, hottest, (area.left, area.right));
    let y = Axis::linear(low - margin, high + margin, (area.bottom, area.top));
    let frame = Frame { area, x: &x, y: &y, x_name: Some("temperature, °C"), y_name: Some("correction, °/s") };
    canvas::paper(SIZE, "Correction over temperature")
        .add(span(curve, &area, &x))
        .add(frame.draw())
        .add(lines(curve, &area, &x, &y))
        .add(reference(curve, &area, &x))
        .add(means(curve, &area, &x, &y))
        .to_string()
}

fn span(curve: &CorrectionCurve, area: &Area, x: &Axis) -> Group {
    let Some((from, to)) = curve.valid_c else { return Group::new() };
    let inside = Area { left: x.at(from).max(area.left), right: x.at(to).min(area.right), ..*area };
    let middle = 0.5 * (inside.left + inside.right);
    let name = canvas::text("measured here", (middle, area.top - 10.0), Anchor::Middle);
    Group::new().add(canvas::rectangle(&inside).set("fill", SPAN)).add(name.set("fill", "#00785a"))
}

fn lines(curve: &CorrectionCurve, area: &Area, x: &Axis, y: &Axis) -> Group {
    let edge = |sign: f64| {
        move |point: &CorrectionPoint| (x.at(point.temp_c), y.at(point.correction_dps + sign * point.half_dps))
    };
    let outline = curve.points.iter().map(edge(1.0)).chain(curve.points.iter().rev().map(edge(-1.0)));
    let band = Path::new().set("d", path(outline).close()).set("fill", BLUE).set("fill-opacity", 0.18);
    canvas::clipped(area).add(band).add(stroke(path(curve.points.iter().map(edge(0.0))), BLUE, 2.0))
}

fn means(curve: &CorrectionCurve, area: &Area, x: &Axis, y: &Axis) -> Group {
    let mean = |group: Group, &CorrectionPoint { temp_c, correction_dps, half_dps }: &CorrectionPoint| {
        let [at, low, high] =
            [correction_dps, correction_dps - half_dps, correction_dps + half_dps].map(|dps| y.at(dps));
        let bar = line((x.at(temp_c), low), (x.at(temp_c), high)).set("stroke", INK).set("stroke-width", 1.5);
        let dot = Circle::new().set("cx", canvas::px(x.at(temp_c))).set("cy", canvas::px(at)).set("r", 4);
        group.add(bar).add(dot.set("fill", "white").set("stroke", INK).set("stroke-width", 1.5))
    };
    curve.means.iter().fold(canvas::clipped(area), mean)
}

fn reference(curve: &CorrectionCurve, area: &Area, x: &Axis) -> Group {
    let at = x.at(curve.t3_c);
    let rule = line((at, area.top), (at, area.bottom)).set("stroke", "#777777").set("stroke-dasharray", "5 4");
    let name = canvas::label("T3", (at + 6.0, area.bottom - 10.0), Anchor::Start, INK);
    Group::new().add(rule).add(name)
}
