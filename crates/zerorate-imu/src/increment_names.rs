//! Names and units of columns of increments.

use zerorate_logs::Quantity;

/// Words in the names of increments of an angle, and of a velocity. Only letters and digits are compared.
const ANGLES: &str = "dtheta deltatheta dangle deltaang deltang delang angleincr angularincr angincr incang";
const VELOCITIES: &str = "dvel deltavel deltvel delvel velincr velocityincr incvel";

/// Beginnings of short names of increments, before the letter or digit of the axis.
const SHORT_ANGLES: &str = "dth dang dphi angleinc anginc gyroinc gyrinc";
const SHORT_VELOCITIES: &str = "dv deltav delv velinc accinc accelinc";

/// Beginnings of names that may be increments or something else: `day` is a date. They do not make a column an axis.
const DOUBTFUL: &str = "da dt dw dg dr";

/// Units of an angle, and of a velocity, in lower case.
const ANGLE_UNITS: [&str; 14] = [
    "rad", "mrad", "urad", "µrad", "radian", "radians", "deg", "mdeg", "degree", "degrees", "°", "arcsec", "arcmin",
    "asec",
];
const VELOCITY_UNITS: [&str; 7] = ["m/s", "mps", "cm/s", "mm/s", "m_s", "m s^-1", "m s-1"];

/// Units of increments after the letter or digit of the axis. Only letters and digits are compared.
const UNITS: [&str; 10] = ["", "rad", "mrad", "urad", "deg", "mdeg", "arcsec", "ms", "mps", "gs"];

/// The quantity of a column of increments, by its name: angular rate for increments of an angle, acceleration for
/// those of a velocity. `None` if the name does not state increments.
pub fn named(name: &str) -> Option<Quantity> {
    let holds = |words: &str, starts: &str| {
        let plain = plain(name);
        words.split(' ').any(|word| plain.contains(word)) || starts_before_axis(&plain, starts)
    };
    match () {
        () if holds(ANGLES, SHORT_ANGLES) => Some(Quantity::AngularRate),
        () if holds(VELOCITIES, SHORT_VELOCITIES) => Some(Quantity::Acceleration),
        () => None,
    }
}

/// True if an axis of this name may hold increments, by a unit or a short beginning.
pub fn may_be(name: &str) -> bool {
    by_unit(name).is_some() || starts_before_axis(&plain(name), DOUBTFUL)
}

fn plain(name: &str) -> String {
    name.to_lowercase().chars().filter(|c| c.is_alphanumeric()).collect()
}

fn starts_before_axis(plain: &str, starts: &str) -> bool {
    let is_axis_of = |start: &str| {
        let unit = plain.strip_prefix(start).and_then(|rest| rest.strip_prefix(['x', 'y', 'z', '0', '1', '2', '3']));
        unit.is_some_and(|unit| UNITS.contains(&unit))
    };
    starts.split(' ').any(is_axis_of)
}

/// The quantity of a column of increments, by the unit in its name, and the name in lower case without that unit:
/// `gyro_x [rad]`, `wx_arcsec`, `ax (m/s)`.
pub fn by_unit(name: &str) -> Option<(Quantity, String)> {
    let name = name.to_lowercase();
    let bracketed = name.trim_end().strip_suffix([']', ')']).and_then(|name| name.rsplit_once(['[', '(']));
    let without = |unit: &&str| match bracketed {
        Some((own, inner)) => (inner.trim() == *unit).then_some(own),
        None => name.strip_suffix(*unit).filter(|own| own.ends_with(['_', ' ', '.'])),
    };
    let of =
        |units: &[&str]| units.iter().find_map(without).map(|own| own.trim_end_matches(['_', ' ', '.']).to_owned());
    let angle = of(&ANGLE_UNITS).map(|own| (Quantity::AngularRate, own));
    angle.or_else(|| of(&VELOCITY_UNITS).map(|own| (Quantity::Acceleration, own)))
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
            "AngleIncX",
            "gyro_inc_x [deg]",
            "dtheta_x_arcsec",
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
            "VelIncZ",
        ];
        assert!(angles.iter().all(|name| named(name) == Some(Quantity::AngularRate)));
        assert!(velocities.iter().all(|name| named(name) == Some(Quantity::Acceleration)));
        assert!(
            ["gyro_x", "theta", "vel_x", "dx", "dvalue", "delta_t", "angular_velocity.x", "dv", "dvx_raw", "div_x"]
                .map(named)
                == [None; 10]
        );
    }

    #[test]
    fn units_of_an_angle_or_a_velocity_suggest_increments() {
        let units = ["gyro_x [rad]", "gyro_x_deg", "wx_arcsec", "w.x (°)", "GyroX (mrad)", "ax [m/s]", "acc_y_mps"];
        let bare = ["gyro_x", "gyro_x", "wx", "w.x", "gyrox", "ax", "acc_y"];
        assert_eq!(units.map(|name| by_unit(name).unwrap().1), bare);
        for name in ["gyro_x [rad/s]", "gyro_rad_s", "gyro_rad[0]", "ax [m/s^2]", "ax_m_s2", "grad", "ax_g"] {
            assert_eq!(by_unit(name), None, "{name}");
        }
    }
}
