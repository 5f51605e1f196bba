//! Plot of spectral densities over frequency, log-log: one panel per axis, with the strongest spectral lines labelled.

use super::allan::{COLOURS, around};
use super::axes::{Axis, range};
use super::canvas::{Anchor, Area, INK, clipped, label, line, path, stroke, with_unit};
use super::label::Labels;
use super::stack::Stack;
use svg::node::element::{Circle, Group, Line};

/// The spectrum of an axis. Densities are one-sided amplitude densities, in the unit of the plot.
#[derive(Clone, Debug, Default)]
pub struct Spectrum {
    /// The name of the axis.
    pub label: String,
    /// The points of the spectrum: frequency, Hz, and density.
    pub points: Vec<(f64, f64)>,
    /// The points of the fitted model; empty without one.
    pub model: Vec<(f64, f64)>,
    /// The disturbances and resonances that stand out from the model.
    pub tones: Vec<Tone>,
}

/// A disturbance or a resonance.
#[derive(Clone, Debug, PartialEq)]
pub struct Tone {
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Root mean square, in the unit of the signal. The strongest tones are labelled.
    pub rms: f64,
    /// The label beside the tone.
    pub label: String,
}

const HEIGHT: f64 = 170.0;
const NAMED: usize = 4;
/// A tone is marked at the highest density within this factor of its frequency.
const NEAR: f64 = 1.04;
/// Radius of the ring at a tone, and distance to its label from which a line joins them, pixels.
const RING: f64 = 5.0;
const NEAR_LABEL: f64 = 12.0;

/// Draws the spectra as SVG, with all panels on one scale.
#[must_use]
pub fn spectra(title: &str, spectra: &[Spectrum], unit: &str) -> String {
    let drawn = |&(hz, density): &(f64, f64)| hz > 0.0 && density > 0.0 && hz.is_finite() && density.is_finite();
    let points = || spectra.iter().flat_map(|spectrum| &spectrum.points).copied().filter(drawn);
    let frequency = range(points().map(|point| point.0)).unwrap_or((1.0, 1.0));
    let density = range(points().map(|point| point.1)).unwrap_or((1.0, 1.0));
    let stack = Stack {
        title,
        subtitle: "one-sided density (Welch, Hann's window), and the model in black, without the lines that are named",
        x_name: "frequency, Hz",
        y_name: &with_unit("density", unit),
        panels: spectra.len(),
        height: HEIGHT,
    };
    let x = Axis::log(frequency.0, frequency.1, stack.across());
    let mut paper = stack.paper();
    for (index, (spectrum, colour)) in spectra.iter().zip(COLOURS.into_iter().cycle()).enumerate() {
        // space for the labels above the curve
        let y = Axis::log(density.0, density.1 * 1.6, stack.upright(index));
        let place = |point: &(f64, f64)| (x.at(point.0), y.at(point.1));
        let track: Vec<(f64, f64)> = spectrum.points.iter().filter(|point| drawn(point)).map(place).collect();
        let model: Vec<(f64, f64)> = spectrum.model.iter().filter(|point| drawn(point)).map(place).collect();
        let (name, taken) = stack.name(index, &spectrum.label);
        let mut labels = Labels::new(stack.area(index));
        labels.take(taken);
        labels.avoid(&track);
        labels.avoid(&model);
        let curves =
            clipped(&stack.area(index)).add(stroke(path(track), colour, 1.2)).add(stroke(path(model), INK, 1.4));
        paper = paper.add(stack.frame(index, &x, &y)).add(curves).add(tones(spectrum, place, labels)).add(name);
    }
    paper.to_string()
}

/// Draws a ring at each tone, except on the flank of a stronger one, and labels at the strongest ones.
fn tones(spectrum: &Spectrum, place: impl Fn(&(f64, f64)) -> (f64, f64), mut labels: Labels) -> Group {
    let mut sorted: Vec<&Tone> = spectrum.tones.iter().collect();
    sorted.sort_by(|a, b| b.rms.total_cmp(&a.rms));
    // a tone close to a stronger one is its flank, not a second tone
    let mut strongest: Vec<&Tone> = Vec::new();
    for tone in sorted {
        let apart = |other: &&Tone| {
            let ratio = tone.frequency_hz / other.frequency_hz;
            ratio.max(1.0 / ratio) > NEAR * NEAR
        };
        if strongest.iter().all(apart) {
            strongest.push(tone);
        }
    }
    let peak = |tone: &Tone| {
        let near = |point: &&(f64, f64)| {
            (point.0 / tone.frequency_hz).max(tone.frequency_hz / point.0) < NEAR && point.1 > 0.0
        };
        spectrum.points.iter().filter(near).max_by(|a, b| a.1.total_cmp(&b.1)).map(&place)
    };
    // the names come last, since they have halos
    let (mut marks, mut names) = (Group::new(), Group::new());
    for (rank, tone) in strongest.into_iter().enumerate() {
        let Some((cx, cy)) = peak(tone) else { continue };
        let ring = Circle::new().set("cx", cx).set("cy", cy).set("r", RING).set("fill", "none").set("stroke", INK);
        marks = marks.add(ring);
        let level = [(11.0, Anchor::Start), (-11.0, Anchor::End)].map(|(off, anchor)| ((cx + off, cy + 4.5), anchor));
        let candidates = level.into_iter().chain(around((cx, cy)));
        let named = match rank {
            0 => labels.place(&tone.label, candidates),
            1..NAMED => labels.place_clear(&tone.label, candidates),
            _ => None,
        };
        if let Some((at, anchor)) = named {
            let leader = leader((cx, cy), &Area::of_text(&tone.label, at, anchor));
            marks = leader.into_iter().fold(marks, Group::add);
            names = names.add(label(&tone.label, at, anchor, INK));
        }
    }
    marks.add(names)
}

/// A thin line from a ring to its label, unless they are close together.
fn leader((cx, cy): (f64, f64), label: &Area) -> Option<Line> {
    let (x, y) = (cx.clamp(label.left, label.right), cy.clamp(label.top, label.bottom));
    let far = (x - cx).hypot(y - cy);
    let start = (cx + (x - cx) * RING / far, cy + (y - cy) * RING / far);
    (far > NEAR_LABEL).then(|| line(start, (x, y)).set("stroke", INK).set("stroke-width", 0.8))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_leads_to_a_label_that_is_not_beside_its_ring() {
        let label = Area { left: 40.0, right: 90.0, top: 30.0, bottom: 47.0 };
        assert!(leader((30.0, 38.0), &label).is_none());
        // the corner (40, 30) is 50 pixels from the ring
        let drawn = leader((0.0, 0.0), &label).unwrap().to_string();
        for end in ["x1=\"4\"", "y1=\"3\"", "x2=\"40\"", "y2=\"30\""] {
            assert!(drawn.contains(end), "{end} in {drawn}");
        }
    }
}
