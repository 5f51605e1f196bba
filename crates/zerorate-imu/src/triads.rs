//! Columns that are the three axes of one sensor: their names differ in the letter or the digit of the axis alone.

use std::collections::BTreeMap;

/// The axes as names tell them apart; letters have precedence over digits.
const AXES: [[char; 3]; 4] = [['x', 'y', 'z'], ['X', 'Y', 'Z'], ['0', '1', '2'], ['1', '2', '3']];

/// The names in threes, x, y, z or 0, 1, 2 each, in the order of their first names.
pub fn triads(names: &[&str]) -> Vec<[usize; 3]> {
    let mut found: Vec<[usize; 3]> = Vec::new();
    for axes in AXES {
        let mut by_pattern: BTreeMap<(&str, &str), [Vec<usize>; 3]> = BTreeMap::new();
        let free = (0..names.len()).filter(|name| !found.iter().flatten().any(|taken| taken == name));
        for name in free {
            for (place, letter) in names[name].char_indices() {
                let Some(axis) = axes.iter().position(|of| *of == letter) else { continue };
                let pattern = (&names[name][..place], &names[name][place + 1..]);
                by_pattern.entry(pattern).or_default()[axis].push(name);
            }
        }
        for [x, y, z] in by_pattern.into_values() {
            if let ([x], [y], [z]) = (&x[..], &y[..], &z[..])
                && !found.iter().flatten().any(|taken| [x, y, z].contains(&taken))
            {
                found.push([*x, *y, *z]);
            }
        }
    }
    found.sort_unstable();
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_differ_in_the_axis_alone_are_one_sensor() {
        let cases: [(&[&str], &[[usize; 3]]); 6] = [
            (&["gyro1_x", "gyro1_y", "gyro1_z", "gyro2_x", "gyro2_y", "gyro2_z"], &[[0, 1, 2], [3, 4, 5]]),
            (&["gx_dps", "gy_dps", "gz_dps", "yaw_dps"], &[[0, 1, 2]]),
            (&["gyro3_x", "gyro1_x", "gyro2_x", "gyro1_y", "gyro1_z"], &[[1, 3, 4]]),
            (&["w[2]", "w[1]", "w[0]"], &[[2, 1, 0]]),
            (&["gyro_1", "gyro_2", "gyro_3", "speed"], &[[0, 1, 2]]),
            (&["gx", "gy", "speed_z"], &[]),
        ];
        for (names, expected) in cases {
            assert_eq!(triads(names), expected, "{names:?}");
        }
    }
}
