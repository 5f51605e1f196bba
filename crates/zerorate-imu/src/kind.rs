//! The kind of an axis of an IMU, by the unit or the name of its column.

use crate::increment_names;
use serde::Serialize;
use zerorate_logs::{Column, Quantity, Unit, states_codes};

/// The kind of sensor that an axis belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
#[cfg_attr(feature = "types", derive(ts_rs::TS), ts(rename = "AxisKind"))]
pub enum Kind {
    /// Angular rate.
    Gyroscope,
    /// Specific force.
    Accelerometer,
}

impl Kind {
    /// Both kinds, the gyroscope first.
    pub const ALL: [Self; 2] = [Self::Gyroscope, Self::Accelerometer];

    /// `gyroscope` or `accelerometer`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Gyroscope => "gyroscope",
            Self::Accelerometer => "accelerometer",
        }
    }

    /// The quantity that this kind measures.
    #[must_use]
    pub const fn quantity(self) -> Quantity {
        match self {
            Self::Gyroscope => Quantity::AngularRate,
            Self::Accelerometer => Quantity::Acceleration,
        }
    }

    /// The kind that measures this quantity; `None` for a temperature.
    #[must_use]
    pub fn of(quantity: Quantity) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.quantity() == quantity)
    }

    /// The kind of a column, by its unit or else by its name.
    pub(super) fn of_column(column: &Column) -> Option<Self> {
        column.quantity.map_or_else(|| Self::named(&column.name), Self::of)
    }

    /// The kind that a column name states, by a unit in it or else by its words.
    pub(super) fn of_name(name: &str) -> Option<Self> {
        Quantity::of_column(name).map_or_else(|| Self::named(name), |(quantity, _)| Self::of(quantity))
    }

    /// True if a column may be an axis by its name. Columns beside the axes are not, such as set points, biases,
    /// covariances, norms, motor speeds, magnetometers in gauss, and accelerations without gravity (`FreeAccX` of
    /// Movella, `userAcceleration.x` of phones). If `others` is true, the log has columns that are surely axes, and
    /// columns of wheels and motors are not axes either.
    pub(super) fn is_axis(name: &str, others: bool) -> bool {
        let unit = Unit::of_column(name);
        let is_rpm = unit == Some(Unit::Rpm);
        let is_in_g = matches!(unit, Some(Unit::G | Unit::MilliG | Unit::MicroG));
        let name = name.to_lowercase();
        let bare = without_unit(&name);
        let is_of_motor = is_rpm && Self::named(bare).is_none();
        let beside = "covariance integral clipping calibration timestamp absolute magn setpoint freeacc free_acc \
                      useracc user_acc";
        let words = ["cmd", "command", "target", "bias", "std", "norm", "total", "abs", "gravity", "mag", "load"];
        let of_calibration = ["offset", "offsets", "cov"];
        let of_results = ["corrected", "removed", "compensated", "free"];
        let own = name.split(['[', '(']).next().unwrap_or_default();
        // gauss are written like g: `mx [G]`, `Bx (mG)`, `magX [G]`, `mx_mg`
        let is_compass = |word: &str| word.starts_with("mag") || word.ends_with("mag") || word == "compass";
        let is_magnetic = is_in_g && (is_short(bare, "mbh") || has_word(bare, is_compass));
        let is_beside = is_of_motor
            || is_magnetic
            || beside.split(' ').any(|part| name.contains(part))
            || has_word(&name, |word| words.contains(&word))
            || has_word(own, |word| of_calibration.contains(&word))
                && !has_word(own, |word| of_results.contains(&word));
        let is_doubtful = || ["wheel", "motor"].iter().any(|part| name.contains(part));
        !(is_beside || others && is_doubtful())
    }

    /// True if a name states another quantity than those of an IMU, such as a temperature or a velocity.
    pub(super) fn is_of_others(name: &str) -> bool {
        let name = name.to_lowercase();
        let holds = |words: &[&str]| words.iter().any(|word| name.contains(word));
        let is_compensated = holds(&["tempcomp", "temp_comp", "compressed"]);
        !is_compensated && holds(&["mag", "temp", "press", "baro", "quat", "orient"])
            || holds(&["linear"]) && holds(&["vel", "twist"])
    }

    /// The kind that the words of a name state: `gyro_x`, `wx`, `omega.x`; `acc_x`, `ax`, `f_y`; increments
    /// `dtheta_x`.
    fn named(name: &str) -> Option<Self> {
        if let Some(quantity) = increment_names::named(name) {
            return Self::of(quantity);
        }
        // `wx [rad]` and `gx [LSB]` name axes of increments and of codes; `wx [m/s]` is of the wind
        let (unit, name) = match increment_names::by_unit(name) {
            Some((quantity, own)) => (Self::of(quantity), own),
            None => (None, without_codes(name)),
        };
        let fits = |kind: Self| unit.is_none_or(|unit| unit == kind);
        // `axRaw` names the same axis as `ax`
        let name = name.strip_suffix("raw").map_or(&*name, |bare| bare.trim_end_matches(['_', ' ', '.']));
        let holds = |words: &[&str]| words.iter().any(|word| name.contains(word));
        // for names such as `gyX` (SparkFun's loggers) and `BodyRateX`
        let ends = |words: &str| words.split(' ').any(|word| name.ends_with(word));
        match () {
            () if Self::is_of_others(name) => None,
            () if holds(&GYROSCOPES) || fits(Self::Gyroscope) && is_short(name, "gw") || ends(RATES) => {
                Some(Self::Gyroscope)
            }
            () if holds(&ACCELEROMETERS)
                || fits(Self::Accelerometer) && is_short(name, "af")
                || ends("acx acy acz") =>
            {
                Some(Self::Accelerometer)
            }
            () => Self::by_letter(name),
        }
    }

    /// The kind that a letter behind the axis states: `x_g` and `x_a`.
    fn by_letter(name: &str) -> Option<Self> {
        let (own, letter) = name.rsplit_once(['_', '.', ' '])?;
        let axis = own.rsplit(['_', '.', ' ']).next()?;
        match letter {
            "g" if matches!(axis, "x" | "y" | "z") => Some(Self::Gyroscope),
            "a" if matches!(axis, "x" | "y" | "z") => Some(Self::Accelerometer),
            _ => None,
        }
    }
}

