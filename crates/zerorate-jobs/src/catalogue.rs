//! The catalogue of parts that the program knows by name: the files of `parts/`.

use crate::InvalidOptions;
use crate::output::{OutputError, Outputs};
use anyhow::Result;
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};
use zerorate_input::limits;

macro_rules! files {
    ($($name:literal)*) => { &[$(($name, include_str!(concat!("../../../parts/", $name, ".toml")))),*] };
}

/// Name without `.toml`, and text, of each part file.
pub const FILES: &[(&str, &str)] = files! {
    "adis16130" "adis16405" "adis164652" "adis16470" "adis164752" "adis16488" "adis164952"
    "adxrs290" "bmi055" "bmi088" "bmi160" "bmi270" "bno055" "icm20602" "icm20689" "icm20948"
    "icm42688p" "iim42652" "ism330dhcx" "itg3200" "l3gd20h" "lsm6ds3" "lsm6dso" "lsm6dsox" "lsm9ds1"
    "mpu6050" "mpu9250" "mti1" "scha634d03" "vn100"
};

/// The text of a part file, from the catalogue or from a path. The inner result holds the error of reading the file.
///
/// # Errors
/// Returns the errors of [`Outputs::reads`].
pub fn text(named: &Path, outputs: &mut Outputs) -> Result<io::Result<String>, OutputError> {
    match named.to_str().and_then(find) {
        Some(text) => Ok(Ok(text.to_owned())),
        None => outputs.try_text(named, limits::TEXT),
    }
}

/// The text of a part file, and the full scale in °/s if `named` states one, as in `icm20948:500`.
///
/// # Errors
/// Returns [`InvalidOptions`] if there is no such part or its file cannot be read, or the errors of
/// [`Outputs::reads`].
pub fn named(named: &Path, outputs: &mut Outputs) -> Result<(String, Option<f64>)> {
    let (file, range_dps) = split(named);
    let text = text(&file, outputs)?.map_err(|error| match error.kind() {
        ErrorKind::NotFound => unknown(&file.display().to_string()),
        _ => InvalidOptions(format!("cannot read it: {error}")),
    })?;
    Ok((text, range_dps))
}

fn split(named: &Path) -> (PathBuf, Option<f64>) {
    let of_text = |text: &str| {
        let (name, range) = text.rsplit_once(':')?;
        Some((PathBuf::from(name), Some(range.parse().ok()?)))
    };
    named.to_str().and_then(of_text).unwrap_or_else(|| (named.to_owned(), None))
}

/// Returns the text of the catalogue's file for this part. Only letters and digits are compared, without case.
#[must_use]
pub fn find(name: &str) -> Option<&'static str> {
    let wanted = key(name);
    FILES.iter().find(|(known, _)| *known == wanted).map(|(_, text)| *text)
}

/// The error for a name that is neither in the catalogue nor a file. It suggests similar names.
#[must_use]
pub fn unknown(name: &str) -> InvalidOptions {
    let wanted = key(name);
    let near = |known: &&str| wanted.len() > 2 && (known.contains(&wanted) || wanted.contains(*known));
    let near: Vec<&str> = FILES.iter().map(|(known, _)| *known).filter(near).collect();
    let meant = if near.is_empty() { String::new() } else { format!("did you mean {}? ", near.join(" or ")) };
    InvalidOptions(format!("{name} is neither a file nor a known part: {meant}`zerorate parts` lists those"))
}

fn key(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_full_scale_stands_behind_a_colon() {
        for (text, name, range_dps) in [
            ("icm20948:500", "icm20948", Some(500.0)),
            ("icm20948", "icm20948", None),
            ("a/part.toml:62.5", "a/part.toml", Some(62.5)),
            ("C:\\part.toml", "C:\\part.toml", None),
        ] {
            assert_eq!(split(Path::new(text)), (PathBuf::from(name), range_dps), "{text}");
        }
    }
}
