//! Whether a calibration is that of the part: every part has its own bias, and the wrong one shows in nothing.

use anyhow::{Result, bail};
use std::path::Path;
use zerorate::Calibration;
use zerorate_jobs::JobWarning;

/// A text that goes into files and messages as one line.
pub fn one_line(text: &str) -> Result<String, String> {
    match text.contains(char::is_control) {
        true => Err("it must be one line of plain text, without control characters".to_owned()),
        false => Ok(text.to_owned()),
    }
}

/// Of a command with an option for it.
pub const GIVE: &str = "give --serial SN";

/// The part whose rates are to be corrected.
pub struct Part<'a> {
    /// What it is called in messages: the device, or the capture.
    pub name: &'a str,
    /// Its serial number, as far as it is known.
    pub serial: Option<&'a str>,
    /// How to make it known.
    pub advice: &'static str,
}

impl Part<'_> {
    /// What is to be said where nothing shows that `calibration`, from the file `path`, is of this part.
    ///
    /// # Errors
    /// Where it is of another.
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