/// The name without the unit in its last bracket, or without rpm or g at its end.
fn without_unit(name: &str) -> &str {
    let in_bracket = name.rsplit_once(['[', '(']).filter(|(_, inner)| inner.ends_with([']', ')']));
    let at_end = |unit: &&str| name.strip_suffix(*unit).filter(|own| own.ends_with(['_', ' ', '.']));
    let own = in_bracket.map(|(own, _)| own).or_else(|| ["rpm", "rev_min", "g", "mg", "ug"].iter().find_map(at_end));
    own.unwrap_or(name).trim_end_matches(['_', ' ', '.'])
}

/// The name in lower case, without a last word or bracket that states codes.
fn without_codes(name: &str) -> String {
    let name = name.to_lowercase();
    let cut = name.rsplit_once(['[', '(', '_', ' ']).filter(|(_, last)| states_codes(last));
    cut.map_or(&*name, |(own, _)| own).trim_end_matches(['_', ' ']).to_owned()
}

fn has_word(name: &str, is: impl Fn(&str) -> bool) -> bool {
    name.split(|c: char| !c.is_alphanumeric()).any(is)
}

/// True if a name is one of these letters and an axis: `gx`, `w[0]`, `a.z`.
fn is_short(name: &str, letters: &str) -> bool {
    // drops the name of the device in front, as in `imu0.gx`
    let parts = name.rsplit_once(['.', '/', '_']).filter(|(device, _)| device.len() > 1);
    let own = parts.map_or(name, |(_, axis)| axis);
    let mut rest = own.chars().filter(|c| c.is_alphanumeric());
    let (first, second) = (rest.next(), rest.next());
    let is_axis = second.is_some_and(|axis| "xyz0123".contains(axis)) && rest.next().is_none();
    is_axis && first.is_some_and(|first| letters.contains(first))
}

const GYROSCOPES: [&str; 10] =
    ["gyr", "giro", "angular", "omega", "angvel", "ang_vel", "anglvel", "rotationrate", "rotation_rate", "bodyrate"];

/// Ends of the names of gyroscopes.
const RATES: &str = "gyx gyy gyz ratex ratey ratez rate_x rate_y rate_z rollrate pitchrate yawrate roll_rate \
                     pitch_rate yaw_rate";

const ACCELEROMETERS: [&str; 4] = ["acc", "acel", "linear", "specific_force"];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_beside_axes_are_told_by_name() {
        for name in [
            "field.angular_velocity_covariance0",
            "gyro_integral_dt",
            "Absolute (rad/s)",
            "gyro_clipping",
            "FreeAccX",
            "FreeAcc_Y",
            "userAcceleration.x (G)",
            "fan_rpm",
            "mx [G]",
            "imu0.hx (G)",
            "Mx (mg)",
            "B_x [mG]",
            "magX [G]",
            "xmag (mG)",
            "imu_mx_mg",
            "compass_x [G]",
            "gyro_x_offset [deg/s]",
        ] {
            assert!(!Kind::is_axis(name, false), "{name}");
        }
        assert!(
            ![
                "gyro_rad[0]",
                "field.angular_velocity.x",
                "ax [m/s^2]",
                "wx[rev/min]",
                "w[0]_rpm",
                "gx [rpm]",
                "ax [mg]",
                "x [g]",
                "AccX (G)"
            ]
            .into_iter()
            .any(|name| !Kind::is_axis(name, true))
        );
    }

    #[test]
    fn names_say_what_they_are() {
        let are = |names: &[&str], kind: Option<Kind>| {
            names.iter().for_each(|name| assert_eq!(Kind::named(name), kind, "{name}"));
        };
        are(&["gyro_x", "GyrX", "wx", "w_x", "g.z", "gyX", "BodyRateX", "gyRaw", "gx_raw"], Some(Kind::Gyroscope));
        are(&["w[0]", "yaw_rate", "gyro_x_tempcomp"], Some(Kind::Gyroscope));
        are(&["wx [rad]", "wx_arcsec", "gx [LSB]", "gx_counts", "AngleIncX"], Some(Kind::Gyroscope));
        are(&["accel_y", "ax", "fz", "ayRaw", "AcX", "ax (m/s)", "ax [counts]"], Some(Kind::Accelerometer));
        are(&["linear_velocity_x", "twist.linear.x", "mag_x", "temp_acc", "axle", "x", "height"], None);
        are(
            &[
                "roll [deg]",
                "yaw_deg",
                "heading (rad)",
                "x_rad",
                "fx [N]",
                "gx [V]",
                "day",
                "vel_x [m/s]",
                "wx [m/s]",
                "ax (deg)",
            ],
            None,
        );
    }
}
