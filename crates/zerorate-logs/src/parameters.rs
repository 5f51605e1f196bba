//! The parameters that a log of ArduPilot states.

use crate::dataflash::Messages;
use crate::error::Result;
use crate::open::{self, ARDUPILOT};
use std::collections::BTreeMap;
use std::path::Path;
use zerorate_input::Input;

/// The parameters of a log of ArduPilot, each with its first value. Empty for any other log.
///
/// # Errors
/// Returns an error if the file cannot be read.
pub fn parameters(path: &Path, input: Input) -> Result<BTreeMap<String, f64>> {
    let log = open::open(path, input)?;
    let mut found = BTreeMap::new();
    if !log.start.starts_with(&ARDUPILOT) {
        return Ok(found);
    }
    Messages::new(path, log.input).all(|_, form, body| {
        if form.name == "PARM"
            && let Some((name, value)) = form.text("Name", body).zip(form.number("Value", body))
        {
            found.entry(name).or_insert(value);
        }
        true
    })?;
    Ok(found)
}
