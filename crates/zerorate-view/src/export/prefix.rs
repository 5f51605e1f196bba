//! The prefix of the names in an export, so that one program can hold the calibrations of several units.

use std::str::FromStr;

/// The longest prefix. Names without an axis name then stay below the 63 significant characters of C99;
/// names with one are checked in the export.
const LONGEST: usize = 31;

/// A prefix of names: a C identifier that no standard reserves.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prefix(String);

impl Prefix {
    /// The prefix of functions and tables in C: `left_`.
    pub(super) fn of_functions(&self) -> String {
        format!("{}_", self.0)
    }

    /// The prefix of functions in Rust, in lower case.
    pub(super) fn of_functions_in_rust(&self) -> String {
        self.of_functions().to_ascii_lowercase()
    }

    /// The prefix of macros and constants: `LEFT_`.
    pub(super) fn of_constants(&self) -> String {
        self.of_functions().to_ascii_uppercase()
    }
}

impl FromStr for Prefix {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        if text.len() > LONGEST {
            return Err("it has more than 31 characters; names in C would grow beyond what compilers tell apart");
        }
        if !text.starts_with(|c: char| c.is_ascii_alphabetic()) {
            return Err("a name in C begins with a letter A to Z; names that begin with an underscore are reserved");
        }
        if !text.chars().all(|c| c.is_ascii_alphanumeric() || c == '_') {
            return Err("a name in C consists of the letters A to Z, digits and underscores, as in left_imu");
        }
        if text.contains("__") || text.ends_with('_') {
            return Err("names with two underscores in a row are reserved, and one follows the prefix anyway");
        }
        Ok(Self(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prefix_is_an_identifier_of_c() {
        for good in ["left", "L", "imu2_left", "Left", &"a".repeat(31)] {
            assert!(good.parse::<Prefix>().is_ok(), "{good}");
        }
        for bad in
            ["", "2nd", "_left", "left_", "a__b", "le ft", "le-ft", "left;", "lïnks", "@ID@", "a\nb", &"a".repeat(32)]
        {
            assert!(bad.parse::<Prefix>().is_err(), "{bad}");
        }
    }

    #[test]
    fn each_language_has_its_case() {
        let prefix: Prefix = "Imu2_Left".parse().unwrap();
        assert_eq!(
            (prefix.of_functions(), prefix.of_functions_in_rust(), prefix.of_constants()),
            ("Imu2_Left_".to_owned(), "imu2_left_".to_owned(), "IMU2_LEFT_".to_owned())
        );
    }
}
