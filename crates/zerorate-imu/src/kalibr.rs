//! The units of a file whose names do not state them, but whose format does.

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

/// Gives the columns of Kalibr's format their units, if they are all columns of a log and measure gravity in m/s².
pub(super) fn give_units(columns: &mut [Column]) -> bool {
    let fits = columns.len() == COLUMNS.len()
        && columns.iter().zip(COLUMNS).all(|(column, (name, _))| column.name == name && column.quantity.is_none());
    let gravity = || plausible::is_gravity(columns[3..].iter().map(|column| column.facts().mean()));
    if !fits || !gravity() {
        return false;
    }
    for (column, (_, unit)) in columns.iter_mut().zip(COLUMNS) {
        column.quantity = Some(unit.quantity());
        column.scale *= unit.in_results();
        column.warnings.retain(|warning| !matches!(warning, LogWarning::UnitUnknown { .. }));
    }
    true
}
