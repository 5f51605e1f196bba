//! Draws the content of an Allan plot: bands, curves, points, power laws.

use super::allan::{Curve, Point, PowerLaw};
use super::axes::Axis;
use super::canvas::{path, px, stroke};
use svg::node::element::{Circle, Group, Path};

/// Curves with at least this many points are drawn without dots.
const DENSE: usize = 60;

pub struct Scales {
    pub x: Axis,
    pub y: Axis,
}

impl Scales {
    pub fn at(&self, tau_s: f64, dev: f64) -> (f64, f64) {
        (self.x.at(tau_s), self.y.at(dev))
    }

    /// The deviations of a curve in pixels.
    pub fn track(&self, curve: &Curve) -> Vec<(f64, f64)> {
        curve.points.iter().map(|point| self.at(point.tau_s, point.dev)).collect()
    }

    /// The line of a power law across the whole plot, with a point every few pixels.
    pub fn law(&self, law: &PowerLaw) -> Vec<(f64, f64)> {
        let (from, to) = self.x.ends();
        let steps = ((to - from) / 6.0).ceil().clamp(1.0, 1000.0) as u32;
        let at = |k: u32| {
            let tau_s = self.x.value(from + (to - from) * f64::from(k) / f64::from(steps));
            self.at(tau_s, law.dev(tau_s))
        };
        (0..=steps).map(at).collect()
    }

    /// The fitted curve in pixels; empty if there are fewer than two points.
    pub fn model(&self, curve: &Curve) -> Vec<(f64, f64)> {
        match &curve.model[..] {
            points @ [_, _, ..] => points.iter().map(|point| self.at(point.tau_s, point.dev)).collect(),
            _ => Vec::new(),
        }
    }

    pub fn band(&self, points: &[Point], colour: &str) -> Path {
        let upper = points.iter().map(|point| self.at(point.tau_s, point.hi));
        let lower = points.iter().rev().map(|point| self.at(point.tau_s, point.lo));
        Path::new().set("d", path(upper.chain(lower)).close()).set("fill", colour).set("fill-opacity", 0.18)
    }

    /// The tracks of the lower and upper limits.
    pub fn limits(&self, points: &[Point]) -> [Vec<(f64, f64)>; 2] {
        [|point: &Point| point.lo, |point: &Point| point.hi]
            .map(|limit| points.iter().map(|point| self.at(point.tau_s, limit(point))).collect())
    }

    /// The lower and upper limits as dotted lines.
    pub fn edges(&self, points: &[Point], colour: &str) -> Group {
        let dotted = |track: Vec<_>| stroke(path(track), colour, 0.8).set("stroke-dasharray", "1 3");
        self.limits(points).map(dotted).into_iter().fold(Group::new(), Group::add)
    }

    /// The line through the deviations, with a dot at each unless there are `DENSE` or more. `dash` distinguishes
    /// curves of the same colour.
    pub fn line(&self, curve: &Curve, colour: &str, dash: &str) -> Group {
        let track = self.track(curve);
        let (dots, width) = if track.len() < DENSE { (&track[..], 2.0) } else { (&[][..], 1.4) };
        let line = stroke(path(track.iter().copied()), colour, width).set("stroke-dasharray", dash);
        let dot = |at: &(f64, f64)| circle(*at, 3.0).set("fill", colour);
        dots.iter().map(dot).fold(Group::new().add(line), Group::add)
    }

    pub fn ring(&self, tau_s: f64, dev: f64, colour: &str) -> Circle {
        circle(self.at(tau_s, dev), 7.0).set("fill", "none").set("stroke", colour).set("stroke-width", 1.6)
    }
}

fn circle((x, y): (f64, f64), radius: f64) -> Circle {
    Circle::new().set("cx", px(x)).set("cy", px(y)).set("r", radius)
}
