//! Jumps in a record: whole turns of an angle that wraps around, and jumps that the deviations keep.

use std::path::Path;
use zerorate_allan::{Input, Jumps, jumps};
use zerorate_logs::{Column, LogError, LogWarning, Quantity};

/// A step of an angle within this of 360° is a whole turn.
const NEAR_DEG: f64 = 10.0;

/// The points of a phase, NaN where one is lost. An angle that wraps around is unwrapped, which adds a note.
///
/// # Errors
/// Returns an error if too many samples are lost.
pub fn angle(column: &Column, path: &Path, notes: &mut Vec<LogWarning>) -> Result<Vec<f64>, LogError> {
    let points = column.points(path)?;
    let is_angle = column.quantity == Some(Quantity::AngularRate);
    let found = is_angle.then(|| unwrapped(&points, (360.0 / column.scale).abs())).flatten();
    let Some((points, turns)) = found else { return Ok(points) };
    let times = if turns == 1 { "once".to_owned() } else { format!("{turns} times") };
    notes.push(note(path, column, &format!("the angle jumps by a whole turn {times}, which is taken out")));
    Ok(points)
}

/// The angle without its jumps by a whole turn, and their number. `None` without such jumps, and if most steps are.
fn unwrapped(points: &[f64], turn: f64) -> Option<(Vec<f64>, usize)> {
    let (mut before, mut turns, mut added) = (f64::NAN, 0, 0.0);
    let unwrap = |point: &f64| {
        let step = *point - before;
        if (step.abs() - turn).abs() < NEAR_DEG / 360.0 * turn {
            turns += 1;
            added -= turn.copysign(step);
        }
        before = if point.is_nan() { before } else { *point };
        *point + added
    };
    let points: Vec<f64> = points.iter().map(unwrap).collect();
    (turns > 0 && 2 * turns < points.len()).then_some((points, turns))
}

/// The note about jumps in a record from which no model removes them.
pub fn said(input: &Input<'_>, column: &Column, path: &Path) -> Option<LogWarning> {
    let Jumps { largest, usual } = jumps(input)?;
    let per_second = if matches!(input, Input::Phase(_)) { column.rate_hz } else { 1.0 };
    let (size, times) = ((largest * column.scale * per_second).abs(), largest / usual);
    let size = format!("{size:.1e} {}", column.quantity.map_or("", Quantity::unit));
    let size = size.trim_end();
    Some(note(path, column, &format!("jumps of up to {size}, {times:.0} times the usual, are in the deviations")))
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
        assert_eq!(unwrapped(&[0.0, 360.0, 720.0], 360.0), None, "a turn for each sample");
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
