//! Detects a factor or a range that the name of a column states beside its unit. Numbers in such a column are not in
//! that unit.

/// Words that state a factor, wherever they stand. `milli`, `micro` and `nano` are left to [`joined_prefixes`].
const WORDS: [&str; 11] =
    ["tenth", "hundredth", "thousandth", "centi", "deci_", "deci ", "deci-", "decid", "decir", "kilo", "÷"];

/// Signs and words that state a factor or a range if a number follows.
const BEFORE_NUMBER: [&str; 13] =
    ["*", "×", "±", "+/-", "+-", "mul", "div", "times", "mult", "factor", "scale", "range", "sensitivity"];

/// Words of codes: `[LSB] 16.4 LSB/dps` states a scale, and not a unit.
const CODES: [&str; 10] = ["lsb", "lsbs", "count", "counts", "cts", "digit", "digits", "adc", "code", "codes"];

/// True if the name of a column states a factor or a range beside a unit: `gx_x100_dps`, `gx (±250 dps)`.
pub fn states_factor(name: &str) -> bool {
    let name = joined_prefixes(name);
    let name = own_part(&name);
    let words: Vec<&str> = words(name).collect();
    let before = |at: usize| at.checked_sub(1).map_or("", |before| words[before]);
    // a rate is not a factor, and a number that comes twice is that of the sensor: `sensor 10: ACC.X 10 [g]`
    let is_other = |at: usize| {
        let is_rate = words.get(at + 1).is_some_and(|next| ["hz", "khz"].contains(next));
        is_rate || words.iter().filter(|word| **word == words[at]).count() > 1
    };
    WORDS.iter().any(|word| name.contains(word))
        || words.iter().any(|word| ["milli", "micro", "nano"].contains(word))
        || (0..words.len()).any(|at| is_factor(before(at), words[at]) && !is_other(at))
        || BEFORE_NUMBER.iter().any(|sign| name.match_indices(sign).any(|(at, _)| is_number(&name[at + sign.len()..])))
        || name.match_indices(['*', '×', '^', '⁻', '²', '³', '⁶']).any(|(at, _)| follows_number(&name[..at]))
        || name.match_indices("e-").any(|(at, _)| is_exponent(&name[..at], &name[at + 2..]))
        || name.match_indices('/').any(|(at, _)| is_divided(&name[..at], &name[at + 1..]))
        || name.split(['[', '(']).skip(1).any(has_number_in_front)
}

/// True if a name has a word for the codes of a sensor: `gyro_x [LSB]`.
pub fn states_codes(name: &str) -> bool {
    words(&name.to_lowercase()).any(|word| CODES.contains(&word))
}

/// The name in lower case, with prefixes joined to their units: `milli_dps` becomes `mdps`.
pub fn joined_prefixes(name: &str) -> String {
    let prefixes = [("milli", "m"), ("micro", "u"), ("nano", "n")];
    let apart =
        prefixes.into_iter().flat_map(|(long, short)| ['_', ' ', '-'].map(|gap| (format!("{long}{gap}"), short)));
    apart.fold(name.to_lowercase(), |name, (long, short)| name.replace(&long, short))
}

/// The name without the topic of a ROS message.
fn own_part(name: &str) -> &str {
    name.strip_prefix('/').and_then(|name| name.split_once('.')).map_or(name, |(_, own)| own)
}

fn words(name: &str) -> impl Iterator<Item = &str> {
    name.split(|c: char| !c.is_alphanumeric() && c != '.').filter(|word| !word.is_empty())
}

/// True for words such as `x100`, `100x` and `q15`, and for a number that follows an axis. A number below 10 may
/// count sensors or axes, as in `gyro_x2_dps` and `gyro_x_2_dps`.
fn is_factor(before: &str, word: &str) -> bool {
    let is_large = |digits: &str| digits.parse::<f64>().is_ok_and(|number| number >= 10.0);
    let is_of_sensor = ["gyr", "acc"].iter().any(|start| before.starts_with(start));
    let is_behind_axis = before.ends_with(['x', 'y', 'z']) && (before.len() <= 3 || is_of_sensor);
    let is_decimal = word.contains(['.', 'e']) && word.trim_end_matches('e').parse::<f64>().is_ok();
    let prefixed = ["x", "q", "fs"].iter().find_map(|start| word.strip_prefix(start));
    let suffixed = word.strip_suffix('x').filter(|digits| !digits.contains('.'));
    match prefixed.or(suffixed) {
        Some(digits) if word.starts_with('q') => digits.parse::<f64>().is_ok(),
        Some(digits) => is_large(digits) || is_behind_axis && digits.parse::<u8>().is_ok(),
        None => (is_behind_axis || before == "fs") && (is_large(word) || is_decimal),
    }
}

fn is_number(text: &str) -> bool {
    text.trim_start_matches(['_', ' ', '(']).starts_with(|c: char| c.is_ascii_digit())
}

fn follows_number(text: &str) -> bool {
    text.trim_end_matches(['_', ' ']).ends_with(|c: char| c.is_ascii_digit())
}

/// True for the exponent in `gx e-3 dps`.
fn is_exponent(before: &str, after: &str) -> bool {
    !before.ends_with(char::is_alphanumeric) && after.starts_with(|c: char| c.is_ascii_digit())
}

