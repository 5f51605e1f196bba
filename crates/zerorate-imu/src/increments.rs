//! Columns of increments: the angle or the velocity of a sample in place of its rate.

use std::path::Path;
use zerorate_logs::{Column, ColumnOptions, LogError, Quantity, Result, Setting};

/// Words in the names of increments of an angle, and of a velocity, without anything but letters.
const ANGLES: [&str; 7] = ["dtheta", "deltatheta", "dangle", "deltaang", "deltang", "angleincr", "angincr"];
const VELOCITIES: [&str; 5] = ["dvel", "deltavel", "deltvel", "velincr", "velocityincr"];

/// The quantity of which the name of a column states increments.
pub fn named(name: &str) -> Option<Quantity> {
    let name: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
    let is_axis_of = |start: &str| name.strip_prefix(start).is_some_and(|axis| ["x", "y", "z"].contains(&axis));
    match () {
        () if ANGLES.iter().any(|word| name.contains(word)) || is_axis_of("dth") => Some(Quantity::AngularRate),
        () if VELOCITIES.iter().any(|word| name.contains(word)) || is_axis_of("dv") => Some(Quantity::Acceleration),
        () => None,
    }
}

/// Asks about columns that are increments by their names, unless the user says whether they are.
///
/// # Errors
/// The names of such columns.
pub fn ask(path: &Path, columns: &[&Column], args: &ColumnOptions) -> Result<()> {
    let names: Vec<&str> = columns.iter().map(|column| &*column.name).filter(|name| named(name).is_some()).collect();
    match names.is_empty() || args.increments.is_some() {
        true => Ok(()),
        false => Err(question(path, &format!("{} by name", names.join(", ")), args)),
    }
}

/// The question whether columns hold increments, with the evidence for it.
pub fn question(path: &Path, seen: &str, args: &ColumnOptions) -> LogError {
    let [yes, no] = [Setting::Increments, Setting::NoIncrements].map(|setting| args.names.of(setting));
    let what = "the angle or velocity of each sample, in place of its rate";
    LogError::Ask(format!("{}: these may be increments, {what}: {seen}; give {yes}, or {no}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_state_increments() {
        let angles = ["dtheta_x", "X_DELTANG_OUT", "delta_angle[0]", "in_deltaangl_z_raw", "DeltaTheta.x", "dth_y"];
        let velocities = ["dvel_x", "delta_velocity_z", "X_DELTVEL", "dv_z", "DeltaVel.y"];
        assert!(angles.iter().all(|name| named(name) == Some(Quantity::AngularRate)));
        assert!(velocities.iter().all(|name| named(name) == Some(Quantity::Acceleration)));
        assert!(["gyro_x", "theta", "vel_x", "dx", "dvalue", "delta_t", "angular_velocity.x"].map(named) == [None; 7]);
    }
}
