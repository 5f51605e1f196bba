//! Columns that are the three axes of one sensor: their names differ in the letter, digit or word of the axis alone.

use std::collections::BTreeMap;
use zerorate_logs::Unit;

/// Words that tell the axes apart in names. Earlier lines have precedence.
const AXES: [[&str; 3]; 11] = [
    ["x", "y", "z"],
    ["X", "Y", "Z"],
    ["0", "1", "2"],
    ["1", "2", "3"],
    ["roll", "pitch", "yaw"],
    ["Roll", "Pitch", "Yaw"],
    ["forward", "right", "down"],
    ["fwd", "right", "down"],
    ["alpha", "beta", "gamma"],
    ["Alpha", "Beta", "Gamma"],
    ["p", "q", "r"],
];

/// Groups names into triads of axes. A triad holds the indices of its names in the order of [`AXES`]. The triads are
/// sorted by their first index.
pub fn triads(names: &[&str]) -> Vec<[usize; 3]> {
    let mut found: Vec<[usize; 3]> = Vec::new();
    for axes in AXES {
        let mut by_pattern: BTreeMap<(&str, &str), [Vec<usize>; 3]> = BTreeMap::new();
        let free = (0..names.len()).filter(|name| !found.iter().flatten().any(|taken| taken == name));
        for name in free {
            for (axis, word) in axes.into_iter().enumerate() {
                for (place, _) in names[name].match_indices(word) {
                    let pattern = (&names[name][..place], &names[name][place + word.len()..]);
                    by_pattern.entry(pattern).or_default()[axis].push(name);
                }
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

/// Words in which the names of the axes of one sensor may differ.
const WORDS: [&str; 24] = [
    "roll", "pitch", "yaw", "p", "q", "r", "x", "y", "z", "alpha", "beta", "gamma", "a", "b", "c", "north", "east",
    "down", "up", "forward", "right", "left", "lateral", "vertical",
];

/// Parts of units in names. Axes of one sensor may have different units.
const UNITS: [&str; 14] = ["dps", "mdps", "rad", "mrad", "urad", "deg", "s", "min", "h", "m", "g", "mg", "ug", "s2"];

/// True if names may be axes of one sensor: they differ in the axis alone.
pub fn are_one_sensor(names: &[&str]) -> bool {
    let Some((first, others)) = names.split_first() else { return true };
    others.iter().all(|other| differ_in_axis(first, other))
        && (1..names.len()).all(|at| !names[..at].contains(&names[at]))
}

fn differ_in_axis(one: &str, other: &str) -> bool {
    let [left, right] = [one, other].map(|name| name.chars().collect::<Vec<char>>());
    let unlike: Vec<(char, char)> =
        left.iter().copied().zip(right.iter().copied()).filter(|(one, other)| one != other).collect();
    let is_axis = |of: &[&str; 3], letter: char| of.contains(&&*letter.to_string());
    let is_letter = left.len() == right.len()
        && matches!(unlike[..], [(one, other)] if AXES.iter().any(|of| is_axis(of, one) && is_axis(of, other)));
    let words = |name: &str| -> Vec<String> {
        let parts = name.split(|c: char| !c.is_alphanumeric()).filter(|part| !part.is_empty());
        let states_unit = Unit::of_column(name).is_some();
        let words = parts.map(str::to_lowercase);
        words.filter(|word| !(states_unit && UNITS.contains(&word.as_str()))).collect()
    };
    let (one, other) = (words(one), words(other));
    let mut unlike = one.iter().zip(&other).filter(|(one, other)| one != other);
    let are_words = |(one, other): (&String, &String)| {
        let is_word = |word: &str| WORDS.contains(&word);
        let (own, others) = own_parts(one, other);
        is_word(one) && is_word(other) || is_word(own) && is_word(others)
    };
    let is_word_of_axis = one.len() == other.len() && unlike.next().is_some_and(are_words) && unlike.next().is_none();
    is_letter || is_word_of_axis
}

/// Two words without the letters with which both begin, and without those with which both end.
fn own_parts<'a>(one: &'a str, other: &'a str) -> (&'a str, &'a str) {
    let alike = one.chars().zip(other.chars()).take_while(|(one, other)| one == other);
    let start: usize = alike.map(|(one, _)| one.len_utf8()).sum();
    let (one, other) = (&one[start..], &other[start..]);
    let alike = one.chars().rev().zip(other.chars().rev()).take_while(|(one, other)| one == other);
    let end: usize = alike.map(|(one, _)| one.len_utf8()).sum();
    (&one[..one.len() - end], &other[..other.len() - end])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn other_columns_are_not_axes_of_the_same_sensor() {
        for names in [&["gx_dps", "gy_dps"][..], &["rollRate", "pitchRate"], &["gyro_roll", "gyro_yaw"], &["gz"]] {
            assert!(are_one_sensor(names), "{names:?}");
        }
        for names in [&["gz_dps", "yaw_rate_dps"][..], &["imu.gz", "ref.gz"], &["gx", "gx"], &["fog_z", "gyro_x"]] {
            assert!(!are_one_sensor(names), "{names:?}");
        }
    }

    #[test]
    fn names_that_differ_in_the_axis_alone_are_one_sensor() {
        let cases: [(&[&str], &[[usize; 3]]); 7] = [
            (&["gyro1_x", "gyro1_y", "gyro1_z", "gyro2_x", "gyro2_y", "gyro2_z"], &[[0, 1, 2], [3, 4, 5]]),
            (&["gx_dps", "gy_dps", "gz_dps", "yaw_dps"], &[[0, 1, 2]]),
            (&["gyro3_x", "gyro1_x", "gyro2_x", "gyro1_y", "gyro1_z"], &[[1, 3, 4]]),
            (&["w[2]", "w[1]", "w[0]"], &[[2, 1, 0]]),
            (&["gyro_1", "gyro_2", "gyro_3", "speed"], &[[0, 1, 2]]),
            (&["gx", "gy", "speed_z"], &[]),
            (
                &["yaw_dps", "roll_dps", "pitch_dps", "cal_yaw_dps", "cal_roll_dps", "cal_pitch_dps"],
                &[[1, 2, 0], [4, 5, 3]],
            ),
        ];
        for (names, expected) in cases {
            assert_eq!(triads(names), expected, "{names:?}");
        }
    }
}