/// True for a division by a number. `/robot/1/imu` and `imu/0.gx` are paths.
fn is_divided(before: &str, after: &str) -> bool {
    let after = after.trim_start_matches(['_', ' ']);
    let rest = after.trim_start_matches(|c: char| c.is_ascii_digit());
    let number: u32 = after[..after.len() - rest.len()].parse().unwrap_or_default();
    let is_apart = before.is_empty() || before.ends_with(|c: char| !c.is_alphanumeric() || "xyzs".contains(c));
    (number >= 10 || number > 0 && is_apart) && (rest.is_empty() || rest.starts_with([' ', ')', ']', '_']))
}

/// True for a bracket such as `(x16 deg/s)`, `(0.01 dps)` and `(range 250 dps)`: a number stands before the unit.
fn has_number_in_front(bracket: &str) -> bool {
    let inner = bracket.split([']', ')']).next().unwrap_or_default();
    let last = inner.trim_end().rfind([' ', ',', ':', '=']).unwrap_or_default();
    !inner.trim_end().ends_with("hz") && inner[..last].contains(|c: char| c.is_ascii_digit())
}

#[cfg(test)]
mod tests {
    use crate::{Quantity, TimeUnit, Unit, states_factor};

    #[test]
    fn a_factor_or_a_range_beside_a_unit_is_another_unit() {
        for name in [
            "gyro_x_x100_dps",
            "gyro_x_100x_dps",
            "gyro_x /16 dps",
            "gyro_x/16 (dps)",
            "gyro_x [dps/16]",
            "gyro_x 1/131 dps",
            "gyro_x_q4_dps",
            "gyro_x (x16 deg/s)",
            "gyro_x (range 250 dps)",
            "wx (x10^-3 rad/s)",
            "wx (10^-3 rad/s)",
            "wx 10⁻³ rad/s",
            "gyro_x 1e-3 rad/s",
            "gyro_x (rad/s)*1000",
            "gyro_x (rad/s) x 1000",
            "1000*gyro_x_dps",
            "gx_10*dps",
            "gx_1e3_dps",
            "gx e-3 dps",
            "gx_fs250_dps",
            "gx FS 250 dps",
            "gx sensitivity 0.07 dps",
            "gx_0.01_dps",
            "gx_times_100_dps",
            "gx_div16_dps",
            "tenth_dps",
            "gyroXTenthDps",
            "gx_centi_dps",
            "gx_deci_deg_s",
            "gx (deg/s) milli",
            "gyro_x (±250 dps)",
            "gyro_x_250_dps",
            "gyro_x16_dps",
            "ax_x1000_g",
            "az_1e-3_g",
            "temp_x10_c",
        ] {
            assert!(states_factor(name), "{name}");
            assert_eq!(Quantity::of_column(name), None, "{name}");
        }
        for name in ["time_x10_us", "time*1000 [s]", "Time (s) x1000", "time/1000 (s)", "t_centi_s"] {
            assert!(states_factor(name), "{name}");
            assert_eq!(TimeUnit::of_column(name), None, "{name}");
        }
        for name in ["gyro_x [LSB] 16.4 LSB/dps", "gyro_x_lsb/dps", "gx 131 LSB per deg/s", "gx_counts_dps"] {
            assert_eq!(Unit::of_column(name), None, "{name}");
        }
    }

    #[test]
    fn numbers_of_sensors_and_axes_are_not_factors() {
        for name in [
            "gyro_2_dps",
            "gyro_12_dps",
            "gyro_x_2_dps",
            "gyro_x2_dps",
            "imu0_gx_dps",
            "gx10 (dps)",
            "mpu6050_gx_dps",
            "bmi270 gyr x dps",
            "Gyroscope X (rad/s) 2",
            "/robot/10/imu_x100.angular_velocity.x",
            "/robot/1.angular_velocity.x",
            "imu/2/gyro_x_dps",
            "Shimmer_5E12_Gyro_X_CAL_deg/s",
            "MicroStrain_gyro_x_dps",
            "gyro_decimated_x_dps",
            "angular velocity 10 (deg/s)",
            "Avanti sensor 10: ACC.X 10 [g]",
            "Trigno sensor 12: Acc 12.X [g]",
            "gyro_x 100 Hz (dps)",
            "wx (deg/s) (100 Hz)",
            "wx [rad s^-1]",
            "ax [m*s^-2]",
            "Accel_X m/(s^2)",
            "ax (m·s⁻²)",
        ] {
            assert!(Unit::of_column(name).is_some(), "{name}");
        }
        for (name, unit) in [
            ("gx_milli_dps", Unit::Mdps),
            ("gx milli deg/s", Unit::Mdps),
            ("gyroXMilliDps", Unit::Mdps),
            ("wx_micro_rad_s", Unit::UradPerS),
            ("ax_milli_m_s2", Unit::MmPerS2),
            ("ax_micro_g", Unit::MicroG),
        ] {
            assert_eq!(Unit::of_column(name), Some(unit), "{name}");
        }
        assert_eq!(TimeUnit::of_column("time_milli_s"), Some(TimeUnit::Ms));
    }
}
