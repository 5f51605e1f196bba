//! Finds label positions inside the frame that do not overlap other labels and avoid the lines.

use super::canvas::{Anchor, Area};

/// The position of a text: a point, and the anchor of the text at that point.
pub type Position = ((f64, f64), Anchor);

/// The lines and labels that are already drawn.
pub struct Labels {
    area: Area,
    taken: Vec<Area>,
    ink: Vec<(f64, f64)>,
}

impl Labels {
    pub fn new(area: Area) -> Self {
        Self { area, taken: Vec::new(), ink: Vec::new() }
    }

    /// Adds a line through these points, which labels avoid.
    pub fn avoid(&mut self, points: &[(f64, f64)]) {
        self.ink.extend(densely(points).into_iter().filter(|point| self.area.contains(*point)));
    }

    pub fn take(&mut self, place: Area) {
        self.taken.push(place);
    }

    /// Chooses the candidate position at which the text covers the fewest points of lines, and marks it as taken. Of
    /// equally good positions, the first is chosen. Returns `None` if all leave the frame or cover another label.
    pub fn place(&mut self, text: &str, candidates: impl IntoIterator<Item = Position>) -> Option<Position> {
        let cost = |place: &Area| self.ink.iter().filter(|point| place.contains(**point)).count();
        let free = |place: &Area| self.area.holds(place) && !self.taken.iter().any(|other| other.overlaps(place));
        let (at, anchor, place, _) = candidates
            .into_iter()
            .map(|(at, anchor)| (at, anchor, Area::of_text(text, at, anchor)))
            .filter(|(_, _, place)| free(place))
            .map(|(at, anchor, place)| (at, anchor, place, cost(&place)))
            .min_by_key(|(.., cost)| *cost)?;
        self.taken.push(place);
        Some((at, anchor))
    }

    /// Chooses the first candidate position that covers neither lines nor labels, and marks it as taken.
    pub fn place_clear(&mut self, text: &str, candidates: impl IntoIterator<Item = Position>) -> Option<Position> {
        let is_clear = |(at, anchor): &Position| {
            let place = Area::of_text(text, *at, *anchor);
            !self.ink.iter().any(|point| place.contains(*point))
        };
        let clear: Vec<_> = candidates.into_iter().filter(is_clear).collect();
        self.place(text, clear)
    }

    /// Chooses the corner of the frame where a box of this size covers the fewest labels. Of equal corners, it
    /// chooses the one where the box covers the fewest points of lines.
    pub fn corner(&self, (width, height): (f64, f64)) -> Area {
        let Area { left, right, top, bottom } = self.area;
        let gap = 12.0;
        let at = |left: f64, top: f64| Area { left, right: left + width, top, bottom: top + height };
        let (near, far) = (left + gap, right - gap - width);
        let (high, low) = (top + gap, bottom - gap - height);
        let corners = [at(far, high), at(near, low), at(far, low), at(near, high)];
        let covered = |area: &Area| {
            let labels = self.taken.iter().filter(|other| other.overlaps(area)).count();
            (labels, self.ink.iter().filter(|point| area.contains(**point)).count())
        };
        corners.into_iter().min_by_key(covered).unwrap_or(corners[0])
    }
}

/// Resamples the line through these points to points at most four pixels apart.
pub fn densely(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let between = |pair: &[(f64, f64)]| {
        let ((x1, y1), (x2, y2)) = (pair[0], pair[1]);
        let steps = ((x2 - x1).hypot(y2 - y1) / 4.0).ceil().clamp(1.0, 1000.0) as u32;
        let at = move |k: u32| f64::from(k) / f64::from(steps);
        (0..=steps).map(move |k| (x1 + at(k) * (x2 - x1), y1 + at(k) * (y2 - y1)))
    };
    points.windows(2).flat_map(between).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: Area = Area { left: 0.0, right: 400.0, top: 0.0, bottom: 300.0 };

    #[test]
    fn a_label_keeps_off_lines_labels_and_the_border() {
        let mut labels = Labels::new(PAPER);
        labels.avoid(&[(0.0, 95.0), (400.0, 95.0)]);
        let candidates = [(390.0, 50.0), (100.0, 100.0), (100.0, 200.0)].map(|at| (at, Anchor::Start));
        assert_eq!(labels.place("label", candidates), Some(((100.0, 200.0), Anchor::Start)), "off line and border");
        assert_eq!(labels.place("label", candidates), Some(((100.0, 100.0), Anchor::Start)), "rather on a line");
        assert_eq!(labels.place("label", candidates), None, "than on a label");
        let on_line = [((200.0, 100.0), Anchor::Start), ((200.0, 250.0), Anchor::Start)];
        assert_eq!(labels.place_clear("clear", on_line), Some(on_line[1]), "where nothing is");
        assert_eq!(labels.place_clear("clear", on_line), None, "or nowhere");
    }

    #[test]
    fn the_legend_goes_where_nothing_is() {
        let mut labels = Labels::new(PAPER);
        labels.avoid(&[(0.0, 299.0), (400.0, 1.0)]);
        let corner = labels.corner((50.0, 40.0));
        assert!(corner.left > 200.0 && corner.top > 150.0, "{corner:?}");
        labels.take(corner);
        let next = labels.corner((50.0, 40.0));
        assert!(next.left < 200.0 && next.top < 150.0, "{next:?}");
    }
}
