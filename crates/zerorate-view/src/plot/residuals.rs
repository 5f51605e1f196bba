//! Plot of the corrected rate over time or temperature, coloured by warming and cooling.

use super::axes::{Axis, range_with_margins};
use super::canvas::{self, Anchor, Area, Frame, INK, line, px};
use svg::node::element::{Circle, Group};

/// The mean corrected rate over a short time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ResidualPoint {
    /// Time or temperature, in the unit of the axis.
    pub x: f64,
    /// Corrected rate, °/s.
    pub residual_dps: f64,
    /// True if the sensor was warming, false if it was cooling; `None` if neither.
    pub warming: Option<bool>,
}

const SIZE: (u32, u32) = (960, 420);
const WARMING: &str = "#d55e00";
const COOLING: &str = "#0072b2";
const STILL: &str = "#777777";
const RADIUS: f64 = 2.6;

/// Draws the plot as SVG.
pub fn residuals(title: &str, x_name: &str, points: &[ResidualPoint]) -> String {
    let area = Area { left: 100.0, right: f64::from(SIZE.0) - 28.0, top: 40.0, bottom: f64::from(SIZE.1) - 68.0 };
    let (first, last) = range_with_margins(points.iter().map(|point| point.x), 0.02, 0.02);
    let residuals_dps = points.iter().map(|point| point.residual_dps);
    let (low, high) = range_with_margins(residuals_dps.chain([0.0]), 0.08, 0.08);
    let x = Axis::linear(first, last, (area.left, area.right));
    let y = Axis::linear(low, high, (area.bottom, area.top));
    let frame = Frame { area, x: &x, y: &y, x_name: Some(x_name), y_name: Some("corrected rate, °/s") };
    let zero = line((area.left, y.at(0.0)), (area.right, y.at(0.0))).set("stroke", INK).set("stroke-dasharray", "5 4");
    let dot = |point: &ResidualPoint| {
        let (cx, cy) = (px(x.at(point.x)), px(y.at(point.residual_dps)));
        Circle::new().set("cx", cx).set("cy", cy).set("r", RADIUS).set("fill", colour(point.warming))
    };
    let dots = points.iter().map(dot).fold(canvas::clipped(&area).add(zero), Group::add);
    canvas::paper(SIZE, title).add(frame.draw()).add(dots).add(legend(&area)).to_string()
}

fn colour(warming: Option<bool>) -> &'static str {
    match warming {
        Some(true) => WARMING,
        Some(false) => COOLING,
        None => STILL,
    }
}

fn legend(area: &Area) -> Group {
    let names = [("warming", WARMING), ("cooling", COOLING), ("neither", STILL)];
    let entry = |(index, (name, colour)): (usize, (&str, &str))| {
        let at = (area.left + 10.0 + 90.0 * index as f64, area.top - 14.0);
        let dot = Circle::new().set("cx", at.0).set("cy", at.1 - 4.0).set("r", 4).set("fill", colour);
        Group::new().add(dot).add(canvas::text(name, (at.0 + 9.0, at.1), Anchor::Start))
    };
    names.into_iter().enumerate().map(entry).fold(Group::new(), Group::add)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_mean_is_a_dot_coloured_by_warming_or_cooling() {
        let point = |x: f64, warming| ResidualPoint { x, residual_dps: x / 1000.0, warming };
        let svg = residuals("t", "x", &[point(1.0, Some(true)), point(2.0, Some(false)), point(3.0, None)]);
        for (colour, count) in [(WARMING, 2), (COOLING, 2), (STILL, 2)] {
            assert_eq!(
                svg.matches(&format!("fill=\"{colour}\"")).count(),
                count,
                "a dot, and one in the legend: {svg}"
            );
        }
        let empty = residuals("t", "x", &[]);
        assert!(empty.contains("<svg") && !empty.contains("NaN"));
    }
}
