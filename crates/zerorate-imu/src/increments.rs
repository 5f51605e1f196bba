//! Columns of increments: the change of angle or velocity during a sample, in place of the angular rate or the
//! acceleration.

use std::path::Path;
use zerorate_logs::{Column, ColumnOptions, LogError, Quantity, Result, Setting};

/// Words in the names of increments of an angle, and of a velocity. Only letters and digits are compared.
const ANGLES: [&str; 10] = [
    "dtheta",
    "deltatheta",
    "dangle",
    "deltaang",
    "deltang",
    "delang",
    "angleincr",
    "angularincr",
    "angincr",
    "incang",
];
const VELOCITIES: [&str; 7] = ["dvel", "deltavel", "deltvel", "delvel", "velincr", "velocityincr", "incvel"];

/// Beginnings of short names of increments, before the letter or digit of the axis.
const SHORT_ANGLES: [&str; 3] = ["dth", "dang", "dphi"];
const SHORT_VELOCITIES: [&str; 3] = ["dv", "deltav", "delv"];

/// Units of increments after the letter or digit of the axis. Only letters and digits are compared.
const UNITS: [&str; 9] = ["", "rad", "mrad", "urad", "deg", "mdeg", "ms", "mps", "gs"];

/// The quantity of a column of increments, by its name: angular rate for increments of an angle, acceleration for
/// those of a velocity. `None` if the name does not state increments.
pub fn named(name: &str) -> Option<Quantity> {
    let name: String = name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect();
    let is_axis_of = |start: &&str| {
        let unit = name.strip_prefix(*start).and_then(|rest| rest.strip_prefix(['x', 'y', 'z', '0', '1', '2', '3']));
        unit.is_some_and(|unit| UNITS.contains(&unit))
    };
    let holds = |words: &[&str], starts: &[&str]| {
        words.iter().any(|word| name.contains(word)) || starts.iter().any(is_axis_of)
    };
    match () {
        () if holds(&ANGLES, &SHORT_ANGLES) => Some(Quantity::AngularRate),
        () if holds(&VELOCITIES, &SHORT_VELOCITIES) => Some(Quantity::Acceleration),
        () => None,
    }
}

/// Asks about columns that are increments by their names, unless the user says whether they are.
///
/// # Errors
/// Returns a question that names these columns.
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
        let angles = [
            "dtheta_x",
            "X_DELTANG_OUT",
            "delta_angle[0]",
            "in_deltaangl_z_raw",
            "DeltaTheta.x",
            "dth_y",
            "dang[2]",
            "DelAngZ",
            "dtheta_x (rad)",
            "dth_x_rad",
            "angular_increment_x",
            "delta_ang_1",
        ];
        let velocities = [
            "dvel_x",
            "delta_velocity_z",
            "X_DELTVEL",
            "dv_z",
            "DeltaVel.y",
            "delta_v_x",
            "dv[0]",
            "dv_x [m/s]",
            "DelVelX",
            "dv_y_mps",
            "velocity_increment_z",
        ];
        assert!(angles.iter().all(|name| named(name) == Some(Quantity::AngularRate)));
        assert!(velocities.iter().all(|name| named(name) == Some(Quantity::Acceleration)));
        assert!(
            ["gyro_x", "theta", "vel_x", "dx", "dvalue", "delta_t", "angular_velocity.x", "dv", "dvx_raw", "div_x"]
                .map(named)
                == [None; 10]
        );
    }
}
