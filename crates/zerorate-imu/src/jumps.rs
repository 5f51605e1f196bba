//! Jumps in a record: whole turns of an angle that wraps around, and jumps that the deviations keep.

use std::path::Path;
use zerorate_allan::{Input, Jumps, jumps};
use zerorate_logs::{Column, LogError, LogWarning, Quantity};

/// An angle wraps around if all but this share of its points lie from 0 to a turn, or within half a turn of 0. The
/// rest are wrong samples.
const OUTSIDE: f64 = 1e-3;
/// The ends of such a range may be rounded by this share of a turn.
const ROUNDED: f64 = 1e-4;

/// The points of a phase, NaN where one is lost. An angle that wraps around is unwrapped, which adds a note.
///
/// # Errors
/// Returns an error if too many samples are lost.
pub fn angle(column: &Column, path: &Path, notes: &mut Vec<LogWarning>) -> Result<Vec<f64>, LogError> {
    let points = column.points(path)?;
    let is_angle = column.quantity == Some(Quantity::AngularRate);
    let turn = (360.0 / column.scale).abs();
    if !is_angle || !wraps(&points, turn) {
        return Ok(points);
    }
    let (points, turns) = unwrapped(&points, turn);
    if turns > 0 {
        let times = if turns == 1 { "once".to_owned() } else { format!("{turns} times") };
        notes.push(note(path, column, &format!("the angle jumps by a whole turn {times}, which is taken out")));
    }
    Ok(points)
}

/// True if an angle starts again after a whole turn. An angle that counts on leaves the range of a turn.
fn wraps(points: &[f64], turn: f64) -> bool {
    let most = OUTSIDE * points.iter().filter(|point| !point.is_nan()).count() as f64;
    let is_in = |middle: f64| {
        let outside = points.iter().filter(|point| (**point - middle).abs() > (0.5 + ROUNDED) * turn);
        outside.count() as f64 <= most
    };
    is_in(0.0) || is_in(turn / 2.0)
}

/// The angle without its jumps by a whole turn, and their number. Each step goes the short way round, across a gap
/// too. A step of more than a turn is a wrong sample, and is kept.
fn unwrapped(points: &[f64], turn: f64) -> (Vec<f64>, usize) {
    let (mut before, mut turns, mut added) = (f64::NAN, 0, 0.0);
    let unwrap = |point: &f64| {
        let step = *point - before;
        if (0.5..=1.0 + 2.0 * ROUNDED).contains(&(step.abs() / turn)) {
            turns += 1;
            added -= turn.copysign(step);
        }
        before = if point.is_nan() { before } else { *point };
        *point + added
    };
    let points = points.iter().map(unwrap).collect();
    (points, turns)
}

/// The note about jumps in a record from which no model removes them.
pub fn said(input: &Input<'_>, column: &Column, path: &Path) -> Option<LogWarning> {
    let Jumps { largest, usual } = jumps(input)?;
    let per_second = if matches!(input, Input::Phase(_)) { column.rate_hz } else { 1.0 };
    let (size, times) = ((largest * column.scale * per_second).abs(), largest / usual);
    let size = format!("{size:.1e} {}", column.quantity.map_or("", Quantity::unit));
    let size = size.trim_end();
    let times = if times < 1e6 { format!("{times:.0}") } else { format!("{times:.0e}") };
    Some(note(path, column, &format!("jumps of up to {size}, {times} times the usual, are in the deviations")))
}

fn note(path: &Path, column: &Column, what: &str) -> LogWarning {
    let (path, text) = (path.display().to_string(), format!("{}: {what}", column.name));
    LogWarning::OfReadings { path, code: "glitches", text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zerorate_logs::Series;

    #[test]
    fn an_angle_is_unwrapped_where_it_jumps_by_a_whole_turn() {
        let straight = || (0..2000).map(|at| 350.0 + 0.25 * f64::from(at));
        let mut wrapped: Vec<f64> = straight().map(|angle| (angle + 180.0) % 360.0 - 180.0).collect();
        wrapped[700] = f64::NAN;
        let mut column = Column::new("yaw", Series::Numbers(wrapped.clone()), 100.0);
        let path = Path::new("log");
        let mut notes = Vec::new();
        let kept = angle(&column, path, &mut notes).unwrap();
        assert!(kept[699] == wrapped[699] && notes.is_empty(), "a phase of unknown unit is kept");
        column.quantity = Some(Quantity::AngularRate);
        let found = angle(&column, path, &mut notes).unwrap();
        let is_straight =
            |(at, (point, angle)): (usize, (&f64, f64))| at == 700 || (point + 360.0 - angle).abs() < 1e-9;
        assert!(found.iter().zip(straight()).enumerate().all(is_straight));
        assert_eq!(notes[0].coded(), "glitches: log: yaw: the angle jumps by a whole turn once, which is taken out");
    }

    #[test]
    fn an_angle_wraps_around_if_it_stays_within_a_turn() {
        let wrap = |angle: f64| (angle + 180.0).rem_euclid(360.0) - 180.0;
        let wave = |at: u32| f64::from(at * 7919 % 101) / 101.0 - 0.5;
        for (name, angle) in [
            ("15° a sample", (0..1200).map(|at| 15.0 * f64::from(at) + wave(at)).collect::<Vec<f64>>()),
            ("170° a sample", (0..1200).map(|at| -170.0 * f64::from(at) + wave(at)).collect()),
            ("at rest where it wraps", (0..1200).map(|at| -180.0 + wave(at)).collect()),
        ] {
            let wrapped: Vec<f64> = angle.iter().map(|angle| wrap(*angle)).collect();
            assert!(wraps(&wrapped, 360.0), "{name}");
            let found = unwrapped(&wrapped, 360.0).0;
            let is_right = |(one, other): (&f64, &f64)| (one - other - (found[0] - angle[0])).abs() < 1e-6;
            assert!(found.iter().zip(&angle).all(is_right), "{name}");
        }
        assert!(!wraps(&(0..1200).map(|at| 30.0 * f64::from(at)).collect::<Vec<f64>>(), 360.0), "counted on");
        let mut turned_in_a_gap = [0.1; 1200];
        turned_in_a_gap[600..610].fill(f64::NAN);
        turned_in_a_gap[610..].fill(360.2);
        assert!(!wraps(&turned_in_a_gap, 360.0));
    }

    #[test]
    fn a_bit_error_is_said() {
        let mut rate: Vec<f64> = (0..3000).map(|at| f64::from(at * 7919 % 101) / 101.0).collect();
        let said = |rate: &[f64]| {
            let mut column = Column::new("gz", Series::Numbers(rate.to_vec()), 100.0);
            column.quantity = Some(Quantity::AngularRate);
            super::said(&column.input(), &column, Path::new("log")).map(|note| note.coded())
        };
        assert_eq!(said(&rate), None);
        rate[1500] = 600.0;
        let text = said(&rate).unwrap_or_default();
        assert!(text.starts_with("glitches: log: gz: jumps of up to 6.0e2 °/s, 10"), "{text}");
    }
}
