//! The ranges of the temperature that a recording covered while it warmed, and while it cooled.

use alloc::vec::Vec;

/// Share of the whole span below which a change of direction is a wiggle within a sweep. A wiggle is too short to show
/// the other branch of a hysteresis.
const WIGGLE: f64 = 0.125;

/// Lowest and highest temperature from one turning point to the next, °C.
type Range = (f64, f64);

/// Span that the temperature covered while it rose, and while it fell, °C. A temperature that was passed several times
/// in one direction counts once.
pub(crate) fn covered_c(temps_c: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let (low_c, high_c) = temps_c.clone().fold(EMPTY, |(low, high), c| (low.min(c), high.max(c)));
    let wiggle_c = WIGGLE * (high_c - low_c);
    let mut sweeps = TemperatureSweeps { wiggle_c, seen: EMPTY, rising: None, ranges: Default::default() };
    temps_c.for_each(|temp_c| sweeps.push(temp_c));
    sweeps.end();
    let [rises, falls] = sweeps.ranges;
    (length(rises), length(falls))
}

const EMPTY: Range = (f64::INFINITY, f64::NEG_INFINITY);

struct TemperatureSweeps {
    wiggle_c: f64,
    /// Range of the present sweep.
    seen: Range,
    /// The direction of the present sweep, once it is known.
    rising: Option<bool>,
    /// Ranges of the rising sweeps, and of the falling ones.
    ranges: [Vec<Range>; 2],
}

impl TemperatureSweeps {
    fn push(&mut self, temp_c: f64) {
        let (low_c, high_c) = self.seen;
        let (risen, fallen) = (temp_c - low_c > self.wiggle_c, high_c - temp_c > self.wiggle_c);
        match self.rising {
            None if risen || fallen => self.rising = Some(risen),
            Some(true) if fallen => self.turn((temp_c, high_c)),
            Some(false) if risen => self.turn((low_c, temp_c)),
            _ => {}
        }
        self.seen = (self.seen.0.min(temp_c), self.seen.1.max(temp_c));
    }

    /// Ends the present sweep, because one in the other direction has begun at the last turning point.
    fn turn(&mut self, begun: Range) {
        self.end();
        self.rising = self.rising.map(|rising| !rising);
        self.seen = begun;
    }

    fn end(&mut self) {
        if let Some(rising) = self.rising {
            self.ranges[usize::from(!rising)].push(self.seen);
        }
    }
}

/// Total length that the ranges cover.
fn length(mut ranges: Vec<Range>) -> f64 {
    ranges.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (mut length_c, mut reached_c) = (0.0, f64::NEG_INFINITY);
    for (low_c, high_c) in ranges {
        length_c += (high_c - low_c.max(reached_c)).max(0.0);
        reached_c = reached_c.max(high_c);
    }
    length_c
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns straight lines between these temperatures, in steps of 0.01 °C.
    fn path(corners_c: &[f64]) -> Vec<f64> {
        let line = |ends: &[f64]| {
            let (from, to) = (ends[0], ends[1]);
            let count = ((to - from).abs() * 100.0) as i32;
            (0..count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count)).collect::<Vec<f64>>()
        };
        corners_c.windows(2).flat_map(line).chain(corners_c.last().copied()).collect()
    }

    fn covered(corners_c: &[f64]) -> (f64, f64) {
        let temps_c = path(corners_c);
        covered_c(temps_c.iter().copied())
    }

    fn near((rise_c, fall_c): (f64, f64), expected: (f64, f64)) {
        assert!((rise_c - expected.0).abs() < 0.02 && (fall_c - expected.1).abs() < 0.02, "{rise_c} {fall_c}");
    }

    #[test]
    fn two_falls_cover_what_both_passed() {
        near(covered(&[0.0, 8.0, 4.5, 10.0, 6.5]), (10.0, 5.5));
        near(covered(&[0.0, 10.0, 6.5, 10.0, 6.5]), (10.0, 3.5));
        near(covered(&[10.0, 0.0, 10.0]), (10.0, 10.0));
        near(covered(&[20.0, 28.0, 24.5, 30.0, 26.5]), (10.0, 5.5));
    }

    #[test]
    fn wiggles_do_not_count_as_the_other_direction() {
        let climb = |wiggle_c: f64| (0..200).map(move |k| 0.05 * f64::from(k) + wiggle_c * f64::from(k % 2));
        near(covered_c(climb(0.5)), (10.45, 0.0));
        near(covered(&[0.0, 5.0, 4.2, 7.0, 6.0, 10.0, 9.0]), (10.0, 0.0));
    }

    #[test]
    fn one_temperature_covers_no_span() {
        assert_eq!(covered_c(core::iter::empty()), (0.0, 0.0));
        assert_eq!(covered_c([25.0; 9].into_iter()), (0.0, 0.0));
    }
}
