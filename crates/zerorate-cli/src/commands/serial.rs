//! The check that a calibration belongs to the part. Every part has its own bias, and nothing in the samples shows
//! that the calibration of another part was taken.

use anyhow::{Result, bail};
use std::path::Path;
use zerorate::Calibration;
use zerorate_jobs::JobWarning;

/// Parses a text that files and messages show as one line.
pub fn one_line(text: &str) -> Result<String, String> {
    match text.contains(char::is_control) {
        true => Err("it must be one line of plain text, without control characters".to_owned()),
        false => Ok(text.to_owned()),
    }
}

/// Advice of a command that has the option `--serial`.
pub const GIVE: &str = "give --serial SN to have it checked";

/// The part whose rates are to be corrected.
pub struct Part<'a> {
    /// Its name in messages: the device, or the capture.
    pub name: &'a str,
    /// Its serial number, if it is known.
    pub serial: Option<&'a str>,
    /// How to make the serial number known.
    pub advice: &'static str,
}

impl Part<'_> {
    /// Returns a warning where nothing shows that `calibration`, from the file `path`, belongs to this part.
    ///
    /// # Errors
    /// The calibration belongs to another part.
    pub fn check(&self, calibration: &Calibration, path: &Path) -> Result<Option<JobWarning>> {
        let (name, cal) = (self.name, path.display().to_string());
        match (self.serial, calibration.serial.as_deref()) {
            (Some(part), Some(calibrated)) if part == calibrated => Ok(None),
            (Some(part), Some(calibrated)) => {
                bail!(
                    "{name} is part {part}, {cal} is the calibration of part {calibrated}: every part has its own \
                     bias"
                )
            }
            (None, Some(calibrated)) => {
                let (calibrated, name, advice) = (calibrated.to_owned(), name.to_owned(), self.advice);
                Ok(Some(JobWarning::UnknownSerial { cal, calibrated, name, advice }))
            }
            (_, None) => Ok(Some(JobWarning::NoSerial { cal })),
        }
    }
}
