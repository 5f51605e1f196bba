//! The check that a calibration belongs to the part, and the notes of a measurement.

use anyhow::{Error, Result};
use clap::Args;
use std::path::Path;
use zerorate::Calibration;
use zerorate::calibration::Notes;
use zerorate_view::SessionWarning;

/// Checks that a text of the user is one line, not empty and without control characters. Returns the text unchanged.
pub fn one_line(text: &str) -> Result<String, String> {
    match text.trim() {
        "" => Err("it is empty; leave the option out".to_owned()),
        _ if text.contains(char::is_control) => {
            Err("it must be one line of plain text, without control characters".to_owned())
        }
        _ => Ok(text.to_owned()),
    }
}

/// Notes that go with the samples into the capture and the calibration.
#[derive(Args, Clone, Debug)]
pub struct NotesArgs {
    /// A note on the supply, stored in the file.
    #[arg(long, value_name = "TEXT", value_parser = one_line, help_heading = "Notes")]
    supply_note: Option<String>,

    /// A note on the surroundings, such as their temperature, stored in the file.
    #[arg(long, value_name = "TEXT", value_parser = one_line, help_heading = "Notes")]
    ambient_note: Option<String>,

    /// Who measures, stored in the file.
    #[arg(long, value_name = "NAME", value_parser = one_line, help_heading = "Notes")]
    operator: Option<String>,
}

impl From<NotesArgs> for Notes {
    fn from(NotesArgs { supply_note, ambient_note, operator }: NotesArgs) -> Self {
        Self { supply: supply_note, ambient: ambient_note, operator, host: None }
    }
}

/// The advice of commands that have the option `--serial`.
pub const GIVE: &str = "give --serial SN";

/// Returns an error if `calibration`, from the file `path`, is of another part, or a warning if that is uncertain.
/// `part` is the name of the part in messages, which is the device or the capture, and its serial number.
pub fn check(calibration: &Calibration, path: &Path, part: (&str, Option<&str>)) -> Result<Option<SessionWarning>> {
    let cal = (path.display().to_string(), calibration.serial.as_deref());
    SessionWarning::of_serial(cal, part, GIVE).map_err(Error::msg)
}
