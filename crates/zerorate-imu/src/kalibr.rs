//! Units of Kalibr's files, whose column names do not state them.

use crate::plausible;
use zerorate_logs::{Column, LogWarning, Unit};

/// The columns in the files of Kalibr's `kalibr_bagcreater`, and their units.
const COLUMNS: [(&str, Unit); 6] = [
    ("omega_x", Unit::RadPerS),
    ("omega_y", Unit::RadPerS),
    ("omega_z", Unit::RadPerS),
    ("alpha_x", Unit::MPerS2),
    ("alpha_y", Unit::MPerS2),
    ("alpha_z", Unit::MPerS2),
];

/// Gives the columns of Kalibr's format their units, if a log has each of them once without a unit, in any order, and
/// the accelerometer measures gravity in m/s². Returns whether the units were given.
pub(super) fn give_units(columns: &mut [Column]) -> bool {
    let place = |(name, _): &(&str, Unit)| {
        let mut all = columns.iter().enumerate().filter(|(_, column)| column.name == *name);
        let (at, column) = all.next().filter(|_| all.next().is_none())?;
        column.quantity.is_none().then_some(at)
    };
    let places: Vec<usize> = COLUMNS.iter().filter_map(place).collect();
    let gravity = || plausible::is_gravity(places[3..].iter().map(|at| columns[*at].facts().mean()));
    if places.len() < COLUMNS.len() || !gravity() {
        return false;
    }
    for (at, (_, unit)) in places.into_iter().zip(COLUMNS) {
        let column = &mut columns[at];
        column.quantity = Some(unit.quantity());
        column.scale *= unit.in_results();
        column.warnings.retain(|warning| !matches!(warning, LogWarning::UnitUnknown { .. }));
    }
    true
}
